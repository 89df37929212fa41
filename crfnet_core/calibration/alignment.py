"""Align the frames of a stack by integer shifts: phase correlation of rank images, which no exposure changes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crfnet_core.types import Float64Array

#: Longest side of the images that are compared, in samples.
LONGEST_SIDE = 900

#: Largest shift that is looked for, as a part of the shorter side.
LARGEST_SHIFT = 0.1

#: A shift is accepted if it raises the correlation of the two rank images by at least the first of these, to at least
#: the second.
LEAST_GAIN, LEAST_CORRELATION = 0.005, 0.4

#: Shifts along rows and columns, in pixels.
Shift = tuple[int, int]


def rank_image(gray: Float64Array) -> Float64Array:
    """Return ranks of brightness in [-1, 1] of an image of shape (H, W): equal under every increasing response."""
    values, index = np.unique(gray, return_inverse=True)
    counts = np.bincount(index.ravel(), minlength=values.size)
    middle = np.cumsum(counts) - counts / 2
    return np.asarray(2 * middle[index].reshape(gray.shape) / gray.size - 1, dtype=np.float64)


def chain_of_shifts(ranks: Sequence[Float64Array], order: Sequence[int], stride: int) -> tuple[Shift, ...]:
    """Return by how many pixels each frame is displaced from the middle one of `order`.

    Neighbours in `order` (of exposure) look most alike, so each is compared with the next and the shifts are added up.

    Parameters
    ----------
    ranks : sequence of ndarray, shape (h, w)
        Rank images of the frames.
    order : sequence of int
        The frames by exposure.
    stride : int
        Pixels of a frame between two samples of its rank image.
    """
    middle = len(order) // 2
    shifts: dict[int, Float64Array] = {order[middle]: np.zeros(2)}
    for index in range(middle, len(order) - 1):
        here, after = order[index], order[index + 1]
        shifts[after] = shifts[here] + displacement(ranks[here], ranks[after])
    for index in range(middle, 0, -1):
        here, before = order[index], order[index - 1]
        shifts[before] = shifts[here] + displacement(ranks[here], ranks[before])
    rounded = {frame: np.rint(shift * stride).astype(int).tolist() for frame, shift in shifts.items()}
    return tuple((rounded[frame][0], rounded[frame][1]) for frame in range(len(order)))


def displacement(first: Float64Array, second: Float64Array) -> Float64Array:
    """Return by how many samples (rows, columns) `second` is displaced, with fractions; 0 if that helps nothing.

    Source: Kuglin and Hines, "The phase correlation image alignment method", 1975.
    """
    window = np.outer(np.hanning(first.shape[0]), np.hanning(first.shape[1]))
    spectrum = np.fft.rfft2(second * window) * np.conj(np.fft.rfft2(first * window))
    surface = np.fft.irfft2(spectrum / np.maximum(np.abs(spectrum), 1e-9), s=first.shape)
    reach = max(1, round(LARGEST_SHIFT * min(first.shape)))
    near = np.roll(surface, (reach, reach), axis=(0, 1))[: 2 * reach + 1, : 2 * reach + 1]
    row, column = (int(index) for index in np.unravel_index(int(near.argmax()), near.shape))
    whole = (row - reach, column - reach)
    least = max(correlation(first, second, (0, 0)) + LEAST_GAIN, LEAST_CORRELATION)
    if correlation(first, second, whole) < least:
        return np.zeros(2)
    parts = _peak(near[:, column], row), _peak(near[row], column)
    return np.array(whole, dtype=np.float64) + parts


def correlation(first: Float64Array, second: Float64Array, shift: Shift) -> float:
    """Return the normalised cross-correlation of two images where they overlap, the second displaced by `shift`."""
    a, b = overlapping(first, second, shift)
    a, b = a - a.mean(), b - b.mean()
    return float((a * b).sum() / np.sqrt(max((a * a).sum() * (b * b).sum(), 1e-12)))


def overlapping(first: Float64Array, second: Float64Array, shift: Shift) -> tuple[Float64Array, Float64Array]:
    """Return the parts of two images that show the same, if the second is displaced by `shift` rows and columns."""
    height, width = first.shape
    down, right = shift
    rows = slice(max(0, -down), min(height, height - down))
    columns = slice(max(0, -right), min(width, width - right))
    moved = np.s_[rows.start + down : rows.stop + down, columns.start + right : columns.stop + right]
    return first[rows, columns], second[moved]


def common_area(shape: tuple[int, int], shifts: Sequence[Shift]) -> tuple[slice, slice]:
    """Return the rows and columns of the reference frame that every displaced frame shows."""
    rows, columns = (
        slice(max(0, -min(moves)), side - max(0, max(moves)))
        for side, moves in zip(shape, zip(*shifts, strict=True), strict=True)
    )
    return rows, columns


def _peak(row: Float64Array, index: int) -> float:
    """Return how far the vertex of the parabola through three samples is from the middle one, at most half a sample."""
    if not 0 < index < len(row) - 1:
        return 0.0
    before, here, after = (float(value) for value in row[index - 1 : index + 2])
    curvature = before - 2 * here + after
    return float(np.clip(0.5 * (before - after) / curvature, -0.5, 0.5)) if curvature < 0 else 0.0
