# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a response as pixels: code value over light in stops, with its 90 % band, and gamma 2.2 for comparison."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crfnet_core.types import BoolArray, Float32Array, Float64Array

#: Side of the square picture in pixels: twice what the panel shows on a screen of usual resolution.
SIZE = 512

#: Where the axes are: pixels from the left, and below, for their numbers; and margins at the right and at the top.
LEFT, BELOW, MARGIN = 62, 42, 22

#: Light at the left end of the axis, in stops relative to white, which is at the right end.
DARKEST = -8

#: Numbers at the axes: stops relative to white, and 8-bit code values.
STOPS, CODES = (-8, -6, -4, -2, 0), (0, 64, 128, 192, 255)

#: Colours as they are displayed, in [0, 1].
BACKGROUND = (0.11, 0.11, 0.11)
GRID = (0.2, 0.2, 0.2)
BAND = (0.22, 0.36, 0.5)
GAMMA = (0.6, 0.6, 0.6)
CURVE = (1.0, 0.72, 0.25)
NUMBER = (0.75, 0.75, 0.75)

#: Pixels from one axis to the other, across and up.
WIDTH, HEIGHT = SIZE - LEFT - MARGIN - 1, SIZE - BELOW - MARGIN - 1

#: Half the width of a line, and the length of a dash, in pixels.
_HALF_WIDTH, _DASH = 2.0, 12

#: The size of the sign of a number, the distance of two signs, half the width of their strokes, and the room that a
#: stroke takes around a sign, in pixels.
_WIDE, _TALL, _GAP, _HALF_STROKE, _PAD = 12, 22, 6, 1.7, 3


def _arc(middle: tuple[float, float], radii: tuple[float, float], first: float, last: float) -> Float64Array:
    """Return points on an ellipse between two angles in degrees, counted from the right against the clock."""
    angles = np.radians(np.linspace(first, last, 25))
    return np.array(middle) + np.array(radii) * np.stack([np.cos(angles), np.sin(angles)], axis=1)


#: The strokes of each sign through points (x, y), from (0, 0) bottom left to (1, 1).
_SIGNS = {
    "0": [_arc((0.5, 0.5), (0.5, 0.5), 0, 360)],
    "1": [np.array([(0.15, 0.8), (0.55, 1.0), (0.55, 0.0)])],
    "2": [np.vstack([_arc((0.5, 0.71), (0.46, 0.29), 165, -35), [(0.02, 0.0), (1.0, 0.0)]])],
    "4": [np.array([(0.74, 0.0), (0.74, 1.0), (0.0, 0.28), (1.0, 0.28)])],
    "5": [np.vstack([[(0.92, 1.0), (0.16, 1.0), (0.1, 0.53)], _arc((0.47, 0.33), (0.49, 0.33), 140, -150)])],
    "6": [_arc((0.5, 0.32), (0.48, 0.32), 0, 360), _arc((0.78, 0.36), (0.76, 0.64), 90, 185)],
    "8": [_arc((0.5, 0.75), (0.42, 0.25), 0, 360), _arc((0.5, 0.26), (0.5, 0.26), 0, 360)],
    "9": [_arc((0.5, 0.68), (0.48, 0.32), 0, 360), _arc((0.22, 0.64), (0.76, 0.64), 5, -90)],
    "-": [np.array([(0.1, 0.45), (0.9, 0.45)])],
}


def draw_response(brightness: Float64Array, lower: Float64Array, upper: Float64Array) -> Float32Array:
    """Return a picture of a response: stops below white from left to right, code values from bottom to top.

    Parameters
    ----------
    brightness, lower, upper : ndarray, float64, shape (N,)
        The response and the ends of its band, in [0, 1], at uniform irradiances from 0 to 1.

    Returns
    -------
    ndarray, float32, shape (512, 512, 4)
        RGBA in [0, 1] as it is displayed, the bottom row first, as Blender stores images.
    """
    stops = DARKEST * (1 - (np.arange(SIZE) - LEFT) / WIDTH)  # (SIZE,), those of each column
    light = 2.0**stops
    inside = (stops >= DARKEST) & (stops <= 0)

    def at_columns(values: Float64Array) -> Float64Array:
        return np.interp(light, np.linspace(0, 1, len(values)), values)

    canvas = _empty_canvas()
    height = (np.arange(SIZE) - BELOW) / HEIGHT  # (SIZE,), 0 to 1 between the axes
    between = (height[:, None] >= at_columns(lower)) & (height[:, None] <= at_columns(upper)) & inside
    canvas[between, :3] = BAND
    dashes = inside & (np.arange(SIZE) // _DASH % 2 == 0)
    _draw_line(canvas, np.minimum(light, 1) ** (1 / 2.2), dashes, GAMMA)
    _draw_line(canvas, at_columns(brightness), inside, CURVE)
    return canvas


def _empty_canvas() -> Float32Array:
    """Return the background with a grid and the numbers at the axes."""
    canvas = np.empty((SIZE, SIZE, 4), np.float32)
    canvas[:] = (*BACKGROUND, 1)
    for stops in STOPS:
        column = LEFT + round((1 - stops / DARKEST) * WIDTH)
        canvas[BELOW : BELOW + HEIGHT + 1, column : column + 2, :3] = GRID
        _draw_number(canvas, stops, column, BELOW - _TALL - 8)
    for code in CODES:
        row = BELOW + round(code / 255 * HEIGHT)
        canvas[row : row + 2, LEFT : LEFT + WIDTH + 1, :3] = GRID
        _draw_number(canvas, code, LEFT - 8 - _length(code) // 2, row - _TALL // 2)
    return canvas


def _draw_number(canvas: Float32Array, number: int, middle: int, bottom: int) -> None:
    """Draw a whole number around a column, above a row."""
    left = middle - _length(number) // 2
    for place, sign in enumerate(str(number)):
        _draw_sign(canvas, sign, left + place * (_WIDE + _GAP), bottom)


def _draw_sign(canvas: Float32Array, sign: str, left: int, bottom: int) -> None:
    """Draw a digit or a minus with smooth edges."""
    coverage = _sign_coverage(sign)
    height, width = coverage.shape
    part = canvas[bottom - _PAD : bottom - _PAD + height, left - _PAD : left - _PAD + width, :3]
    part += coverage[..., None] * (np.array(NUMBER, np.float32) - part)


@lru_cache(maxsize=len(_SIGNS))
def _sign_coverage(sign: str) -> Float64Array:
    """Return how much of each pixel a sign covers, with `_PAD` pixels around the sign."""
    y, x = np.mgrid[-_PAD : _TALL + _PAD + 1, -_PAD : _WIDE + _PAD + 1]
    distances = [_distance(x, y, stroke * (_WIDE, _TALL)) for stroke in _SIGNS[sign]]
    return np.clip(_HALF_STROKE + 0.5 - np.min(distances, axis=0), 0, 1)


def _distance(x: Float64Array, y: Float64Array, points: Float64Array) -> Float64Array:
    """Return how far each pixel is from the line through some points."""
    pixels = np.stack([x, y], axis=-1)[..., None, :]  # (H, W, 1, 2)
    start, along = points[:-1], np.diff(points, axis=0)  # (N, 2)
    share = ((pixels - start) * along).sum(axis=-1) / (along**2).sum(axis=-1)
    nearest = start + np.clip(share, 0, 1)[..., None] * along
    return np.linalg.norm(pixels - nearest, axis=-1).min(axis=-1)


def _length(number: int) -> int:
    """Return the length of a number in pixels."""
    signs = len(str(number))
    return signs * _WIDE + (signs - 1) * _GAP


def _draw_line(
    canvas: Float32Array, brightness: Float64Array, columns: BoolArray, color: tuple[float, float, float]
) -> None:
    """Draw a line of constant width through one brightness per column, in the columns that are chosen."""
    rows = brightness * HEIGHT + BELOW
    vertical = np.abs(np.arange(SIZE)[:, None] - rows)  # (SIZE, SIZE)
    distance = vertical / np.hypot(1, np.gradient(rows))
    coverage = np.clip(_HALF_WIDTH + 0.5 - distance, 0, 1) * columns
    canvas[..., :3] += coverage[..., None] * (np.array(color, np.float32) - canvas[..., :3])
