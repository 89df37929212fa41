"""How far from linear light a window would be under each of some candidate responses.

Light adds: the sample b between two others a and c is a mixture of their irradiances, in the same shares in all
channels. Under the true inverse response the share is therefore the same in every channel, and as often below a half
as above. Under a wrong one it is not. Lin, Gu, Yamazaki & Shum, "Radiometric calibration from a single image", CVPR
2004, look for the response that makes it so; here the network reads how well each candidate does. Light also scales:
shading changes all channels by the same factor.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from crfnet_core.emor import COMPONENTS, EmorBasis
from crfnet_core.response import ResponseCurve

#: Weights of the first two components whose combinations are the candidates: what responses of cameras span.
FIRST_WEIGHTS = (-9.0, -5.0, -2.5, -0.5, 1.0, 2.5, 4.0, 6.0)
SECOND_WEIGHTS = (-1.8, -0.6, 0.6, 2.0)

CANDIDATES = len(FIRST_WEIGHTS) * len(SECOND_WEIGHTS)

#: Share of the identity mixed into every candidate, so that no inverse is too steep for 8 bits.
LINEAR_SHARE = 0.02

#: Distances between samples in a row, of mixtures.
MIXING_STRIDES = (1, 2, 4)

#: Distances between blocks in a row, of mixtures of these: means of 2 x 2 samples, since most files keep colour at half
#: the resolution.
BLOCK_STRIDES = (1, 2)

#: Codes between the two sides of a mixture, more than which its share means anything.
LEAST_HEIGHT = 12

#: A mixture is isolated when its surroundings change by less than its height divided by these.
FLATNESS = (2, 5)

#: Kinds of mixtures that are summed up: all, and those that are isolated.
KINDS = 1 + len(FLATNESS)

#: Sums over mixtures at each candidate: see `share_sums`.
SHARE_SUMS = 3

#: Channels that are compared with each other.
CHANNEL_PAIRS = ((0, 1), (1, 2), (0, 2))

#: Mixtures that are summed up, and mixtures or shaded samples that are compared, at most: of a stride and a pair.
MOST_SUMMED, MOST_COMPARED = 350, 500

#: Codes by which the sides of a mixture differ between two channels, more than which the channels are compared; and
#: the part of its height, one in so many, by which b is away from both sides then.
LEAST_DIFFERENCE, INNER = 60, 5

#: Kinds of mixtures that are compared: all, and those isolated by the first of `FLATNESS`.
COMPARED_KINDS = 2

#: Bands of the level of b in which what is compared is kept apart.
BANDS = 4

#: Spread of the difference between the shares of two channels that has other reasons than rounding.
SHARE_SPREAD = 0.07

#: Codes between two samples of the same shaded surface, least and most: little and much shading; and the distances
#: between such samples.
LITTLE, MUCH = (4, 24), (24, 80)
SHADING = ((1, LITTLE), (2, LITTLE), (4, LITTLE), (8, LITTLE), (16, LITTLE), (2, MUCH), (8, MUCH), (16, MUCH))

#: Codes between channels, more than which their shading is compared.
LEAST_CHROMA = 24

#: Codes that are bright and dark enough for the ratio of two of them to mean anything.
DARKEST, BRIGHTEST = 8, 247

#: Share of a logarithmic difference that is no shading.
SHADING_SPREAD = 0.4

Floats = NDArray[np.float32]
Codes = NDArray[np.uint8]
Samples = NDArray[np.int16]


@dataclass(frozen=True)
class CandidateTables:
    """The candidates' inverse responses at every code, each array float32 (256, CANDIDATES).

    Parameters
    ----------
    irradiance : ndarray
        g.
    slope : ndarray
        g', per code.
    log_slope, log_irradiance : ndarray
        Their natural logarithms; that of code 0 is that of code 1.
    """

    irradiance: Floats
    slope: Floats
    log_slope: Floats
    log_irradiance: Floats

    @classmethod
    @cache
    def load(cls) -> CandidateTables:
        """Return the tables, made from the EMoR basis once."""
        weights = np.zeros((CANDIDATES, COMPONENTS))
        weights[:, :2] = [(first, second) for first in FIRST_WEIGHTS for second in SECOND_WEIGHTS]
        curves = [ResponseCurve.from_samples(samples) for samples in EmorBasis.load().reconstruct(weights)]
        uniform = np.linspace(0, 1, len(curves[0].brightness))
        mixed = [(1 - LINEAR_SHARE) * curve.brightness + LINEAR_SHARE * uniform for curve in curves]
        irradiance = np.stack([np.interp(np.linspace(0, 1, 256), curve, uniform) for curve in mixed], axis=1)
        slope = np.gradient(irradiance, axis=0)
        positive = np.maximum(irradiance, irradiance[1])
        return cls(*(table.astype(np.float32) for table in (irradiance, slope, np.log(slope), np.log(positive))))


def shared_edges(line: tuple[Codes, ...], least: int) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return where b lies between a and c, more than `least` codes apart, in two channels or more, and in which.

    Of the three samples in a row a, b and c, each (3, M): the places (N,), and whether each channel is such, (3, N).
    """
    a, b, c = line
    low, high = np.minimum(a, c), np.maximum(a, c)
    is_edge = (high - low > least) & (b >= low) & (b <= high)
    places = np.flatnonzero(is_edge.sum(axis=0, dtype=np.uint8) > 1)
    return places, is_edge.take(places, axis=1)


@dataclass(frozen=True)
class Mixtures:
    """Samples a, b, c in a row, codes as int16 (3, M), of which b may be a mixture of a and c in two channels or more.

    Parameters
    ----------
    a, b, c : ndarray
        The samples.
    is_mixture : ndarray, bool, shape (3, M)
        Whether a and c differ enough, and b lies between them.
    is_isolated : ndarray, bool, shape (len(FLATNESS), 3, M)
        Whether the samples before a and behind c hardly differ from these.
    """

    a: Samples
    b: Samples
    c: Samples
    is_mixture: NDArray[np.bool_]
    is_isolated: NDArray[np.bool_]

    @classmethod
    def among(cls, lines: tuple[Codes, ...]) -> Mixtures:
        """Return the mixtures among five samples in a row, each uint8 (3, M)."""
        places, is_mixture = shared_edges(lines[1:4], LEAST_HEIGHT)
        before, a, b, c, behind = (side.take(places, axis=1).astype(np.int16) for side in lines)
        change, size = np.maximum(np.abs(a - before), np.abs(c - behind)), np.abs(c - a)
        is_isolated = np.stack([flatness * change <= np.maximum(size, flatness) for flatness in FLATNESS])
        return cls(a, b, c, is_mixture, is_isolated)

    def taken(self, channel: int, places: NDArray[np.intp]) -> tuple[Samples, Samples, Samples]:
        """Return a, b and c of one channel at some places."""
        return self.a[channel].take(places), self.b[channel].take(places), self.c[channel].take(places)


def share_sums(mixtures: Mixtures) -> tuple[Floats, Floats]:
    """Return sums over mixtures at each candidate, float32 (KINDS, SHARE_SUMS, CANDIDATES), and their numbers (KINDS,).

    First over all mixtures, then over isolated ones: the logarithm of the density of b under a uniform share, relative
    to its mean over the candidates; the share of the brighter side, less a half; and its square.
    """
    tables = CandidateTables.load()
    sums, numbers = np.zeros((KINDS, SHARE_SUMS, CANDIDATES), np.float32), np.zeros(KINDS, np.float32)
    for first, second in CHANNEL_PAIRS:
        places = _some(mixtures.is_mixture[first] & mixtures.is_mixture[second], MOST_SUMMED)
        isolated = (mixtures.is_isolated[:, first] & mixtures.is_isolated[:, second]).take(places, axis=1)
        kinds = np.concatenate([np.ones((1, len(places))), isolated]).astype(np.float32)
        for channel in (first, second):
            a, b, c = mixtures.taken(channel, places)
            share, height = _shares(a, b, c)
            density = tables.log_slope.take(b, axis=0) - np.log(np.abs(height))
            brighter = np.where((c > a)[:, None], share, 1 - share) - np.float32(0.5)
            sums += np.stack([kinds @ part for part in (density, brighter, brighter**2)], axis=1)
            numbers += kinds.sum(axis=1)
    sums[:, 0] -= sums[:, 0].mean(axis=1, keepdims=True)
    return sums, numbers


def disagreement_sums(mixtures: Mixtures) -> tuple[Floats, Floats]:
    """Return how much channels disagree on shares, float32 (COMPARED_KINDS, BANDS, CANDIDATES), and of how many.

    Each comparison of a pair of channels that differ enough gives from 0 to 1; the sums are relative to their means
    over the candidates. The numbers have the shape (COMPARED_KINDS, BANDS).
    """
    sums = np.zeros((COMPARED_KINDS, BANDS, CANDIDATES), np.float32)
    numbers = np.zeros((COMPARED_KINDS, BANDS), np.float32)
    heights, middles = mixtures.c - mixtures.a, mixtures.a + mixtures.c
    nearer = np.minimum(np.abs(mixtures.b - mixtures.a), np.abs(mixtures.b - mixtures.c))
    is_inner = mixtures.is_mixture & (INNER * nearer > np.abs(heights))
    for first, second in CHANNEL_PAIRS:
        apart = np.abs(middles[first] - middles[second]) + np.abs(heights[first] - heights[second])
        is_telling = is_inner[first] & is_inner[second] & (apart > LEAST_DIFFERENCE)
        is_isolated = mixtures.is_isolated[0, first] & mixtures.is_isolated[0, second]
        for kind, chosen in enumerate((is_telling, is_telling & is_isolated)):
            places = _some(chosen, MOST_COMPARED)
            sides = [mixtures.taken(channel, places) for channel in (first, second)]
            bands = _in_bands((sides[0][1] + sides[1][1]) >> 1)
            sums[kind] += bands @ _disagreement(*sides)
            numbers[kind] += bands.sum(axis=1)
    return sums - sums.mean(axis=2, keepdims=True), numbers


def shading_sums(lines: tuple[Codes, ...], change: tuple[int, int]) -> tuple[Floats, Floats]:
    """Return how much channels disagree on shading at each candidate, float32 (CANDIDATES,), and of how many pairs.

    The sums are relative to their mean over the candidates.

    Parameters
    ----------
    lines : tuple of two ndarrays, uint8, shape (3, M)
        Samples in a row.
    change : tuple of int
        Codes between them, least and most.
    """
    tables = CandidateTables.load()
    a, b = lines
    low, high = np.minimum(a, b), np.maximum(a, b)
    most = (high - low).max(axis=0)
    is_shading = (most >= change[0]) & (most <= change[1])
    is_shading &= (low.min(axis=0) > DARKEST) & (high.max(axis=0) < BRIGHTEST)
    chosen = _some(is_shading & (a.max(axis=0) - a.min(axis=0) > LEAST_CHROMA), MOST_COMPARED)
    ratios, variances = [], []
    for channel in range(3):
        first, second = a[channel].take(chosen), b[channel].take(chosen)
        ratios.append(tables.log_irradiance.take(first, axis=0) - tables.log_irradiance.take(second, axis=0))
        variances.append(
            (tables.slope.take(first, axis=0) / tables.irradiance.take(first, axis=0)) ** 2 / np.float32(6)
        )
    sums = np.zeros(CANDIDATES, np.float32)
    for i, j in CHANNEL_PAIRS:
        squared = (ratios[i] - ratios[j]) ** 2
        other = np.float32(SHADING_SPREAD**2 / 2) * (ratios[i] ** 2 + ratios[j] ** 2)
        sums += (squared / (squared + variances[i] + variances[j] + other + np.float32(1e-6))).sum(axis=0)
    return sums - sums.mean(), np.array([3 * len(chosen)], np.float32)


def _shares(a: Samples, b: Samples, c: Samples) -> tuple[Floats, Floats]:
    """Return the share of c in b, and the height c - a in irradiance, each (M, CANDIDATES)."""
    irradiance = CandidateTables.load().irradiance
    low = irradiance.take(a, axis=0)
    height = irradiance.take(c, axis=0) - low
    return (irradiance.take(b, axis=0) - low) / height, height


def _disagreement(*sides: tuple[Samples, Samples, Samples]) -> Floats:
    """Return how much two channels, each a, b and c, disagree on the share of c in b, from 0 to 1, (M, CANDIDATES)."""
    slope = CandidateTables.load().slope
    shares, heights = zip(*(_shares(*side) for side in sides), strict=True)
    rounding = [(slope.take(b, axis=0) / height) ** 2 for (_, b, _), height in zip(sides, heights, strict=True)]
    squared = (shares[0] - shares[1]) ** 2
    disagreement: Floats = squared / (
        squared + (rounding[0] + rounding[1]) / np.float32(6) + np.float32(SHARE_SPREAD**2)
    )
    return disagreement


def _in_bands(level: Samples) -> Floats:
    """Return whether codes (M,) are in each band of levels, 0 or 1, shape (BANDS, M)."""
    bands: Floats = (level * BANDS // 256 == np.arange(BANDS)[:, None]).astype(np.float32)
    return bands


def _some(chosen: NDArray[np.bool_], most: int) -> NDArray[np.intp]:
    """Return the places that are chosen, or `most` of them, evenly spread."""
    places = np.flatnonzero(chosen)
    return places[:: max(1, -(-len(places) // most))]
