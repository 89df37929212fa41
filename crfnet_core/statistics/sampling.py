"""Samples in a row: the neighbours, edges and mixtures that the statistics are counted on."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from crfnet_core.types import BoolArray, Float32Array, IndexArray, Uint8Array

#: Code values that samples are counted on.
CODES = 256

#: The pairs of channels that are compared with each other.
CHANNEL_PAIRS = ((0, 1), (1, 2), (0, 2))

#: Samples in a row: arrays of one shape, the i-th of each being a stride apart from the i-th of the next.
Row = tuple[Uint8Array, ...]


def code_planes(window: Float32Array) -> Uint8Array:
    """Return the codes, shape (3, N, N), of a window of code values in [0, 1], shape (N, N, 3)."""
    codes = np.rint(window * np.float32(CODES - 1)).astype(np.uint8)
    return np.ascontiguousarray(codes.transpose(2, 0, 1))


def half_resolution(planes: Uint8Array) -> Uint8Array:
    """Return the rounded means of 2 x 2 samples, shape (3, 113, 113) for planes of shape (3, 227, 227).

    JPEG and video keep colour at half the resolution: there the channels of neighbouring samples are not independent.
    """
    rows = planes[:, :-1:2].astype(np.uint16) + planes[:, 1::2]
    means: Uint8Array = ((rows[:, :, :-1:2] + rows[:, :, 1::2] + 2) >> 2).astype(np.uint8)
    return means


class Lines(NamedTuple):
    """Every second row and every second column of planes of codes: adjacent ones say nearly the same.

    Parameters
    ----------
    rows : ndarray, uint8, shape (3, lines, N)
        The rows.
    columns : ndarray, uint8, shape (3, N, lines)
        The columns.
    """

    rows: Uint8Array
    columns: Uint8Array

    @classmethod
    def from_planes(cls, planes: Uint8Array) -> Lines:
        """Return the lines of planes (3, N, N)."""
        return cls(np.ascontiguousarray(planes[:, ::2]), np.ascontiguousarray(planes[:, :, ::2]))

    def samples_in_a_row(self, stride: int, count: int) -> Row:
        """Return `count` samples in a row, `stride` apart, of all rows and then of all columns, each (3, M).

        At large strides fewer lines are looked at.
        """
        size, skip = self.rows.shape[2] - (count - 1) * stride, max(1, stride // 8)
        return tuple(
            np.concatenate(
                [
                    self.rows[:, ::skip, start : start + size].reshape(3, -1),
                    self.columns[:, start : start + size, ::skip].reshape(3, -1),
                ],
                axis=1,
            )
            for start in range(0, count * stride, stride)
        )


def evenly_spread(mask: BoolArray, most: int) -> IndexArray:
    """Return the indices at which `mask`, shape (M,), is set: all of them, or about `most`, evenly spread."""
    index = np.flatnonzero(mask)
    return index[:: max(1, -(-len(index) // most))]


@cache
def interpolation_weights(codes: int, levels: int) -> Float32Array:
    """Return the weight of each of `codes` values in each of `levels` uniform levels, (codes, levels): q of Eq. 8.

    A value lies between two levels and is split between them by linear interpolation.
    """
    position = np.linspace(0, levels - 1, codes)[:, None]
    weights: Float32Array = np.maximum(1 - np.abs(position - np.arange(levels)), 0).astype(np.float32)
    return weights
