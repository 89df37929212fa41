"""Shading: light that falls on the same surface more or less changes all channels by the same factor.

Under the true inverse response the logarithm of the ratio of two such samples is therefore equal in R, G and B (Eq. 6
of docs/METHOD.md). How far it is from equal is summed for each of the candidate responses.
"""

from __future__ import annotations

import numpy as np

from crfnet_core.statistics.candidates import CANDIDATE_COUNT, candidate_responses
from crfnet_core.statistics.sampling import CHANNEL_PAIRS, Row, both_directions, evenly_spread
from crfnet_core.types import BoolArray, Float32Array, IndexArray, Uint8Array

#: Ranges in codes of the difference between two samples: weak shading, and strong.
LITTLE, MUCH = (4, 24), (24, 80)

#: The strides, and the ranges of the difference, at which shading is looked for.
SHADING = ((1, LITTLE), (2, LITTLE), (4, LITTLE), (8, LITTLE), (16, LITTLE), (2, MUCH), (8, MUCH), (16, MUCH))

#: Least difference in codes between the channels of a sample: in gray, shading says nothing.
LEAST_CHROMA = 24

#: Samples outside these codes are skipped: black level and clipping distort their ratios.
DARKEST, BRIGHTEST = 8, 247

#: Standard deviation, as a fraction of the logarithmic ratio, of differences between channels that have other causes
#: than shading.
OTHER_CHANGE = 0.4

#: The most shaded pairs that are compared at each stride.
MOST_COMPARED = 500

SHAPES = {"shading": (len(SHADING), CANDIDATE_COUNT), "shading_counts": (len(SHADING), 1)}


def shading_parts(planes: Uint8Array) -> dict[str, Float32Array]:
    """Return how much the channels of planes (3, N, N) disagree on shading, and of how many pairs: see `SHAPES`."""
    rows = {stride: both_directions(planes, stride, 2) for stride in dict(SHADING)}
    sums, counts = zip(*(shading_sums(rows[stride], change) for stride, change in SHADING), strict=True)
    return {"shading": np.stack(sums), "shading_counts": np.stack(counts)}


def shading_sums(row: Row, change: tuple[int, int]) -> tuple[Float32Array, Float32Array]:
    """Return how much the channels disagree on shading at each candidate, (CANDIDATE_COUNT,), and of how many pairs.

    The disagreement of a pair of channels is the Geman-McClure penalty d^2 / (d^2 + r) of the difference d of their
    logarithmic ratios, in which r is the variance that rounding and other causes explain (Eq. 14). The sums are
    relative to their mean over the candidates.

    Parameters
    ----------
    row : tuple of two ndarrays, uint8, shape (3, M)
        Two samples in a row, of all channels.
    change : tuple of int
        Codes between the samples, least and most.
    """
    responses = candidate_responses()
    index = _shaded(row, change)
    ratios, variances = [], []
    for a, b in zip(*row, strict=True):  # of one channel, (M,)
        first, second = a.take(index), b.take(index)
        ratios.append(responses.log_irradiance.take(first, axis=0) - responses.log_irradiance.take(second, axis=0))
        relative_slope = responses.slope.take(first, axis=0) / responses.irradiance.take(first, axis=0)
        variances.append(relative_slope**2 / np.float32(6))  # two roundings of variance 1 / 12
    sums = np.zeros(CANDIDATE_COUNT, np.float32)
    for i, j in CHANNEL_PAIRS:
        squared = (ratios[i] - ratios[j]) ** 2  # (len(index), CANDIDATE_COUNT)
        other = np.float32(OTHER_CHANGE**2 / 2) * (ratios[i] ** 2 + ratios[j] ** 2)
        sums += (squared / (squared + variances[i] + variances[j] + other + np.float32(1e-6))).sum(axis=0)
    return sums - sums.mean(), np.array([len(CHANNEL_PAIRS) * len(index)], np.float32)


def _shaded(row: Row, change: tuple[int, int]) -> IndexArray:
    """Return the indices of coloured samples, neither black nor clipped, that differ by as much as shading does."""
    a, b = row
    low, high = np.minimum(a, b), np.maximum(a, b)
    most = (high - low).max(axis=0)
    is_shading: BoolArray = (most >= change[0]) & (most <= change[1])
    is_shading &= (low.min(axis=0) > DARKEST) & (high.max(axis=0) < BRIGHTEST)
    is_colored = a.max(axis=0) - a.min(axis=0) > LEAST_CHROMA
    return evenly_spread(is_shading & is_colored, MOST_COMPARED)
