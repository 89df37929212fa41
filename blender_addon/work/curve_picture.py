# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a response as pixels: code value over light in stops, with its 90 % band, and gamma 2.2 for comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crfnet_core.types import BoolArray, Float32Array, Float64Array

#: Pixels: the side of the picture, twice what the panel shows on a usual screen; its margins; the axes between them.
SIZE, MARGIN = 512, 22
EXTENT = SIZE - 2 * MARGIN - 1

DARKEST = -8  # light at the left end of the axis, in stops relative to white, which is at the right end
STOPS, CODES = (-8, -6, -4, -2, 0), (0, 64, 128, 192, 255)  # grid lines: the same stops, and 8-bit code values

#: Displayed colors, in [0, 1].
BACKGROUND, GRID = (0.11, 0.11, 0.11), (0.2, 0.2, 0.2)
BAND, GAMMA, CURVE = (0.22, 0.36, 0.5), (0.6, 0.6, 0.6), (1.0, 0.72, 0.25)

_HALF_WIDTH, _DASH = 2.0, 12  # of a line, and the length of a dash, in pixels


def draw_response(brightness: Float64Array, lower: Float64Array, upper: Float64Array) -> Float32Array:
    """Return a picture of a response: stops below white from left to right, code values from bottom to top.

    The response and the ends of its band, shape (N,), are brightness in [0, 1] at uniform irradiances from 0 to 1. The
    picture, shape (512, 512, 4), is displayed RGBA in [0, 1], the bottom row first, as Blender stores images.
    """
    stops = DARKEST * (1 - (np.arange(SIZE) - MARGIN) / EXTENT)  # (SIZE,), of each column
    light = 2.0**stops
    inside = (stops >= DARKEST) & (stops <= 0)

    def at_columns(values: Float64Array) -> Float64Array:
        return np.interp(light, np.linspace(0, 1, len(values)), values)

    canvas = _empty_canvas()
    height = (np.arange(SIZE) - MARGIN) / EXTENT  # (SIZE,), 0 to 1 between the axes
    between = (height[:, None] >= at_columns(lower)) & (height[:, None] <= at_columns(upper)) & inside
    canvas[between, :3] = BAND
    dashes = inside & (np.arange(SIZE) // _DASH % 2 == 0)
    _draw_line(canvas, np.minimum(light, 1) ** (1 / 2.2), dashes, GAMMA)
    _draw_line(canvas, at_columns(brightness), inside, CURVE)
    return canvas


def _empty_canvas() -> Float32Array:
    """Return the background with a grid."""
    canvas = np.empty((SIZE, SIZE, 4), np.float32)
    canvas[:] = (*BACKGROUND, 1)
    inside = slice(MARGIN, MARGIN + EXTENT + 1)
    for stops in STOPS:
        column = MARGIN + round((1 - stops / DARKEST) * EXTENT)
        canvas[inside, column : column + 2, :3] = GRID
    for code in CODES:
        row = MARGIN + round(code / 255 * EXTENT)
        canvas[row : row + 2, inside, :3] = GRID
    return canvas


def _draw_line(
    canvas: Float32Array, brightness: Float64Array, columns: BoolArray, color: tuple[float, float, float]
) -> None:
    """Draw a line of constant width through one brightness per column, in the columns of a mask."""
    rows = brightness * EXTENT + MARGIN
    vertical = np.abs(np.arange(SIZE)[:, None] - rows)  # (SIZE, SIZE)
    distance = vertical / np.hypot(1, np.gradient(rows))
    coverage = np.clip(_HALF_WIDTH + 0.5 - distance, 0, 1) * columns
    canvas[..., :3] += coverage[..., None] * (np.array(color, np.float32) - canvas[..., :3])
