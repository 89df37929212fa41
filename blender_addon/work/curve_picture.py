# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a response as pixels: the curve, its 90 % band, and gamma 2.2 for comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crfnet_core.types import BoolArray, Float32Array, Float64Array

#: Side of the square picture, and the margin around its axes, in pixels.
SIZE, MARGIN = 256, 8

#: Colours as they are displayed, in [0, 1].
BACKGROUND = (0.11, 0.11, 0.11)
GRID = (0.2, 0.2, 0.2)
BAND = (0.22, 0.36, 0.5)
GAMMA = (0.6, 0.6, 0.6)
CURVE = (1.0, 0.72, 0.25)

#: Pixels from one axis to the other.
_SPAN = SIZE - 2 * MARGIN - 1

#: Half the width of a line, and the length of a dash, in pixels.
_HALF_WIDTH, _DASH = 1.2, 6


def draw_response(brightness: Float64Array, lower: Float64Array, upper: Float64Array) -> Float32Array:
    """Return a picture of a response: irradiance from left to right, brightness from bottom to top.

    Parameters
    ----------
    brightness, lower, upper : ndarray, float64, shape (N,)
        The response and the ends of its band, in [0, 1], at uniform irradiances from 0 to 1.

    Returns
    -------
    ndarray, float32, shape (256, 256, 4)
        RGBA in [0, 1] as it is displayed, the bottom row first, as Blender stores images.
    """
    irradiance = np.linspace(0, 1, len(brightness))
    axis = (np.arange(SIZE) - MARGIN) / _SPAN  # (SIZE,), 0 to 1 between the margins

    def at_columns(values: Float64Array) -> Float64Array:
        return np.interp(axis, irradiance, values)

    inside = (axis >= 0) & (axis <= 1)
    canvas = _empty_canvas(inside)
    between = (axis[:, None] >= at_columns(lower)) & (axis[:, None] <= at_columns(upper)) & inside
    canvas[between, :3] = BAND
    dashes = inside & (np.arange(SIZE) // _DASH % 2 == 0)
    _draw_line(canvas, at_columns(irradiance ** (1 / 2.2)), dashes, GAMMA)
    _draw_line(canvas, at_columns(brightness), inside, CURVE)
    return canvas


def _empty_canvas(inside: BoolArray) -> Float32Array:
    """Return the background with a grid at every quarter of the axes."""
    canvas = np.empty((SIZE, SIZE, 4), np.float32)
    canvas[:] = (*BACKGROUND, 1)
    for quarter in np.rint(MARGIN + np.arange(5) / 4 * _SPAN).astype(int):
        canvas[quarter, inside, :3] = canvas[inside, quarter, :3] = GRID
    return canvas


def _draw_line(
    canvas: Float32Array, brightness: Float64Array, columns: BoolArray, color: tuple[float, float, float]
) -> None:
    """Draw a line of constant width through one brightness per column, in the columns that are chosen."""
    rows = brightness * _SPAN + MARGIN
    vertical = np.abs(np.arange(SIZE)[:, None] - rows)  # (SIZE, SIZE)
    distance = vertical / np.hypot(1, np.gradient(rows))
    coverage = np.clip(_HALF_WIDTH + 0.5 - distance, 0, 1) * columns
    canvas[..., :3] += coverage[..., None] * (np.array(color, np.float32) - canvas[..., :3])
