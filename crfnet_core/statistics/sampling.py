"""Samples in a row: the neighbors, edges and mixtures that the statistics are counted on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from crfnet_core.types import BoolArray, Float32Array, IndexArray, Int16Array, Uint8Array

CODES = 256  # code values that samples are counted on
CHANNEL_PAIRS = ((0, 1), (1, 2), (0, 2))  # the pairs of channels that are compared with each other
LEAST_HEIGHT = 12  # least difference between the sides of a mixture: below it rounding decides the mixing ratio

#: An edge is isolated if the samples before a and behind c differ from them by at most 1/2 of its height (first class),
#: or by at most 1/5 (second class): there a and c show the two surfaces themselves.
ISOLATION = (2, 5)

#: Samples in a row: arrays of one shape, the i-th of each being a stride apart from the i-th of the next.
Row = tuple[Uint8Array, ...]


class Triples(NamedTuple):
    """Three samples a, b, c in a row, and the codes that show whether they are an edge, each uint8 (3, M)."""

    a: Uint8Array
    b: Uint8Array
    c: Uint8Array
    low: Uint8Array  # the lower one of a and c
    height: Uint8Array  # from low to the other side
    rise: Uint8Array  # from low to b; modulo 256, and so more than any height, for b below low

    @classmethod
    def among(cls, row: Row) -> Triples:
        """Return the triples of three samples in a row, each uint8 (3, M)."""
        a, b, c = row
        low = np.minimum(a, c)
        return cls(a, b, c, low, np.maximum(a, c) - low, b - low)

    def are_edges(self, least_height: int) -> BoolArray:
        """Return which triples are edges higher than this, in codes: b lies between a and c."""
        return np.asarray((self.rise <= self.height) & (self.height > least_height))

    def of_channel(self, channel: int, index: IndexArray) -> tuple[Float32Array, Float32Array, Float32Array]:
        """Return a, b and c of one channel at some indices, each (len(index),)."""
        a, b, c = (side[channel].take(index).astype(np.float32) for side in self[:3])
        return a, b, c


@dataclass(frozen=True)
class Mixtures:
    """Samples a, b, c in a row, codes as int16 (3, M): b may be a mixture of a and c in two channels or more."""

    a: Int16Array  # the samples
    b: Int16Array
    c: Int16Array
    is_mixture: BoolArray  # (3, M): whether a and c differ enough, and b lies between them
    #: Shape (len(ISOLATION), 3, M): whether the samples before a and behind c hardly differ from these, where
    #: `is_mixture`.
    is_isolated: BoolArray

    @classmethod
    def among(cls, row: Row) -> Mixtures:
        """Return the mixtures among five samples in a row, each uint8 (3, M)."""
        is_edge = Triples.among(row[1:4]).are_edges(LEAST_HEIGHT)
        index = np.flatnonzero(is_edge.sum(axis=0, dtype=np.uint8) > 1)
        before, a, b, c, behind = (side.take(index, axis=1).astype(np.int16) for side in row)
        change, height = np.maximum(np.abs(a - before), np.abs(c - behind)), np.abs(c - a)
        is_isolated = np.stack([part * change <= height for part in ISOLATION])
        return cls(a, b, c, is_edge.take(index, axis=1), is_isolated)

    def of_channels(self, pair: tuple[int, int], index: IndexArray) -> tuple[Int16Array, Int16Array, Int16Array]:
        """Return a, b and c of two channels at some indices, each (2, len(index))."""
        positions = index + np.array(pair)[:, None] * self.a.shape[1]
        return self.a.take(positions), self.b.take(positions), self.c.take(positions)


class Samples:
    """The codes of a window, uint8 planes (3, N, N), and the triples and mixtures in them, which several cues share.

    Only every second row and every second column is looked at: adjacent ones are nearly the same.
    """

    def __init__(self, planes: Uint8Array) -> None:
        self.planes = planes
        self._triples: dict[int, Triples] = {}
        self._mixtures: dict[int, Mixtures] = {}

    @classmethod
    def from_window(cls, window: Float32Array) -> Samples:
        """Return the samples of a window of code values in [0, 1], shape (N, N, 3)."""
        codes = np.rint(window * np.float32(CODES - 1)).astype(np.uint8)
        return cls(np.ascontiguousarray(codes.transpose(2, 0, 1)))

    @cached_property
    def halved(self) -> Samples:
        """The rounded means of 2 x 2 samples, planes of shape (3, 113, 113) for planes of shape (3, 227, 227).

        JPEG and video keep color at half the resolution: there the channels of neighboring samples are not independent.
        """
        rows = self.planes[:, :-1:2].astype(np.uint16) + self.planes[:, 1::2]
        return Samples(((rows[:, :, :-1:2] + rows[:, :, 1::2] + 2) >> 2).astype(np.uint8))

    def in_a_row(self, stride: int, count: int) -> Row:
        """Return `count` samples in a row, `stride` apart, of rows and then of columns (fewer if far apart), (3, M)."""
        rows, columns = self._lines
        size, skip = rows.shape[2] - (count - 1) * stride, max(1, stride // 8)
        places = [np.s_[start : start + size] for start in range(0, count * stride, stride)]
        parts = [(rows[:, ::skip, place], columns[:, place, ::skip]) for place in places]
        return tuple(np.concatenate([part.reshape(3, -1) for part in pair], axis=1) for pair in parts)

    def triples(self, stride: int) -> Triples:
        """Return three samples in a row everywhere, `stride` apart."""
        if stride not in self._triples:
            self._triples[stride] = Triples.among(self.in_a_row(stride, 3))
        return self._triples[stride]

    def mixtures(self, stride: int) -> Mixtures:
        """Return the possible mixtures among samples that are `stride` apart."""
        if stride not in self._mixtures:
            self._mixtures[stride] = Mixtures.among(self.in_a_row(stride, 5))
        return self._mixtures[stride]

    @cached_property
    def _lines(self) -> tuple[Uint8Array, Uint8Array]:
        """Every second row, (3, lines, N), and every second column, (3, N, lines)."""
        return np.ascontiguousarray(self.planes[:, ::2]), np.ascontiguousarray(self.planes[:, :, ::2])


def evenly_spread(mask: BoolArray, most: int) -> IndexArray:
    """Return the indices at which `mask`, shape (M,), is set: all of them, or about `most`, evenly spread."""
    index = np.flatnonzero(mask)
    return index[:: max(1, -(-len(index) // most))]


@cache
def interpolation_weights(codes: int, levels: int) -> Float32Array:
    """Return the weights of `codes` values in `levels` uniform levels by interpolation, (codes, levels): q of Eq. 8."""
    position = np.linspace(0, levels - 1, codes)[:, None]
    return np.asarray(np.maximum(1 - np.abs(position - np.arange(levels)), 0), np.float32)
