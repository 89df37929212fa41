"""Align the frames of a stack by integer shifts: phase correlation of rank images, which no exposure changes."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crfnet_core.types import Float64Array, IndexArray

#: Longest side of the images that are compared, in samples.
LONGEST_SIDE = 900

#: Largest shift that is looked for, as a part of the shorter side.
LARGEST_SHIFT = 0.1

#: A shift is accepted if it raises the correlation of the two rank images by at least the first of these, to at least
#: the second.
LEAST_GAIN, LEAST_CORRELATION = 0.005, 0.4


def align(pictures: Sequence[NDArray[Any]], order: Sequence[int]) -> tuple[list[NDArray[Any]], IndexArray]:
    """Return pictures (H, W, 3) cut to what they have in common, and the rows and columns by which each is displaced.

    `order` lists them by exposure. Neighbors look most alike, so each is compared with the next, and the shifts are
    added up; the middle one has the shift 0.
    """
    stride = -(-max(pictures[0].shape) // LONGEST_SIDE)
    ranks = [rank_image(picture[::stride, ::stride].mean(axis=2, dtype=np.float64)) for picture in pictures]
    steps = [displacement(ranks[first], ranks[second]) for first, second in pairwise(order)]
    places = np.cumsum([np.zeros(2), *steps], axis=0)
    shifts = np.zeros((len(order), 2), dtype=np.intp)
    shifts[list(order)] = np.rint((places - places[len(order) // 2]) * stride)
    return common_parts(pictures, shifts), shifts


def rank_image(gray: Float64Array) -> Float64Array:
    """Return ranks of brightness in [-1, 1] of an image of shape (H, W): equal under every increasing response."""
    _, index, counts = np.unique(gray, return_inverse=True, return_counts=True)
    middle = np.cumsum(counts) - counts / 2
    return np.asarray(2 * middle[index].reshape(gray.shape) / gray.size - 1, dtype=np.float64)


def displacement(first: Float64Array, second: Float64Array) -> Float64Array:
    """Return by how many samples (rows, columns) `second` is displaced, with fractions; 0 if that helps nothing.

    Source: Kuglin and Hines, "The phase correlation image alignment method", 1975.
    """
    window = np.outer(np.hanning(first.shape[0]), np.hanning(first.shape[1]))
    spectrum = np.fft.rfft2(second * window) * np.conj(np.fft.rfft2(first * window))
    surface = np.fft.irfft2(spectrum / np.maximum(np.abs(spectrum), 1e-9), s=first.shape)
    reach = max(1, round(LARGEST_SHIFT * min(first.shape)))
    near = np.roll(surface, (reach, reach), axis=(0, 1))[: 2 * reach + 1, : 2 * reach + 1]
    peak = np.array(np.unravel_index(near.argmax(), near.shape))
    still, moved = (_correlation(first, second, shift) for shift in (0 * peak, peak - reach))
    if moved < max(still + LEAST_GAIN, LEAST_CORRELATION):
        return np.zeros(2)
    part = [_vertex(near[:, peak[1]], peak[0]), _vertex(near[peak[0]], peak[1])]
    return np.asarray(peak - reach + part, dtype=np.float64)


def common_parts(pictures: Sequence[NDArray[Any]], shifts: IndexArray) -> list[NDArray[Any]]:
    """Return the parts of displaced pictures that show the same."""
    first, last = np.maximum(-shifts.min(axis=0), 0), pictures[0].shape[:2] - np.maximum(shifts.max(axis=0), 0)
    areas = [tuple(map(slice, first + shift, last + shift)) for shift in shifts]
    return [picture[area] for picture, area in zip(pictures, areas, strict=True)]


def _correlation(first: Float64Array, second: Float64Array, shift: IndexArray) -> float:
    """Return the correlation of two images where they overlap, the second displaced by `shift`; 0 if one is even."""
    a, b = (part - part.mean() for part in common_parts((first, second), np.stack([0 * shift, shift])))
    return float((a * b).sum() / np.sqrt(max((a * a).sum() * (b * b).sum(), 1e-12)))


def _vertex(row: Float64Array, index: int) -> float:
    """Return how far the vertex of the parabola through three samples is from the middle one; 0 at an end of a row."""
    if not 0 < index < len(row) - 1:
        return 0.0
    before, here, after = row[index - 1 : index + 2]
    return float(0.5 * (before - after) / min(before - 2 * here + after, -1e-12))
