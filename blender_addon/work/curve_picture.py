# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a response as pixels: code value over light in stops, with its 90 % band, and gamma 2.2 for comparison."""

from __future__ import annotations

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

#: The signs of numbers: five rows of three pixels each, from the top; and the side of such a pixel in the picture.
_SIGNS = {
    "0": "### #.# #.# #.# ###",
    "1": ".#. ##. .#. .#. ###",
    "2": "### ..# ### #.. ###",
    "4": "#.# #.# ### ..# ..#",
    "5": "### #.. ### ..# ###",
    "6": "### #.. ### #.# ###",
    "8": "### #.# ### #.# ###",
    "9": "### #.# ### ..# ###",
    "-": "... ... ### ... ...",
}
_DOT = 4


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
        _draw_number(canvas, stops, column, BELOW - 7 * _DOT)
    for code in CODES:
        row = BELOW + round(code / 255 * HEIGHT)
        canvas[row : row + 2, LEFT : LEFT + WIDTH + 1, :3] = GRID
        _draw_number(canvas, code, LEFT - 2 * _DOT - _length(code) // 2, row - 5 * _DOT // 2)
    return canvas


def _draw_number(canvas: Float32Array, number: int, middle: int, bottom: int) -> None:
    """Draw a whole number around a column, above a row."""
    left = middle - _length(number) // 2
    for place, sign in enumerate(str(number)):
        rows = [[dot == "#" for dot in row] for row in reversed(_SIGNS[sign].split())]
        dots = np.kron(np.array(rows), np.ones((_DOT, _DOT), bool)).astype(bool)  # (20, 12)
        start = left + place * 4 * _DOT
        canvas[bottom : bottom + dots.shape[0], start : start + dots.shape[1], :3][dots] = NUMBER


def _length(number: int) -> int:
    """Return the length of a number in pixels: three dots for each sign, and one between two signs."""
    return (4 * len(str(number)) - 1) * _DOT


def _draw_line(
    canvas: Float32Array, brightness: Float64Array, columns: BoolArray, color: tuple[float, float, float]
) -> None:
    """Draw a line of constant width through one brightness per column, in the columns that are chosen."""
    rows = brightness * HEIGHT + BELOW
    vertical = np.abs(np.arange(SIZE)[:, None] - rows)  # (SIZE, SIZE)
    distance = vertical / np.hypot(1, np.gradient(rows))
    coverage = np.clip(_HALF_WIDTH + 0.5 - distance, 0, 1) * columns
    canvas[..., :3] += coverage[..., None] * (np.array(color, np.float32) - canvas[..., :3])
