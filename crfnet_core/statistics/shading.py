"""Shading: light that falls on the same surface more or less changes all channels by the same factor.

Under the true inverse response the logarithm of the ratio of two such samples is therefore equal in R, G and B (Eq. 6
of docs/METHOD.md). How far it is from equal is summed for each of the candidate responses.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from crfnet_core.statistics.candidates import CANDIDATE_COUNT, candidate_responses
from crfnet_core.statistics.sampling import CHANNEL_PAIRS, Row, Samples, evenly_spread
from crfnet_core.types import Float32Array, Uint8Array

#: Ranges in codes of the difference between two samples, weak shading and strong; and the strides and the ranges at
#: which shading is looked for.
LITTLE, MUCH = (4, 24), (24, 80)
SHADING = ((1, LITTLE), (2, LITTLE), (4, LITTLE), (8, LITTLE), (16, LITTLE), (2, MUCH), (8, MUCH), (16, MUCH))

LEAST_CHROMA = 24  # the first sample's channels differ by more codes: gray shows nothing of shading
DARKEST, BRIGHTEST = 8, 247  # samples here and beyond are skipped: black level and clipping distort their ratios
MOST_COMPARED = 500  # the most shaded pairs that are compared at each stride

#: Standard deviation, as a fraction of the logarithmic ratio, of differences between channels that have other causes
#: than shading.
OTHER_CHANGE = 0.4

SHADING_SHAPE = (len(SHADING), CANDIDATE_COUNT)


def shading(samples: Samples) -> tuple[Float32Array, Float32Array]:
    """Return `shading_sums` and their numbers of terms at each of `SHADING`."""
    pairs = {stride: Pairs.among(samples.in_a_row(stride, 2)) for stride in dict(SHADING)}
    sums, counts = zip(*(shading_sums(pairs[stride], change) for stride, change in SHADING), strict=True)
    return np.stack(sums), np.stack(counts)


@dataclass(frozen=True)
class Pairs:
    """Two samples of all channels in a row, codes (3, M), and whether shading can be seen in them."""

    first: Uint8Array  # (3, M): the samples
    second: Uint8Array
    #: Shape (M,): the largest difference of a channel, in codes; 0 where the first sample is gray, or either is black
    #: or clipped.
    difference: Uint8Array

    @classmethod
    def among(cls, row: Row) -> Self:
        """Return the pairs of two samples in a row, each uint8 (3, M)."""
        first, second = row
        low, high = np.minimum(first, second), np.maximum(first, second)
        is_seen = (low.min(axis=0) > DARKEST) & (high.max(axis=0) < BRIGHTEST)
        is_seen &= first.max(axis=0) - first.min(axis=0) > LEAST_CHROMA
        return cls(first, second, (high - low).max(axis=0) * is_seen)


def shading_sums(pairs: Pairs, change: tuple[int, int]) -> tuple[Float32Array, Float32Array]:
    """Return how much the channels disagree on shading at each candidate, (CANDIDATE_COUNT,), and of how many pairs.

    The disagreement of a pair of channels is the Geman-McClure penalty d^2 / (d^2 + r) of the difference d of their
    logarithmic ratios, in which r is the variance that rounding and other causes explain (Eq. 14). The sums are
    relative to their mean over the candidates. Only samples that differ by codes in the range `change` are compared.
    """
    responses = candidate_responses()
    is_shading = (pairs.difference >= change[0]) & (pairs.difference <= change[1])
    index = evenly_spread(is_shading, MOST_COMPARED)
    first, second = pairs.first.take(index, axis=1), pairs.second.take(index, axis=1)  # (3, len(index))
    logarithms = responses.log_irradiance
    ratios = logarithms.take(first, axis=0) - logarithms.take(second, axis=0)  # (3, len(index), CANDIDATE_COUNT)
    explained = responses.log_variance.take(first, axis=0) + np.float32(OTHER_CHANGE**2 / 2) * ratios**2
    explained += np.float32(5e-7)
    sums, ones = np.zeros(CANDIDATE_COUNT, np.float32), np.ones(len(index), np.float32)
    for i, j in CHANNEL_PAIRS:
        squared = (ratios[i] - ratios[j]) ** 2  # (len(index), CANDIDATE_COUNT)
        sums += ones @ (squared / (squared + explained[i] + explained[j]))
    return sums - sums.mean(), np.array([len(CHANNEL_PAIRS) * len(index)], np.float32)
