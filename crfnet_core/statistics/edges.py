"""Edges: where the middle of three samples in a row lies between the outer two."""

from __future__ import annotations

from functools import cache

import numpy as np

from crfnet_core.statistics.gradients import STRIDES
from crfnet_core.statistics.sampling import CODES, Row, interpolation_weights, rows_and_columns
from crfnet_core.types import BoolArray, Float64Array, IndexArray, Uint8Array

#: Levels that the two sides of edges are first counted on.
EDGE_LEVELS = 64

#: Cells along each side of the grid (lower side, upper side) that edges are gathered into.
GRID = 16

#: Least height of an edge in codes: below it rounding decides where the middle lies.
LEAST_EDGE_HEIGHT = 6

SHAPES = {"edges": (len(STRIDES), 2, GRID, GRID)}


def edge_sums(planes: Uint8Array) -> Float64Array:
    """Return the number of edges and the sum of their encoded ratios, less a half, shape (5, 2, GRID, GRID).

    An edge is three samples a, b, c in a row with b between a and c. Its encoded ratio is (b - low) / (high - low), of
    the codes. Over many edges the mixing ratio in light is a half on average, so what is left of the encoded ratio at
    each cell (level of the lower side, level of the upper side) shows the curvature of the response there (Eq. 10).

    Parameters
    ----------
    planes : ndarray, uint8, shape (3, N, N)
        Codes; all channels are counted together.
    """
    sums = np.stack([_sums_by_level(planes, stride) for stride in STRIDES])  # (5, 2, 64, 64)
    cells = interpolation_weights(EDGE_LEVELS, GRID)
    gathered: Float64Array = cells.T @ sums @ cells
    return gathered


def _sums_by_level(planes: Uint8Array, stride: int) -> Float64Array:
    """Return the number of edges and the sum of their encoded ratios, less a half, shape (2, 64, 64)."""
    cells, ratios = [], []
    for plane in planes:
        for a, b, c in rows_and_columns(plane, stride, 3):
            low, high = np.minimum(a, c), np.maximum(a, c)
            index = np.flatnonzero((high - low > LEAST_EDGE_HEIGHT) & (b >= low) & (b <= high))
            low, middle, high = (side.take(index) for side in (low, b, high))
            cells.append((low >> 2).astype(np.uint16) * EDGE_LEVELS + (high >> 2))
            ratios.append(_encoded_ratios().take((middle - low).astype(np.uint16) << 8 | (high - low)))
    cell, ratio = np.concatenate(cells), np.concatenate(ratios)
    counts = np.bincount(cell, minlength=EDGE_LEVELS**2).astype(np.float64)
    sums = np.stack([counts, np.bincount(cell, ratio, minlength=EDGE_LEVELS**2)])
    return sums.reshape(2, EDGE_LEVELS, EDGE_LEVELS)


def shared_edges(row: Row, least_height: int) -> tuple[IndexArray, BoolArray]:
    """Return the edges that two channels or all three share.

    Parameters
    ----------
    row : tuple of three ndarrays, uint8, shape (3, M)
        Samples a, b and c in a row, of all channels.
    least_height : int
        An edge is higher than this, in codes.

    Returns
    -------
    ndarray, shape (N,), and ndarray, bool, shape (3, N)
        The indices at which two channels or more have an edge, and which channels these are.
    """
    a, b, c = row
    low, high = np.minimum(a, c), np.maximum(a, c)
    is_edge = (high - low > least_height) & (b >= low) & (b <= high)
    index = np.flatnonzero(is_edge.sum(axis=0, dtype=np.uint8) > 1)
    return index, is_edge.take(index, axis=1)


@cache
def _encoded_ratios() -> Float64Array:
    """Return the encoded ratio, less a half, of a middle i codes above the lower side of an edge j codes high."""
    code = np.arange(CODES)
    ratios: Float64Array = code[:, None] / np.maximum(code[None, :], 1) - 0.5
    return ratios
