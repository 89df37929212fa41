"""Baselines: guesses that ignore the photograph, and oracles that choose by the true response."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float64Array
from training.data.curves import curve_of_inverse
from training.data.families import SHOULDER, with_headroom

#: Components of the EMoR oracles.
ORACLE_COMPONENTS = (3, 11)

#: Names of the baselines that tables or plots pick out.
GAMMA, MEAN_CURVE, OTHER_BODIES = "gamma 2.2", "mean curve", "mean of the other bodies"

#: Stops of headroom that the oracle adds at most, and the fraction of the shoulder that it uses up at most.
MOST_ADDED, MOST_USED = 3.0, 0.95


def constant_curves() -> dict[str, ResponseCurve]:
    """Return the guesses that are the same for every photograph."""
    return {GAMMA: ResponseCurve.gamma(2.2), MEAN_CURVE: ResponseCurve.from_samples(EmorBasis.load().mean)}


def oracle_curves(true: ResponseCurve) -> dict[str, ResponseCurve]:
    """Return the power law nearest to a true response, and its projections on EMoR, by name; all strictly monotone."""
    basis = EmorBasis.load()
    weights = basis.project(true.brightness)
    curves = {"oracle: best gamma": nearest_power(true)}
    for k in ORACLE_COMPONENTS:
        truncated = np.where(np.arange(len(weights)) < k, weights, 0)
        curves[f"oracle: EMoR, {k} components"] = ResponseCurve.from_samples(basis.reconstruct(truncated))
    return curves


def nearest_power(true: ResponseCurve) -> ResponseCurve:
    """Return the power law E ** p, p from 0.02 to 5, of least E_est against a response."""
    best = _nearest(lambda logarithm: UNIFORM ** np.exp(logarithm), true, (np.log(0.02), np.log(5)))
    return ResponseCurve.from_samples(UNIFORM ** np.exp(best))


def nearest_of(curves: Float64Array, true: ResponseCurve) -> ResponseCurve:
    """Return the response of least E_est among `curves`, shape (N, 1024)."""
    distances = np.linalg.norm(curves - true.brightness, axis=1)
    return ResponseCurve.from_samples(curves[np.argmin(distances)])


def with_best_headroom(curve: ResponseCurve, true: ResponseCurve) -> ResponseCurve:
    """Return `curve` with the headroom of least E_est against a true response; its shape stays."""
    bounds = (MOST_USED * float(np.log2(curve.inverse(SHOULDER))), MOST_ADDED)
    return with_headroom(curve, _nearest(lambda stops: with_headroom(curve, stops).brightness, true, bounds))


def _nearest(samples: Callable[[float], Float64Array], true: ResponseCurve, bounds: tuple[float, float]) -> float:
    """Return the number, within bounds, whose samples have the least E_est against a true response."""
    found = minimize_scalar(
        lambda number: float(np.linalg.norm(true.brightness - samples(number))), bounds=bounds, method="bounded"
    )
    return float(found.x)


def mean_in_log_irradiance(curves: Sequence[ResponseCurve]) -> ResponseCurve:
    """Return the response whose inverse is the geometric mean of the inverse responses of `curves`.

    In the logarithm of irradiance cameras differ by their shapes and by a constant, which is a factor on the exposure.
    """
    logarithms = [np.log(curve.inverse(UNIFORM[1:])) for curve in curves]
    return curve_of_inverse(np.exp(np.mean(logarithms, axis=0)))
