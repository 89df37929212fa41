"""Samples in a row: the neighbours, edges and mixtures that the statistics are counted on."""

from __future__ import annotations

from functools import cache

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


def sampled_lines(planes: Uint8Array) -> Uint8Array:
    """Return every second row and every second column of planes (3, N, N), the channels first, shape (3, 2, N, lines).

    The samples of a line are in the third axis: those in a row of all lines are whole blocks of memory.
    """
    return np.stack([planes[:, ::2].transpose(0, 2, 1), planes[:, :, ::2]], axis=1)


def samples_in_a_row(lines: Uint8Array, stride: int, count: int) -> Row:
    """Return `count` samples in a row, `stride` apart, of `sampled_lines`, each array of shape (3, M).

    At large strides fewer lines are looked at: the same as in `rows_and_columns`, in another order.
    """
    size, skip = lines.shape[2] - (count - 1) * stride, max(1, stride // 8)
    starts = range(0, count * stride, stride)
    return tuple(lines[:, :, start : start + size, ::skip].reshape(len(lines), -1) for start in starts)


def rows_and_columns(planes: Uint8Array, stride: int, count: int) -> tuple[Row, Row]:
    """Return `count` samples in a row, `stride` apart, along the rows and along the columns of planes (..., N, N).

    Each array has the shape (..., M). Adjacent lines say nearly the same, so at most every second one is looked at.
    """
    size, skip = planes.shape[-1] - (count - 1) * stride, max(2, stride // 4)
    starts = [number * stride for number in range(count)]
    rows = tuple(planes[..., ::skip, start : start + size] for start in starts)
    columns = tuple(planes[..., start : start + size, ::skip] for start in starts)
    flat = (*planes.shape[:-2], -1)
    return tuple(side.reshape(flat) for side in rows), tuple(side.reshape(flat) for side in columns)


def both_directions(planes: Uint8Array, stride: int, count: int) -> Row:
    """Return `rows_and_columns` of planes (3, N, N) one behind the other, each array of shape (3, M)."""
    rows, columns = rows_and_columns(planes, stride, count)
    return tuple(np.concatenate(sides, axis=1) for sides in zip(rows, columns, strict=True))


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
