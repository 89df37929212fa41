"""What can be had without looking at the photograph, and the best that a power law or a few components can do."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize_scalar

from crfnet_core.emor import EmorBasis
from crfnet_core.response import ResponseCurve
from crfnet_core.transfer_functions import rec709_encode, srgb_encode
from training.data.curves import IRRADIANCE

#: Components of the EMoR oracles.
ORACLE_COMPONENTS = (1, 2, 3, 5, 11)

GAMMA = "gamma 2.2"
CONSTANTS = (GAMMA, "sRGB", "Rec.709", "mean curve", "geometric median curve")
OTHER_CAMERAS = "mean of the other cameras"
ORACLE_GAMMA = "oracle: best gamma"
BASELINES = (*CONSTANTS, ORACLE_GAMMA, *(f"oracle: EMoR, {k} component{'s' * (k > 1)}" for k in ORACLE_COMPONENTS))


def constant_curves(known: np.ndarray) -> dict[str, ResponseCurve]:
    """Return the guesses that are the same for every photograph, by name.

    Parameters
    ----------
    known : ndarray, shape (N, 1024)
        The responses whose geometric median is taken; the mean curve is that of EMoR, the mean of DoRF.
    """
    samples = {
        "sRGB": srgb_encode(IRRADIANCE),
        "Rec.709": rec709_encode(IRRADIANCE),
        "mean curve": EmorBasis.load().mean,
        "geometric median curve": geometric_median(known),
    }
    return {GAMMA: ResponseCurve.gamma(2.2)} | {name: ResponseCurve.from_samples(row) for name, row in samples.items()}


def oracle_curves(true: ResponseCurve) -> dict[str, ResponseCurve]:
    """Return the nearest power law to a true response, and its projections on EMoR, by name; all strictly monotone."""
    basis = EmorBasis.load()
    weights = basis.project(true.brightness)
    curves = {ORACLE_GAMMA: nearest_power(true)}
    for k in ORACLE_COMPONENTS:
        kept = np.where(np.arange(len(weights)) < k, weights, 0)
        curves[f"oracle: EMoR, {k} component{'s' * (k > 1)}"] = ResponseCurve.from_samples(basis.reconstruct(kept))
    return curves


def nearest_power(true: ResponseCurve) -> ResponseCurve:
    """Return the power law E ** p, p from 0.02 to 5, of least E_est against a response."""

    def distance(logarithm: float) -> float:
        return float(np.linalg.norm(true.brightness - IRRADIANCE ** np.exp(logarithm)))

    found = minimize_scalar(distance, bounds=(np.log(0.02), np.log(5)), method="bounded")
    return ResponseCurve.from_samples(IRRADIANCE ** np.exp(found.x))


def geometric_median(curves: np.ndarray, *, steps: int = 500) -> np.ndarray:
    """Return the curve, shape (1024,), with the least sum of distances to `curves`, shape (N, 1024).

    Source: Weiszfeld's iteration, from the mean.
    """
    median = curves.mean(axis=0)
    for _ in range(steps):
        nearness = 1 / np.maximum(np.linalg.norm(curves - median, axis=1), 1e-9)
        median = nearness @ curves / nearness.sum()
    return median
