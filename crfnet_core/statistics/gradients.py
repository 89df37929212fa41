"""The histogram, and the differences between neighbors at each level of brightness."""

from functools import cache

import numpy as np

from crfnet_core.statistics.sampling import CODES, Samples, interpolation_weights
from crfnet_core.types import Float32Array, Float64Array

LEVELS = 64  # levels of brightness that counts over codes are gathered into
STRIDES = (1, 2, 4, 8, 16)  # distances between neighbors, in samples
GRADIENT_SUMS = 5  # sums per channel, stride and level: |d|, log(1 + |d|), d == 0, d and 1, for differences d in codes

HISTOGRAM_SHAPE = (3, LEVELS)
GRADIENTS_SHAPE = (len(STRIDES), 3, GRADIENT_SUMS, LEVELS)


def level_histogram(samples: Samples) -> Float64Array:
    """Return the number of samples at each level, shape (3, LEVELS): Eq. 8."""
    counts = np.stack([np.bincount(plane.ravel(), minlength=CODES) for plane in samples.planes])  # (3, 256)
    return np.asarray(np.matmul(counts, interpolation_weights(CODES, LEVELS), dtype=np.float64))


def gradient_sums(samples: Samples) -> Float32Array:
    """Return `GRADIENT_SUMS` over the neighbors of the samples at each level, shape (5, 3, GRADIENT_SUMS, LEVELS).

    Both neighbors count, along the rows and along the columns. Relative gradients of irradiance hardly depend on its
    level, so the mean gradient of brightness, as a function of brightness, follows the slope of f (Eq. 9).
    """
    sums = np.stack([_sums_by_code(samples, stride) for stride in STRIDES])  # (5, 3, GRADIENT_SUMS, 256)
    return np.asarray(sums @ interpolation_weights(CODES, LEVELS))


def _sums_by_code(samples: Samples, stride: int) -> Float32Array:
    """Return the sums over the neighbors of the samples of each code, shape (3, GRADIENT_SUMS, 256)."""
    first, second = samples.in_a_row(stride, 2)
    pairs = (first.astype(np.uint16) << 8) | second
    tables, sums = _difference_tables(), np.empty((3, GRADIENT_SUMS, CODES), np.float32)
    padded = np.empty((CODES, CODES + 16), np.float32)  # columns a power of two apart would share lines of a cache
    counts = padded[:, :CODES]
    for of_channel, into in zip(pairs, sums, strict=True):
        counts[:] = np.bincount(of_channel, minlength=CODES * CODES).reshape(CODES, CODES)
        np.einsum("ij,kij->ki", counts + counts.T, tables, out=into)
    return sums


@cache
def _difference_tables() -> Float32Array:
    """Return the terms of a sample of code i with a neighbor of code j, shape (GRADIENT_SUMS, 256, 256)."""
    code = np.arange(CODES, dtype=np.float32)
    signed = code - code[:, None]
    absolute = np.abs(signed)
    return np.stack([absolute, np.log1p(absolute), signed == 0, signed, np.ones_like(signed)]).astype(np.float32)
