"""The figures of one estimator on one photograph, as columns of a row of the table."""

from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.response.curve import SAMPLES, UNIFORM, ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import estimation_error, linearization_error, shape_error
from crfnet_core.types import Float64Array, IndexArray

#: The errors that reports give; E_lin is x 1e-2, "shape" is in stops (definitions: `crfnet_core.response.metrics`).
ERRORS = ("E_est", "E_lin", "shape")

#: The part of the brightness that a partial response covers, and the factors on the irradiance that may scale it
#: (CRF-net paper, Fig. 9: the upper 20 % of the pixel range are ignored, and the estimate is scaled).
PARTIAL_BRIGHTNESS, SCALES = 0.8, (0.3, 3.0)

DECIMALS = 6  # decimals of the figures
WEIGHTS = 3  # EMoR weights that are kept: those that matter (docs/METHOD.md)
CODES = np.arange(256) / 255  # the values of 8-bit codes, in [0, 1]

#: Samples that EMoR weights are fitted to, and their decimals: so that correlations compare with earlier reports.
FITTED_SAMPLES, FITTED_DECIMALS = 65, 4


def curve_figures(true: ResponseCurve, estimated: ResponseCurve, counts: IndexArray) -> dict[str, Any]:
    """Return the errors of one response on one photograph, in which codes occur as often as `counts`, (256,), says.

    "lower" and "partial" are the E_est over the samples up to `PARTIAL_BRIGHTNESS`, without and with the scaling of the
    irradiance that fits best.
    """
    linearization = round(linearization_error(CODES, true, estimated, counts=counts), DECIMALS)
    return {
        "E_est": round(estimation_error(true, estimated), DECIMALS),
        "E_lin": 100 * linearization,
        "shape": round(shape_error(true, estimated), DECIMALS),
        "lower": round(_lower_error(true, estimated), DECIMALS),
        "partial": round(_partial_error(true, estimated), DECIMALS),
    }


def _lower_error(true: ResponseCurve, estimated: ResponseCurve, scale: float = 1.0) -> float:
    """Return the E_est over the samples up to `PARTIAL_BRIGHTNESS`, of an estimate whose irradiance is scaled."""
    irradiance = UNIFORM[true.brightness <= PARTIAL_BRIGHTNESS]
    squares = (true.forward(irradiance) - estimated.forward(np.minimum(scale * irradiance, 1))) ** 2
    return float(np.sqrt(SAMPLES * np.mean(squares)))


def _partial_error(true: ResponseCurve, estimated: ResponseCurve) -> float:
    """Return the least `_lower_error` of all scales."""
    found = minimize_scalar(lambda scale: _lower_error(true, estimated, scale), bounds=SCALES, method="bounded")
    return min(float(found.fun), _lower_error(true, estimated))


def estimate_figures(true: ResponseCurve, estimate: ResponseEstimate, counts: IndexArray) -> dict[str, Any]:
    """Return the errors of a model's estimate, what it states of itself, and how much of the truth its band holds."""
    lower, upper = estimate.band
    inside = (true.brightness >= lower) & (true.brightness <= upper)
    return curve_figures(true, estimate.curve, counts) | {
        "expected E_est": round(estimate.uncertainty, DECIMALS),
        "expected shape": round(estimate.shape_uncertainty, DECIMALS),
        "band coverage": round(float(inside.mean()), DECIMALS),
        "verdict": str(estimate.verdict),
        "weights": fitted_weights(estimate.curve),
    }


def first_weights(curve: ResponseCurve) -> list[float]:
    """Return the first EMoR weights of a response."""
    return _first(EmorBasis.load().project(curve.brightness))


def fitted_weights(curve: ResponseCurve) -> list[float]:
    """Return the first EMoR weights of a response, by least squares on `FITTED_SAMPLES` rounded samples of it."""
    basis = EmorBasis.load()
    index = np.linspace(0, SAMPLES - 1, FITTED_SAMPLES).round().astype(int)
    samples = curve.brightness[index].round(FITTED_DECIMALS)
    return _first(np.linalg.lstsq(basis.components[:, index].T, samples - basis.mean[index])[0])


def _first(weights: Float64Array) -> list[float]:
    """Return the first weights, rounded."""
    return [round(float(weight), DECIMALS) for weight in weights[:WEIGHTS]]
