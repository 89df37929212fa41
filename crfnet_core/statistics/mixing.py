"""Mixtures: whether the light of b is a mixture of the light of its two sides, under each candidate response.

Light adds. Three samples a, b, c in a row with b between a and c obey g(b) = (1 - alpha) g(a) + alpha g(c) (Eq. 2 of
docs/METHOD.md). Under the true inverse response g the mixing ratio alpha is the same in every channel, and all mixing
ratios are equally likely. Under a wrong one neither holds. The network reads how well each candidate does.
"""

from collections.abc import Iterable

import numpy as np

from crfnet_core.statistics.candidates import CANDIDATE_COUNT, candidate_responses
from crfnet_core.statistics.sampling import CHANNEL_PAIRS, CODES, ISOLATION, Mixtures, Samples, evenly_spread
from crfnet_core.types import Float32Array, Int16Array

MIXING_STRIDES = (1, 2, 4)  # distances between the samples of a mixture
HALF_RESOLUTION_STRIDES = (1, 2)  # the same at half resolution
SUMMED_CLASSES = 1 + len(ISOLATION)  # classes of mixtures that are summed up: all of them, and the two isolated ones
COMPARED_CLASSES = 2  # those that are compared between channels: all of them, and the first isolated one
MIXING_SUMS = 3  # sums per class and candidate: see `mixing_sums`
MOST_SUMMED = 350  # the most mixtures of one stride and one pair of channels in `mixing_sums`
MOST_COMPARED = 500  # the same in `disagreement_sums`

#: Two channels are compared at an edge only if it differs between them: |d(a + c)| + |d(c - a)| above so many codes.
LEAST_DIFFERENCE = 60
INNER = 5  # and b must lie more than 1/5 of the edge's height from both a and c
LEVEL_BANDS = 4  # bands of the level of b in which the disagreement is kept apart: candidates fail at different levels

#: Standard deviation of the difference between two channels' mixing ratios that is expected even under the true
#: response (noise, demosaicing), on top of 8-bit rounding.
RATIO_NOISE = 0.07

_DISAGREEMENT = (COMPARED_CLASSES, LEVEL_BANDS)

MIXING_SHAPE = (len(MIXING_STRIDES), SUMMED_CLASSES, MIXING_SUMS, CANDIDATE_COUNT)
DISAGREEMENT_SHAPE = (len(MIXING_STRIDES), *_DISAGREEMENT, CANDIDATE_COUNT)
HALF_RESOLUTION_SHAPE = (len(HALF_RESOLUTION_STRIDES), *_DISAGREEMENT, CANDIDATE_COUNT)


def mixing(samples: Samples) -> tuple[Float32Array, Float32Array]:
    """Return `mixing_sums` and their numbers of terms at each of `MIXING_STRIDES`."""
    return _stacked(mixing_sums(samples.mixtures(stride)) for stride in MIXING_STRIDES)


def disagreement(samples: Samples) -> tuple[Float32Array, Float32Array]:
    """Return `disagreement_sums` and their numbers of terms at each of `MIXING_STRIDES`."""
    return _stacked(disagreement_sums(samples.mixtures(stride)) for stride in MIXING_STRIDES)


def half_resolution_disagreement(samples: Samples) -> tuple[Float32Array, Float32Array]:
    """Return `disagreement_sums` of `Samples.halved`, and their numbers of terms, at `HALF_RESOLUTION_STRIDES`."""
    return _stacked(disagreement_sums(samples.halved.mixtures(stride)) for stride in HALF_RESOLUTION_STRIDES)


def mixing_sums(mixtures: Mixtures) -> tuple[Float32Array, Float32Array]:
    """Return sums over the mixtures under each candidate, and the number of mixtures in each class.

    The sums (Eq. 13) are (i) the logarithm of the density of b, log g'(b) - log |g(c) - g(a)|, if all mixing ratios are
    equally likely (Eq. 4), relative to its mean over the candidates; (ii) the mixing ratio of the brighter side, less a
    half; (iii) its square. Their shapes are (SUMMED_CLASSES, MIXING_SUMS, CANDIDATE_COUNT) and (SUMMED_CLASSES, 1, 1).
    """
    log_slope = candidate_responses().log_slope
    sums = np.zeros((SUMMED_CLASSES, MIXING_SUMS, CANDIDATE_COUNT), np.float32)
    counts = np.zeros(SUMMED_CLASSES, np.float32)
    for first, second in CHANNEL_PAIRS:
        index = evenly_spread(mixtures.is_mixture[first] & mixtures.is_mixture[second], MOST_SUMMED)
        is_isolated = (mixtures.is_isolated[:, first] & mixtures.is_isolated[:, second]).take(index, axis=1)
        classes = np.concatenate([np.ones((1, len(index))), is_isolated]).astype(np.float32)
        a, b, c = mixtures.of_channels((first, second), index)
        ratio, height = mixing_ratio(a, b, c)  # (2, len(index), CANDIDATE_COUNT)
        log_density = log_slope.take(b, axis=0) - np.log(np.abs(height))
        centered = ratio - np.float32(0.5)
        brighter = centered * np.sign(c - a).astype(np.float32)[..., None]
        sums += np.stack([(classes @ part).sum(axis=0) for part in (log_density, brighter, centered**2)], axis=1)
        counts += 2 * classes.sum(axis=1)
    sums[:, 0] -= sums[:, 0].mean(axis=1, keepdims=True)
    return sums, counts[:, None, None]


def disagreement_sums(mixtures: Mixtures) -> tuple[Float32Array, Float32Array]:
    """Return how much the channels disagree on mixing ratios under each candidate, and of how many comparisons.

    The sums are relative to their means over the candidates. The shapes are (COMPARED_CLASSES, LEVEL_BANDS,
    CANDIDATE_COUNT) and (COMPARED_CLASSES, LEVEL_BANDS, 1).
    """
    sums = np.zeros((*_DISAGREEMENT, CANDIDATE_COUNT), np.float32)
    counts = np.zeros(_DISAGREEMENT, np.float32)
    heights, middles = mixtures.c - mixtures.a, mixtures.a + mixtures.c
    nearer = np.minimum(np.abs(mixtures.b - mixtures.a), np.abs(mixtures.b - mixtures.c))
    is_inner = mixtures.is_mixture & (INNER * nearer > np.abs(heights))
    for first, second in CHANNEL_PAIRS:
        difference = np.abs(middles[first] - middles[second]) + np.abs(heights[first] - heights[second])
        is_compared = is_inner[first] & is_inner[second] & (difference > LEAST_DIFFERENCE)
        is_isolated = mixtures.is_isolated[0, first] & mixtures.is_isolated[0, second]
        for number, is_chosen in enumerate((is_compared, is_compared & is_isolated)):
            index = evenly_spread(is_chosen, MOST_COMPARED)
            a, b, c = mixtures.of_channels((first, second), index)
            level = (b[0] + b[1]) >> 1
            bands = (level * LEVEL_BANDS // CODES == np.arange(LEVEL_BANDS)[:, None]).astype(np.float32)
            sums[number] += bands @ _disagreement(a, b, c)
            counts[number] += bands.sum(axis=1)
    return sums - sums.mean(axis=2, keepdims=True), counts[..., None]


def mixing_ratio(a: Int16Array, b: Int16Array, c: Int16Array) -> tuple[Float32Array, Float32Array]:
    """Return alpha = (g(b) - g(a)) / (g(c) - g(a)) of codes (2, M), and g(c) - g(a), (2, M, CANDIDATE_COUNT): Eq. 2."""
    irradiance = candidate_responses().irradiance
    start = irradiance.take(a, axis=0)
    height = irradiance.take(c, axis=0) - start
    return (irradiance.take(b, axis=0) - start) / height, height


def _disagreement(a: Int16Array, b: Int16Array, c: Int16Array) -> Float32Array:
    """Return how much two channels, codes (2, M), disagree on alpha, from 0 to 1, shape (M, CANDIDATE_COUNT).

    It is the Geman-McClure penalty d^2 / (d^2 + s^2 + r) of the difference d (Eq. 5), with s `RATIO_NOISE` and r the
    variance from rounding: 1 / 6 squared codes in each channel, half of it from b and at most half from a and c.
    """
    ratios, heights = mixing_ratio(a, b, c)
    rounding = (candidate_responses().slope.take(b, axis=0) / heights) ** 2
    squared = (ratios[0] - ratios[1]) ** 2
    variance = (rounding[0] + rounding[1]) / np.float32(6)
    return np.asarray(squared / (squared + variance + np.float32(RATIO_NOISE**2)))


def _stacked(pairs: Iterable[tuple[Float32Array, Float32Array]]) -> tuple[Float32Array, Float32Array]:
    """Return the sums and the counts of several strides, each stacked."""
    sums, counts = zip(*pairs, strict=True)
    return np.stack(sums), np.stack(counts)
