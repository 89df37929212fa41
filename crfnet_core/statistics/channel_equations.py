"""Linear equations for the curvature of the inverse response, from the differences between channels at edges.

At an edge a, b, c the light of b mixes the light of a and c in the ratio alpha, the same in every channel (Eq. 2 of
docs/METHOD.md). In codes the ratio is, to first order (Eq. 3),

    (b - a) / h = alpha + alpha (1 - alpha) h k(m) / 2,    h = c - a,  m = (a + c) / 2,  k = g'' / g'

The difference between two channels is free of alpha and linear in the curvature k at the channels' two levels m.
Least squares over all edges of a window gives normal equations A k = r, which add up over windows.
"""

import numpy as np

from crfnet_core.statistics.sampling import CHANNEL_PAIRS, CODES, Samples, Triples
from crfnet_core.types import Float32Array, Float64Array

EQUATION_STRIDES = (1, 2, 4, 8)  # distances between the samples of an edge
EQUATION_LEVELS = 20  # levels of brightness at which the curvature is asked for
LEAST_COMPARED_HEIGHT = 12  # least height in codes of an edge that is compared between channels

#: Difference between the encoded ratios of two channels from which on b is not a mixture of a and c.
MOST_RATIO_DIFFERENCE = 0.3

EQUATIONS_SHAPE = (len(EQUATION_STRIDES), EQUATION_LEVELS + 1, EQUATION_LEVELS)


def channel_equations(samples: Samples) -> Float32Array:
    """Return the normal equations at each stride (Eq. 12), the rows of A and below them r, shape (4, 21, 20)."""
    return np.stack([_normal_equations(samples.triples(stride)) for stride in EQUATION_STRIDES])


def _normal_equations(triples: Triples) -> Float32Array:
    """Return the normal equations of all edges at one stride, shape (21, 20)."""
    equations = np.zeros((EQUATION_LEVELS + 1, EQUATION_LEVELS))
    is_edge = triples.are_edges(LEAST_COMPARED_HEIGHT)
    for pair in CHANNEL_PAIRS:
        index = np.flatnonzero(is_edge[pair[0]] & is_edge[pair[1]])
        _add_pair(equations, *(triples.of_channel(channel, index) for channel in pair))
    return equations.astype(np.float32)


def _add_pair(equations: Float64Array, *channels: tuple[Float32Array, Float32Array, Float32Array]) -> None:
    """Add the equations between the same edges a, b, c, seen in two channels, codes (M,).

    An equation (Eq. 11) reads x (h1 k1 - h2 k2) = d: x = alpha (1 - alpha) / 2, and d is the difference of the encoded
    ratios. Its weight is the inverse variance of d from rounding, which goes with 1 / h1 ** 2 + 1 / h2 ** 2.
    """
    h1, h2 = (c - a for a, _, c in channels)
    ratio1, ratio2 = ((b - a) / h for (a, b, _), h in zip(channels, (h1, h2), strict=True))
    level1, level2 = (((a + c) * np.float32(EQUATION_LEVELS / (2 * CODES - 1))).astype(np.intp) for a, _, c in channels)
    difference, mean_ratio = ratio1 - ratio2, (ratio1 + ratio2) / 2
    x = mean_ratio * (1 - mean_ratio) / 2
    weight = (h1 * h2) ** 2 / (h1 * h1 + h2 * h2) * (np.abs(difference) < MOST_RATIO_DIFFERENCE)
    x1, x2 = x * h1, x * h2
    weighted1, weighted2 = weight * x1, weight * x2
    cell = level1 * EQUATION_LEVELS + level2
    products = (weighted1 * x1, weighted2 * x2, weighted1 * x2, weighted1 * difference, weighted2 * difference)
    squared1, squared2, cross, right1, right2 = (
        np.bincount(cell, terms, minlength=EQUATION_LEVELS**2).reshape(EQUATION_LEVELS, EQUATION_LEVELS)
        for terms in products
    )
    equations[:-1] += (np.diag(squared1.sum(axis=1) + squared2.sum(axis=0)) - cross - cross.T) / (CODES - 1) ** 2
    equations[-1] += (right1.sum(axis=1) - right2.sum(axis=0)) / (CODES - 1)
