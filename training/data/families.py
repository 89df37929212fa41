"""Draws of responses of every family, to train on and for the bank of the posterior."""

from collections.abc import Callable

import numpy as np

from crfnet_core.posterior import IN_CAMERA, Family
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.metrics import LAST_SHAPE_CODE
from crfnet_core.types import Float64Array
from training.data.curves import DrawResponse, curve_of_inverse

#: Returns (count, 1024) in-camera responses of a family "phone", "compact" or "camera".
DrawInCamera = Callable[[Family, int, np.random.Generator], Float64Array]

#: Mean and standard deviation of the logarithm of how much an editor changes, relative to the figures in `_edited`.
EDIT_AMOUNT = (-1.0, 0.8)

#: Stops by which programs that develop raw files leave more headroom than cameras: they make the picture brighter, and
#: bend what then lies above white into the shoulder. The measured body whose files say so has 0.8.
DEVELOPED_HEADROOM = 0.6

#: Brightness above which a response bends into white.
SHOULDER = LAST_SHAPE_CODE / 255

#: Ranges of the powers of nearly linear data, and of the factor a of log curves log(1 + a E).
LINEAR_POWERS, LOG_FACTORS = (0.82, 1.25), (30.0, 6000.0)


def with_headroom(curve: ResponseCurve, stops: float) -> ResponseCurve:
    """Return a response with more headroom: white lies so many stops higher above all that is darker.

    Up to `SHOULDER` the irradiance is divided by one factor, which leaves the shape error as it is; above, its
    logarithm is stretched to end at 1. `stops` may be negative, but above log2 of the irradiance at the shoulder.
    """
    logarithm = np.log2(curve.inverse(UNIFORM[1:]))  # (1023,)
    at_shoulder = float(np.log2(curve.inverse(SHOULDER)))
    top = logarithm * (at_shoulder - stops) / at_shoulder
    moved = np.where(UNIFORM[1:] <= SHOULDER, logarithm - stops, top)
    return curve_of_inverse(np.exp2(moved))


def developed(responses: Float64Array) -> Float64Array:
    """Return responses of cameras, shape (N, 1024), as programs develop raw files: with more headroom."""
    curves = [ResponseCurve.from_samples(response) for response in responses]
    return np.stack([with_headroom(curve, DEVELOPED_HEADROOM).brightness for curve in curves])


def edited(responses: Float64Array, rng: np.random.Generator) -> Float64Array:
    """Return responses, shape (N, 1024), as an editor leaves them: other contrast, brightness, black and white points.

    An edit is a power, an S-shaped contrast around a pivot, and black and white points that cut, as in "Levels" and
    "Curves" of editors. Most files that an editor saved were only scaled or turned, so most edits are small.
    """
    return np.stack([_edited(response, rng) for response in responses])


def _edited(response: Float64Array, rng: np.random.Generator) -> Float64Array:
    """Return one edited response, shape (1024,), from 0 to 1."""
    amount = np.exp(rng.normal(*EDIT_AMOUNT))
    black, white = amount * rng.uniform(0, 0.04), 1 - amount * rng.uniform(0, 0.1)
    brightness = np.clip((response - black) / (white - black), 0, 1)
    brightness = brightness ** np.exp(amount * rng.normal(0, 0.2))
    contrast, pivot = amount * rng.normal(0, 0.3), rng.uniform(0.35, 0.65)
    bent = _s_curve(brightness, np.exp(contrast), pivot)
    saturation = UNIFORM[np.argmax(bent >= bent[-1])]
    bent = np.interp(UNIFORM * saturation, UNIFORM, bent)  # irradiance 1 is where white is reached
    return (bent - bent[0]) / (bent[-1] - bent[0])


def _s_curve(brightness: Float64Array, contrast: float, pivot: float) -> Float64Array:
    """Return brightness with the slope `contrast` at the pivot, fixed at 0, pivot and 1: two mirrored powers."""
    low = pivot * (brightness / pivot) ** contrast
    high = 1 - (1 - pivot) * ((1 - np.maximum(brightness, pivot)) / (1 - pivot)) ** contrast
    return np.where(brightness < pivot, low, high)


def log_like(count: int, rng: np.random.Generator) -> Float64Array:
    """Return curves log(1 + a E) / log(1 + a) bent by a small power, shape (count, 1024)."""
    factor = _log_uniform(LOG_FACTORS, count, rng)
    curves = np.log1p(factor * UNIFORM) / np.log1p(factor)
    return curves ** np.exp(rng.normal(0, 0.08, (count, 1)))


def _log_uniform(bounds: tuple[float, float], count: int, rng: np.random.Generator) -> Float64Array:
    """Return numbers whose logarithms are uniform, shape (count, 1)."""
    low, high = np.log(bounds)
    return np.exp(rng.uniform(low, high, (count, 1)))


def draw_responses(
    family: Family, count: int, rng: np.random.Generator, *, in_camera: DrawInCamera, film: DrawResponse
) -> Float64Array:
    """Return responses of a family other than "unexplained", shape (count, 1024).

    `film` draws the responses of DoRF: film, video and scientific cameras.
    """
    if family is Family.FILM:
        return np.stack([film(rng) for _ in range(count)])
    if family is Family.LINEAR:
        return UNIFORM ** _log_uniform(LINEAR_POWERS, count, rng)
    if family is Family.LOG:
        return log_like(count, rng)
    if family is Family.DEVELOPED:
        return developed(in_camera(Family.CAMERA, count, rng))
    if family is Family.EDITED:
        drawn = [in_camera(IN_CAMERA[int(rng.integers(3))], 1, rng)[0] for _ in range(count)]
        return edited(np.stack(drawn), rng)
    return in_camera(family, count, rng)
