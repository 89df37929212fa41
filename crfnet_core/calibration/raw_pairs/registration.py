"""Where the pixels of a JPEG lie in the raw picture that it was made from: turned, cropped, scaled, distorted."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.optimize import least_squares

from crfnet_core.calibration.alignment import rank_image
from crfnet_core.types import Float32Array, Float64Array

#: Width and height in pixels at which turns are compared; widths at which the fit is made, one after the other; and the
#: blur in pixels at each: the first widens the reach of the fit.
SMALL, WIDTHS, BLURS = (48, 36), (160, 400), (1.5, 0.6)

#: Parts of the raw picture's width that the JPEG may show, to begin with.
STARTS = (0.99, 0.96)

#: Brightness steps of the curve from raw light to the JPEG's luma while the two are being aligned.
STEPS = 64

#: Residual in 8-bit codes from which a pixel counts less.
LOOSE = 8.0

#: Rounds in which the curve and the place are refined in turn, and evaluations in each.
ROUNDS, EVALUATIONS = 2, 8

#: Sizes of the parameters' steps: scales, rotation, shifts, radial distortion.
_SIZES = np.array([0.01, 0.01, 0.01, 0.01, 0.01, 0.02, 0.02])

#: Luma of the JPEG, ITU-R BT.601.
LUMA = np.array([0.299, 0.587, 0.114], np.float32)


@dataclass(frozen=True, eq=False)
class Registration:
    """A turn of the raw picture, and the place of the JPEG in it.

    `place` has the logarithms of the scales in x and y, the rotation, the shifts in x and y (in half widths of the raw
    picture), and two coefficients of radial distortion.
    """

    mirrored: bool  # the raw picture is mirrored first
    quarters: int  # then turned by so many quarters of a turn, counterclockwise
    place: Float64Array  # (7,)
    correlation: float  # of luma and the raw light under one curve, with the pictures on each other

    def turned(self, picture: NDArray[Any]) -> NDArray[Any]:
        """Return a picture of the sensor, (H, W, ...), as the JPEG stands."""
        return np.rot90(picture[:, ::-1] if self.mirrored else picture, self.quarters)


def register(light: Float32Array, codes: Float32Array) -> Registration:
    """Return where a JPEG's pixels lie in raw light, both gray and of shape (H, W)."""
    turn = _turn(light, codes)
    logs = np.log2(np.maximum(turn.turned(light), 0) + np.float32(2e-3))
    places = [np.r_[np.log([start, start]), np.zeros(5)] for start in STARTS]
    for width, blur in zip(WIDTHS, BLURS, strict=True):
        raw, luma = (gaussian_filter(_narrowed(picture, width), blur) for picture in (logs, codes))
        place, correlation = max((_fit(raw, luma, place) for place in places), key=lambda fit: fit[1])
        places = [place]
    return replace(turn, place=place, correlation=correlation)


def coordinates(place: Float64Array, x: Float64Array, y: Float64Array, shape: tuple[int, ...]) -> Float64Array:
    """Return rows and columns in a turned raw picture of `shape`, (2, ...), of points of the JPEG.

    The points are given in half widths of the JPEG from its center, `place` as in `Registration`.
    """
    log_x, log_y, angle, right, down, third, fifth = place
    square = x * x + y * y
    radial = 1 + third * square + fifth * square * square
    x, y = x * radial * np.exp(log_x), y * radial * np.exp(log_y)
    x, y = x * np.cos(angle) - y * np.sin(angle) + right, x * np.sin(angle) + y * np.cos(angle) + down
    height, width = shape[:2]
    return np.stack([(y * width + height - 1) / 2, (x * width + width - 1) / 2])


def _turn(light: Float32Array, codes: Float32Array) -> Registration:
    """Return the turn of the sensor's picture that is most like the JPEG, without a place."""

    def ranks(picture: Float32Array) -> Float64Array:
        return rank_image(_resized(picture, SMALL).astype(np.float64))

    seen = ranks(codes)
    is_upright = (light.shape[1] >= light.shape[0]) == (codes.shape[1] >= codes.shape[0])
    quarters = (0, 2) if is_upright else (1, 3)
    turns = [Registration(mirrored, turn, np.zeros(7), 0.0) for mirrored in (False, True) for turn in quarters]
    return max(turns, key=lambda turn: float((ranks(turn.turned(light)) * seen).sum()))


def _fit(raw: Float32Array, luma: Float32Array, place: Float64Array) -> tuple[Float64Array, float]:
    """Return the place at which one rising curve of the raw light explains luma best, and their correlation."""
    height, width = luma.shape
    y, x = np.mgrid[:height, :width]
    x, y = ((x + 0.5) * 2 / width - 1).ravel(), (((y + 0.5) * 2 - height) / width).ravel()
    seen = luma.ravel()

    def sampled(place: Float64Array) -> Float32Array:
        return np.asarray(map_coordinates(raw, coordinates(place, x, y, raw.shape), order=1, mode="nearest"))

    robust = {"loss": "soft_l1", "f_scale": LOOSE}
    steps = {"x_scale": _SIZES, "diff_step": 1e-4, "ftol": 1e-4, "max_nfev": EVALUATIONS}
    for _ in range(ROUNDS):
        at, values = _rising_curve(sampled(place), seen)
        place = least_squares(
            lambda moved, at=at, values=values: seen - np.interp(sampled(moved), at, values), place, **robust, **steps
        ).x
    explained = np.interp(sampled(place), *_rising_curve(sampled(place), seen))
    is_even = min(np.ptp(seen), np.ptp(explained)) == 0  # as where the pictures do not overlap
    return place, 0.0 if is_even else float(np.corrcoef(seen, explained)[0, 1])


def _rising_curve(light: Float32Array, luma: Float32Array) -> tuple[Float64Array, Float64Array]:
    """Return points of a rising curve from light to luma: running maxima of the medians in quantiles of light."""
    parts = np.array_split(light.argsort(), STEPS)
    values = np.maximum.accumulate([float(np.median(luma[part])) for part in parts])
    at = np.array([float(np.median(light[part])) for part in parts])
    return at + 1e-9 * np.arange(len(at)), values


def _narrowed(picture: Float32Array, width: int) -> Float32Array:
    """Return a picture of a width in pixels, or as it is if it is smaller."""
    width = min(width, picture.shape[1])
    return _resized(picture, (width, max(1, round(picture.shape[0] * width / picture.shape[1]))))


def _resized(picture: Float32Array, size: tuple[int, int]) -> Float32Array:
    """Return a picture of a width and height in pixels."""
    return np.asarray(Image.fromarray(np.ascontiguousarray(picture)).resize(size, Image.Resampling.BOX))
