"""Edges: where the middle of three samples in a row lies between the outer two."""

import numpy as np

from crfnet_core.statistics.gradients import STRIDES
from crfnet_core.statistics.sampling import Samples, Triples, interpolation_weights
from crfnet_core.types import Float64Array

EDGE_LEVELS = 64  # levels that the two sides of edges are first counted on
GRID = 16  # cells along each side of the grid (lower side, upper side) that edges are gathered into
LEAST_EDGE_HEIGHT = 6  # least height of an edge in codes: below it rounding decides where the middle lies

EDGES_SHAPE = (len(STRIDES), 2, GRID, GRID)


def edge_sums(samples: Samples) -> Float64Array:
    """Return the number of edges and the sum of their encoded ratios, less a half, shape (5, 2, GRID, GRID).

    An edge is three samples a, b, c in a row with b between a and c. Its encoded ratio is (b - low) / (high - low), of
    the codes. Over many edges the mixing ratio in light is a half on average, so the rest of the encoded ratio at
    each cell (level of the lower side, level of the upper side) shows the curvature of the response there (Eq. 10). All
    channels are counted together.
    """
    sums = np.stack([_sums_by_level(samples.triples(stride)) for stride in STRIDES])  # (5, 2, 64, 64)
    cells = interpolation_weights(EDGE_LEVELS, GRID)
    return np.asarray(cells.T @ sums @ cells)


def _sums_by_level(triples: Triples) -> Float64Array:
    """Return the number of edges and the sum of their encoded ratios, less a half, shape (2, 64, 64)."""
    index = np.flatnonzero(triples.are_edges(LEAST_EDGE_HEIGHT))
    low, height, rise = (part.take(index) for part in (triples.low, triples.height, triples.rise))
    cell = ((low >> 2).astype(np.uint16) * EDGE_LEVELS + (low + height >> 2)).astype(np.intp)
    ratio = rise / height.astype(np.float32) - np.float32(0.5)
    counts = np.bincount(cell, minlength=EDGE_LEVELS**2).astype(np.float64)
    sums = np.stack([counts, np.bincount(cell, ratio, minlength=EDGE_LEVELS**2)])
    return sums.reshape(2, EDGE_LEVELS, EDGE_LEVELS)
