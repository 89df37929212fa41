"""Edges: where the middle of three samples in a row lies between the outer two."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crfnet_core.statistics.gradients import STRIDES
from crfnet_core.statistics.sampling import Row, interpolation_weights
from crfnet_core.types import BoolArray, Float32Array, Float64Array, IndexArray, Uint8Array

#: Levels that the two sides of edges are first counted on.
EDGE_LEVELS = 64

#: Cells along each side of the grid (lower side, upper side) that edges are gathered into.
GRID = 16

#: Least height of an edge in codes: below it rounding decides where the middle lies.
LEAST_EDGE_HEIGHT = 6

SHAPES = {"edges": (len(STRIDES), 2, GRID, GRID)}


class Triples(NamedTuple):
    """Three samples a, b, c in a row, and what tells whether they are an edge, each uint8 (3, M).

    Parameters
    ----------
    a, b, c, low : ndarray
        Codes; low is the lower one of a and c.
    height, rise : ndarray
        Codes from low to the other side, and to b. For b below low, the rise is (b - low) modulo 256, which is more
        than any height can be. So b lies between a and c exactly if the rise is at most the height.
    """

    a: Uint8Array
    b: Uint8Array
    c: Uint8Array
    low: Uint8Array
    height: Uint8Array
    rise: Uint8Array

    @classmethod
    def among(cls, row: Row) -> Triples:
        """Return the triples of three samples in a row, each uint8 (3, M)."""
        a, b, c = row
        low = np.minimum(a, c)
        return cls(a, b, c, low, np.maximum(a, c) - low, b - low)

    def are_edges(self, least_height: int) -> BoolArray:
        """Return which triples are edges higher than this, in codes: b lies between a and c."""
        is_edge: BoolArray = self.rise <= self.height
        is_edge &= self.height > least_height
        return is_edge

    def of_channel(self, channel: int, index: IndexArray) -> tuple[Float32Array, Float32Array, Float32Array]:
        """Return a, b and c of one channel at some indices, each (len(index),)."""
        a, b, c = (side[channel].take(index).astype(np.float32) for side in self[:3])
        return a, b, c


def edge_sums(triples: Sequence[Triples]) -> Float64Array:
    """Return the number of edges and the sum of their encoded ratios, less a half, shape (5, 2, GRID, GRID).

    An edge is three samples a, b, c in a row with b between a and c. Its encoded ratio is (b - low) / (high - low), of
    the codes. Over many edges the mixing ratio in light is a half on average, so what is left of the encoded ratio at
    each cell (level of the lower side, level of the upper side) shows the curvature of the response there (Eq. 10).

    Parameters
    ----------
    triples : sequence of Triples
        Those at each of `STRIDES`; all channels are counted together.
    """
    sums = np.stack([_sums_by_level(each) for each in triples])  # (5, 2, 64, 64)
    cells = interpolation_weights(EDGE_LEVELS, GRID)
    gathered: Float64Array = cells.T @ sums @ cells
    return gathered


def _sums_by_level(triples: Triples) -> Float64Array:
    """Return the number of edges and the sum of their encoded ratios, less a half, shape (2, 64, 64)."""
    index = np.flatnonzero(triples.are_edges(LEAST_EDGE_HEIGHT))
    low, height, rise = (part.take(index) for part in (triples.low, triples.height, triples.rise))
    cell = ((low >> 2).astype(np.uint16) * EDGE_LEVELS + (low + height >> 2)).astype(np.intp)
    ratio = rise / height.astype(np.float32) - np.float32(0.5)
    counts = np.bincount(cell, minlength=EDGE_LEVELS**2).astype(np.float64)
    sums = np.stack([counts, np.bincount(cell, ratio, minlength=EDGE_LEVELS**2)])
    return sums.reshape(2, EDGE_LEVELS, EDGE_LEVELS)
