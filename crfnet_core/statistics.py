"""Count in a window what traces the bend of the response (numpy only; the network normalises the counts)."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crfnet_core.candidates import (
    BANDS,
    BLOCK_STRIDES,
    CANDIDATES,
    CHANNEL_PAIRS,
    COMPARED_KINDS,
    KINDS,
    MIXING_STRIDES,
    SHADING,
    SHARE_SUMS,
    Mixtures,
    disagreement_sums,
    shading_sums,
    share_sums,
    shared_edges,
)

#: Code values that samples are counted on.
CODES = 256

#: Levels that counts over code values are gathered into.
LEVELS = 64

#: Distances between neighbours, in samples.
STRIDES = (1, 2, 4, 8, 16)

#: Levels that edges are first counted on, and cells along each side of the grid that they are gathered into.
EDGE_LEVELS, GRID = 64, 16

#: Codes between the two sides of an edge, more than which the place of its middle means anything.
LEAST_EDGE = 6

#: Sums per channel, level and stride: see `window_statistics`.
NEIGHBOUR_SUMS = 5

#: Strides and levels of the equations between channels.
COLOR_STRIDES, COLOR_LEVELS = (1, 2, 4, 8), 20

#: Codes between the two sides of an edge, more than which it is compared between channels, and the difference of the
#: places of its middle from which on it is no mixture of its sides.
LEAST_COLOR_EDGE, MOST_APART = 12, 0.3

#: Shapes of what is counted at every candidate response: sums and the numbers that they are of, in turn.
CANDIDATE_PARTS = (
    (len(MIXING_STRIDES), KINDS, SHARE_SUMS, CANDIDATES),
    (len(MIXING_STRIDES), KINDS, 1, 1),
    (len(MIXING_STRIDES), COMPARED_KINDS, BANDS, CANDIDATES),
    (len(MIXING_STRIDES), COMPARED_KINDS, BANDS, 1),
    (len(SHADING), CANDIDATES),
    (len(SHADING), 1),
    (len(BLOCK_STRIDES), COMPARED_KINDS, BANDS, CANDIDATES),
    (len(BLOCK_STRIDES), COMPARED_KINDS, BANDS, 1),
)

#: Shapes of the parts of a window's statistics, in their order.
PARTS = (
    (3, LEVELS),
    (len(STRIDES), 3, NEIGHBOUR_SUMS, LEVELS),
    (len(STRIDES), 2, GRID, GRID),
    (len(COLOR_STRIDES), COLOR_LEVELS + 1, COLOR_LEVELS),
    *CANDIDATE_PARTS,
)

#: Length of a window's statistics.
STATISTICS = sum(int(np.prod(part)) for part in PARTS)

Floats = NDArray[np.float32]
Codes = NDArray[np.uint8]


def window_statistics(window: Floats) -> Floats:
    """Return the statistics of one window, float32 (STATISTICS,), which add up over windows.

    Irradiance mixes linearly across an edge, and its relative gradients hardly depend on its level. So both the
    differences between neighbours at each brightness level, and the place of the middle one b of three samples a, b, c
    in a row between the outer two, follow the slope and the bend of the response. What is more, b mixes the same shares
    of a and c in all channels: where the channels differ in level, their places of b differ by the bend of the response
    alone, whatever the scene. The ideas are those of Lin, Gu, Yamazaki & Shum, "Radiometric calibration from a single
    image", CVPR 2004.

    The parts, concatenated (shapes in `PARTS`): per channel and level the number of samples; per stride, channel and
    level, over both neighbours along rows and columns, the sums of |d|, log(1 + |d|), d = 0, d (in codes) and 1; per
    stride and cell (lower level, upper level), over all channels, the number of edges and the sum of the places of b,
    in -0.5 .. 0.5 around the middle; per colour stride the normal equations A k = r, the rows of A and then r, whose
    solution k is the bend of the inverse response, g''/g', at `COLOR_LEVELS` levels; and per stride how far from linear
    light the window is under each candidate response, with the numbers of samples (`crfnet_core.candidates`).

    Parameters
    ----------
    window : ndarray, float32, shape (227, 227, 3)
        Code values in [0, 1]; not changed.
    """
    codes = np.rint(window * np.float32(CODES - 1)).astype(np.uint8)
    planes = np.ascontiguousarray(codes.transpose(2, 0, 1))
    levels, cells = _triangles(CODES, LEVELS), _triangles(EDGE_LEVELS, GRID)
    histogram = np.stack([np.bincount(plane.ravel(), minlength=CODES) for plane in planes])
    neighbours = np.stack([_neighbour_sums(planes, stride) for stride in STRIDES])
    edges = np.stack([_edge_sums(planes, stride) for stride in STRIDES])
    colors = np.stack([_color_equations(planes, stride) for stride in COLOR_STRIDES])
    mixtures = [Mixtures.among(_both_ways(planes, stride, 5)) for stride in MIXING_STRIDES]
    blocks = _blocks(planes)
    block_mixtures = [Mixtures.among(_both_ways(blocks, stride, 5)) for stride in BLOCK_STRIDES]
    pairs = {stride: _both_ways(planes, stride, 2) for stride in {stride for stride, _ in SHADING}}
    by_candidate = (
        map(share_sums, mixtures),
        map(disagreement_sums, mixtures),
        (shading_sums(pairs[stride], change) for stride, change in SHADING),
        map(disagreement_sums, block_mixtures),
    )
    candidates = [np.stack(part) for sums in by_candidate for part in zip(*sums, strict=True)]
    parts = (histogram @ levels, neighbours @ levels, cells.T @ edges @ cells, colors, *candidates)
    return np.concatenate([part.ravel() for part in parts]).astype(np.float32)


def _neighbour_sums(planes: Codes, stride: int) -> NDArray[np.float32]:
    """Return the five sums over the neighbours of samples at each code, shape (3, 5, 256)."""
    tables, sums = _difference_tables(), np.empty((3, NEIGHBOUR_SUMS, CODES), np.float32)
    for plane, into in zip(planes, sums, strict=True):
        pairs = [(first.astype(np.uint16) << 8) | second for first, second in _lines(plane, stride, (0, 1))]
        counts = np.bincount(np.concatenate(pairs), minlength=CODES * CODES).reshape(CODES, CODES).astype(np.float32)
        np.einsum("ij,kij->ki", counts + counts.T, tables, out=into)
    return sums


def _edge_sums(planes: Codes, stride: int) -> NDArray[np.float64]:
    """Return the number of edges and the sum of the places of their middles, shape (2, 64, 64)."""
    cells, places = [], []
    for plane in planes:
        for a, b, c in _lines(plane, stride, (0, 1, 2)):
            low, high = np.minimum(a, c), np.maximum(a, c)
            edge = np.flatnonzero((high - low > LEAST_EDGE) & (b >= low) & (b <= high))
            low, middle, high = (side.take(edge) for side in (low, b, high))
            cells.append((low >> 2).astype(np.uint16) * EDGE_LEVELS + (high >> 2))
            places.append(_places().take((middle - low).astype(np.uint16) << 8 | (high - low)))
    cell, place = np.concatenate(cells), np.concatenate(places)
    counts = np.bincount(cell, minlength=EDGE_LEVELS**2).astype(np.float64)
    sums = np.stack([counts, np.bincount(cell, place, minlength=EDGE_LEVELS**2)])
    return sums.reshape(2, EDGE_LEVELS, EDGE_LEVELS)


def _color_equations(planes: Codes, stride: int) -> Floats:
    """Return the normal equations between channels, the matrix and below it the right side, shape (21, 20).

    In encoded values the place of b is p + p (1 - p) / 2 * h * k(m) to first order, where h is the signed height c - a
    of the edge, m its middle level and k the bend. The difference between two channels is free of p. Its variance is
    that of rounding, which goes with 1 / h ** 2.
    """
    equations = np.zeros((COLOR_LEVELS + 1, COLOR_LEVELS))
    for line in _lines(planes, stride, (0, 1, 2)):
        places, is_edge = shared_edges(line, LEAST_COLOR_EDGE)
        a, b, c = (side.take(places, axis=1).astype(np.int16) for side in line)
        heights, rises, levels = c - a, b - a, (a + c) * COLOR_LEVELS // (2 * CODES - 1)
        for pair in CHANNEL_PAIRS:
            chosen = np.flatnonzero(is_edge[pair[0]] & is_edge[pair[1]])
            sides = [[array[n].take(chosen) for array in (heights, rises, levels)] for n in pair]
            _add_pair(equations, *sides)
    return equations.astype(np.float32)


def _add_pair(equations: NDArray[np.float64], first: list[NDArray[Any]], second: list[NDArray[Any]]) -> None:
    """Add the equations between the heights, rises and levels, each (M,), of the same edges in two channels."""
    (height, rise, level), (other_height, other_rise, other_level) = first, second
    h, other_h = (side / np.float32(CODES - 1) for side in (height, other_height))
    place, other_place = rise / height.astype(np.float32), other_rise / other_height.astype(np.float32)
    apart, mean = place - other_place, (place + other_place) / 2
    mixing = mean * (1 - mean) / 2
    weight = (height * other_h) ** 2 / (h * h + other_h * other_h) * (np.abs(apart) < MOST_APART)
    squared, linear = weight * mixing * mixing, weight * mixing * apart
    cell = level * COLOR_LEVELS + other_level
    own, other, cross, right, other_right = (
        np.bincount(cell, amounts, minlength=COLOR_LEVELS**2).reshape(COLOR_LEVELS, COLOR_LEVELS)
        for amounts in (squared * h * h, squared * other_h**2, squared * h * other_h, linear * h, linear * other_h)
    )
    equations[:-1] += np.diag(own.sum(axis=1) + other.sum(axis=0)) - cross - cross.T
    equations[-1] += right.sum(axis=1) - other_right.sum(axis=0)


def _lines(planes: Codes, stride: int, places: tuple[int, ...]) -> list[tuple[Codes, ...]]:
    """Return samples in a row, `stride` apart, of planes (..., N, N), along rows and along columns, as (..., M).

    Neighbours on adjacent lines say nearly the same, so not every line is looked at.
    """
    size, skip = planes.shape[-1] - places[-1] * stride, max(2, stride // 4)
    starts = [place * stride for place in places]
    rows = tuple(planes[..., ::skip, start : start + size] for start in starts)
    columns = tuple(planes[..., start : start + size, ::skip] for start in starts)
    return [tuple(side.reshape(*planes.shape[:-2], -1) for side in line) for line in (rows, columns)]


def _both_ways(planes: Codes, stride: int, count: int) -> tuple[Codes, ...]:
    """Return `count` samples in a row, `stride` apart, along rows and then along columns, each (3, M)."""
    rows, columns = _lines(planes, stride, tuple(range(count)))
    return tuple(np.concatenate(sides, axis=1) for sides in zip(rows, columns, strict=True))


def _blocks(planes: Codes) -> Codes:
    """Return the means of 2 x 2 samples, rounded, of planes (3, 227, 227), shape (3, 113, 113)."""
    rows = planes[:, :-1:2].astype(np.uint16) + planes[:, 1::2]
    means: Codes = ((rows[:, :, :-1:2] + rows[:, :, 1::2] + 2) >> 2).astype(np.uint8)
    return means


@cache
def _difference_tables() -> NDArray[np.float32]:
    """Return |d|, log(1 + |d|), d = 0, d and 1 for a sample of code i with a neighbour of code j = i + d."""
    code = np.arange(CODES, dtype=np.float32)
    difference = code[None, :] - code[:, None]
    size = np.abs(difference)
    return np.stack([size, np.log1p(size), difference == 0, difference, np.ones_like(size)]).astype(np.float32)


@cache
def _places() -> NDArray[np.float64]:
    """Return the place, -0.5 .. 0.5, of a middle sample `i` codes above the lower side of an edge `j` codes high."""
    code = np.arange(CODES)
    places: NDArray[np.float64] = code[:, None] / np.maximum(code[None, :], 1) - 0.5
    return places


@cache
def _triangles(codes: int, levels: int) -> NDArray[np.float32]:
    """Return the linear-interpolation memberships of `codes` values in `levels` centres, shape (codes, levels)."""
    place = np.linspace(0, levels - 1, codes)[:, None]
    triangles: NDArray[np.float32] = np.maximum(1 - np.abs(place - np.arange(levels)), 0).astype(np.float32)
    return triangles
