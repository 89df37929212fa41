"""Align the frames of a stack by integer shifts: phase correlation of rank images, which no exposure changes."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    _, index, counts = np.unique(gray, return_inverse=True, return_counts=True)
    middle = np.cumsum(counts) - counts / 2
    return np.asarray(2 * middle[index].reshape(gray.shape) / gray.size - 1, dtype=np.float64)


def chain_of_shifts(ranks: Sequence[Float64Array], order: Sequence[int], stride: int) -> tuple[Shift, ...]:
    """Return by how many pixels each frame is displaced from the middle one of `order`, the frames by exposure.

    Neighbors in `order` look most alike, so each rank image is compared with the next and the shifts are added up.
    `stride` is the number of pixels between two samples of a rank image.
    """
    steps = [displacement(ranks[first], ranks[second]) for first, second in pairwise(order)]
    places = np.cumsum([np.zeros(2), *steps], axis=0)
    shifts = np.zeros((len(order), 2), dtype=int)
    shifts[list(order)] = np.rint((places - places[len(order) // 2]) * stride)
    return tuple((int(down), int(right)) for down, right in shifts)


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
    if _correlation(first, second, whole) < max(_correlation(first, second, (0, 0)) + LEAST_GAIN, LEAST_CORRELATION):
        return np.zeros(2)
    return np.array([whole[0] + _vertex(near[:, column], row), whole[1] + _vertex(near[row], column)])


def common_parts(images: Sequence[NDArray[Any]], shifts: Sequence[Shift]) -> tuple[NDArray[Any], ...]:
    """Return the parts of displaced images that show the same."""
    moves = np.array(shifts)
    first, last = np.maximum(-moves.min(axis=0), 0), images[0].shape[:2] - np.maximum(moves.max(axis=0), 0)
    areas = [tuple(map(slice, first + move, last + move)) for move in moves]
    return tuple(image[area] for image, area in zip(images, areas, strict=True))


def _correlation(first: Float64Array, second: Float64Array, shift: Shift) -> float:
    """Return the normalized cross-correlation of two images where they overlap, the second displaced by `shift`."""
    a, b = (part - part.mean() for part in common_parts((first, second), ((0, 0), shift)))
    return float((a * b).sum() / np.sqrt(max((a * a).sum() * (b * b).sum(), 1e-12)))


def _vertex(row: Float64Array, index: int) -> float:
    """Return how far the vertex of the parabola through three samples is from the middle one, at most half a sample."""
    if not 0 < index < len(row) - 1:
        return 0.0
    before, here, after = (float(value) for value in row[index - 1 : index + 2])
    curvature = before - 2 * here + after
    return float(np.clip(0.5 * (before - after) / curvature, -0.5, 0.5)) if curvature < 0 else 0.0
