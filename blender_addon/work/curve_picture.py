# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a response into pixels: the curve, its band, and gamma 2.2 for comparison."""

from __future__ import annotations

import numpy as np

#: Side of the picture in pixels, and what is left free around the axes.
SIZE, MARGIN = 256, 8

BACKGROUND = (0.11, 0.11, 0.11)
GRID = (0.2, 0.2, 0.2)
BAND = (0.22, 0.36, 0.5)
GAMMA = (0.6, 0.6, 0.6)
CURVE = (1.0, 0.72, 0.25)

_HALF_WIDTH = 1.2


def draw_response(brightness: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Return a picture of a response, irradiance from left to right, brightness upwards.

    Parameters
    ----------
    brightness, lower, upper : ndarray, shape (N,)
        The response and the ends of its band at uniform irradiances from 0 to 1.

    Returns
    -------
    ndarray, float32, shape (256, 256, 4)
        RGBA as it is shown, the bottom row first.
    """
    canvas = np.empty((SIZE, SIZE, 4), np.float32)
    canvas[:] = (*BACKGROUND, 1)
    span = SIZE - 2 * MARGIN
    columns = (np.arange(SIZE) - MARGIN) / (span - 1)
    rows = columns[:, None]
    inside = (columns >= 0) & (columns <= 1)
    irradiance = np.linspace(0, 1, len(brightness))

    def at(values: np.ndarray) -> np.ndarray:
        return np.interp(columns, irradiance, values)

    for quarter in np.rint(MARGIN + np.arange(5) / 4 * (span - 1)).astype(int):
        canvas[quarter, inside, :3] = canvas[inside, quarter, :3] = GRID
    between = (rows >= at(lower)) & (rows <= at(upper)) & inside
    canvas[between, :3] = BAND
    dashes = inside & (np.arange(SIZE) // 6 % 2 == 0)
    _stroke(canvas, at(irradiance ** (1 / 2.2)) * (span - 1) + MARGIN, dashes, GAMMA)
    _stroke(canvas, at(brightness) * (span - 1) + MARGIN, inside, CURVE)
    return canvas


def _stroke(canvas: np.ndarray, heights: np.ndarray, inside: np.ndarray, colour: tuple[float, float, float]) -> None:
    """Draw a line through one height per column, of the same width however steep it is."""
    slope = np.gradient(heights)
    distance = np.abs(np.arange(len(canvas))[:, None] - heights) / np.hypot(1, slope)
    cover = np.clip(_HALF_WIDTH + 0.5 - distance, 0, 1) * inside
    canvas[..., :3] += cover[..., None] * (np.array(colour, np.float32) - canvas[..., :3])
