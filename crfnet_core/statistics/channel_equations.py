"""Linear equations for the curvature of the inverse response, from the differences between channels at edges.

At an edge a, b, c let the light of b mix that of a and c in the ratio alpha, the same in every channel (Eq. 2 of
docs/METHOD.md). In codes the ratio is, to first order (Eq. 3),

    (b - a) / h = alpha + alpha (1 - alpha) h k(m) / 2,    h = c - a,  m = (a + c) / 2,  k = g'' / g'

The difference between two channels is free of alpha and linear in the curvature k at the channels' two levels m.
Least squares over all edges of a window gives normal equations A k = r, which add up over windows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crfnet_core.statistics.edges import shared_edges
from crfnet_core.statistics.sampling import CHANNEL_PAIRS, CODES, rows_and_columns
from crfnet_core.types import Float32Array, Float64Array, Int16Array, Uint8Array

#: Distances between the samples of an edge.
EQUATION_STRIDES = (1, 2, 4, 8)

#: Levels of brightness at which the curvature is asked for.
EQUATION_LEVELS = 20

#: Least height in codes of an edge that is compared between channels.
LEAST_COMPARED_HEIGHT = 12

#: Difference between the encoded ratios of two channels from which on b is no mixture of a and c.
MOST_RATIO_DIFFERENCE = 0.3

SHAPES = {"channel_equations": (len(EQUATION_STRIDES), EQUATION_LEVELS + 1, EQUATION_LEVELS)}


class _Edges(NamedTuple):
    """Edges in one channel, arrays (M,): height c - a and rise b - a in codes, and the level of the middle."""

    height: Int16Array
    rise: Int16Array
    level: Int16Array


def channel_equations(planes: Uint8Array) -> Float32Array:
    """Return the normal equations at each stride (Eq. 12), the rows of A and below them r, shape (4, 21, 20).

    Parameters
    ----------
    planes : ndarray, uint8, shape (3, N, N)
        Codes.
    """
    return np.stack([_normal_equations(planes, stride) for stride in EQUATION_STRIDES])


def _normal_equations(planes: Uint8Array, stride: int) -> Float32Array:
    """Return the normal equations of all edges at one stride, shape (21, 20)."""
    equations = np.zeros((EQUATION_LEVELS + 1, EQUATION_LEVELS))
    for row in rows_and_columns(planes, stride, 3):
        index, is_edge = shared_edges(row, LEAST_COMPARED_HEIGHT)
        a, b, c = (side.take(index, axis=1).astype(np.int16) for side in row)  # (3, M)
        of_all = (c - a, b - a, (a + c) * EQUATION_LEVELS // (2 * CODES - 1))
        for pair in CHANNEL_PAIRS:
            chosen = np.flatnonzero(is_edge[pair[0]] & is_edge[pair[1]])
            first, second = (_Edges(*(part[channel].take(chosen) for part in of_all)) for channel in pair)
            _add_pair(equations, first, second)
    return equations.astype(np.float32)


def _add_pair(equations: Float64Array, first: _Edges, second: _Edges) -> None:
    """Add the equations between the same edges, seen in two channels.

    An equation (Eq. 11) reads x (h1 k1 - h2 k2) = d: x = alpha (1 - alpha) / 2, and d is the difference of the encoded
    ratios. Its weight is the inverse variance of d from rounding, which goes with 1 / h1 ** 2 + 1 / h2 ** 2.
    """
    h1, h2 = (side.height / np.float32(CODES - 1) for side in (first, second))
    ratio1, ratio2 = (side.rise / side.height.astype(np.float32) for side in (first, second))
    difference, mean_ratio = ratio1 - ratio2, (ratio1 + ratio2) / 2
    x = mean_ratio * (1 - mean_ratio) / 2
    weight = (first.height * h2) ** 2 / (h1 * h1 + h2 * h2) * (np.abs(difference) < MOST_RATIO_DIFFERENCE)
    squared, linear = weight * x * x, weight * x * difference
    cell = first.level * EQUATION_LEVELS + second.level
    own1, own2, cross, right1, right2 = (
        np.bincount(cell, terms, minlength=EQUATION_LEVELS**2).reshape(EQUATION_LEVELS, EQUATION_LEVELS)
        for terms in (squared * h1 * h1, squared * h2**2, squared * h1 * h2, linear * h1, linear * h2)
    )
    equations[:-1] += np.diag(own1.sum(axis=1) + own2.sum(axis=0)) - cross - cross.T
    equations[-1] += right1.sum(axis=1) - right2.sum(axis=0)
