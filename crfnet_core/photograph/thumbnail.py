"""Thumbnails: a photograph's scene in 16 x 16 cells, by which noise and photographs of one scene are recognized."""

from collections.abc import Sequence

import numpy as np

from crfnet_core.types import Float32Array, Float64Array, Pixels

SIDE = 16  # cells along each side

#: Correlation of neighboring cells below which there is no scene: 92 real photographs have at least 0.53, renderings of
#: 20 scenes 0.37, and noise, also blurred over a fortieth of the frame, at most 0.22.
LEAST_CORRELATION = 0.25

#: Correlation of neighboring samples of noise: white noise has 0, that of a mosaic 0.45; photographs of lawns, gravel
#: and bricks, whose cells are no more alike than those of noise, have 0.73 and more.
MOST_OF_NOISE = 0.6


def thumbnail(pixels: Pixels) -> Float64Array:
    """Return ranks of brightness on a coarse grid, shape (16, 16), which no exposure or response changes."""
    rows, columns = (np.linspace(0, side - 1, 4 * SIDE).round().astype(int) for side in pixels.shape[:2])
    samples = pixels[np.ix_(rows, columns)].mean(axis=2)  # (64, 64)
    cells = samples.reshape(SIDE, 4, SIDE, 4).mean(axis=(1, 3))
    return np.asarray(cells.ravel().argsort(kind="stable").argsort().reshape(cells.shape), np.float64)


def is_noise(cells: Float64Array, samples: Float32Array, *, has_camera: bool) -> bool:
    """Return whether a picture shows no scene: neighboring cells of its thumbnail are hardly more alike than any two.

    Nor are they in textures. If a camera is named, neighboring `samples`, shape (N, H, W, 3), have to differ, too.
    """
    may_be_texture = has_camera and _are_alike(samples.mean(axis=3), MOST_OF_NOISE)
    return not may_be_texture and not _are_alike(cells, LEAST_CORRELATION)


def _are_alike(planes: Float32Array | Float64Array, least: float) -> bool:
    """Return whether neighbors in planes, shape (..., H, W), correlate by this much."""
    centered = planes - planes.mean(axis=(-2, -1), keepdims=True)
    products = (centered[..., 1:, :] * centered[..., :-1, :]).mean() + (centered[..., 1:] * centered[..., :-1]).mean()
    return bool(products / 2 >= least * (centered**2).mean())


def scene_similarities(thumbnails: Sequence[Float64Array]) -> Float64Array:
    """Return the similarities of the scenes of photographs, shape (n, n): correlations of thumbnails, at least 0."""
    rows = np.stack([cells.ravel() for cells in thumbnails])
    rows = rows - rows.mean(axis=1, keepdims=True)
    lengths = np.maximum(np.linalg.norm(rows, axis=1), 1e-9)
    similarities = np.maximum(rows @ rows.T / np.outer(lengths, lengths), 0)
    np.fill_diagonal(similarities, 1)
    return np.asarray(similarities)
