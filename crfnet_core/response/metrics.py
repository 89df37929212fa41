"""How far an estimated response is from the true one (CRF-net paper, Sec. 4; equations of docs/METHOD.md)."""

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.response.curve import SAMPLES, ResponseCurve
from crfnet_core.types import Float64Array

#: The 8-bit codes between which the shape of a response matters: outside, black level and clipping rule.
FIRST_SHAPE_CODE, LAST_SHAPE_CODE = 16, 240


def estimation_error(true: ResponseCurve, estimated: ResponseCurve) -> float:
    """Return E_est = ||f - f_hat||_2 over the responses at 1024 uniform irradiances (RMSE times 32): Eq. 32."""
    return float(np.linalg.norm(true.brightness - estimated.brightness))


def brightness_percent(error: float) -> float:
    """Return E_est, a distance between `SAMPLES` samples, as a root mean square in percent of the brightness range."""
    return float(100 * error / np.sqrt(SAMPLES))


def linearization_error(
    brightness: ArrayLike, true: ResponseCurve, estimated: ResponseCurve, *, counts: ArrayLike | None = None
) -> float:
    """Return E_lin, the RMSE between a photograph linearized by the true and by the estimated inverse response: Eq. 33.

    `brightness` holds code values in [0, 1]: a photograph, or its distinct values with `counts`, how often each occurs.
    The error is relative to the peak of the photograph linearized by the true response.
    """
    brightness = np.asarray(brightness, dtype=np.float64)
    irradiance = true.inverse(brightness)
    weights = np.ones_like(irradiance) if counts is None else np.asarray(counts, dtype=np.float64)
    squares = (irradiance - estimated.inverse(brightness)) ** 2
    peak = irradiance[weights > 0].max()
    return float(np.sqrt(np.average(squares, weights=weights)) / peak)


def shape_error(true: ResponseCurve, estimated: ResponseCurve) -> float:
    """Return how far the estimated linear light is off, in stops (RMS), once the exposure has been matched: Eq. 34.

    The error is log2(g_hat(B) / g(B)) at the 8-bit codes B from 16 to 240, less its mean over them: a linear plate has
    no absolute scale, so a constant factor is a gain and no error. This is the error that a compositor sees.
    """
    return float(np.std(_stops_off(true, estimated)))


def scale_error(true: ResponseCurve, estimated: ResponseCurve) -> float:
    """Return by how many stops the estimated linear light is too bright relative to white, at 1 in both: Eq. 38.

    The mean of log2(g_hat(B) / g(B)) over the 8-bit codes B from 16 to 240, which `shape_error` takes out.
    """
    return float(np.mean(_stops_off(true, estimated)))


def _stops_off(true: ResponseCurve, estimated: ResponseCurve) -> Float64Array:
    """Return log2(g_hat(B) / g(B)) at the 8-bit codes B from 16 to 240, shape (225,)."""
    brightness = np.arange(FIRST_SHAPE_CODE, LAST_SHAPE_CODE + 1) / 255
    return np.asarray(np.log2(estimated.inverse(brightness) / true.inverse(brightness)))
