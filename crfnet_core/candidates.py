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

#: Distances between samples in a row, for mixtures and for shading.
MIXING_STRIDES, SHADING_STRIDES = (1, 2, 4), (2, 8)

#: Sums over mixtures at each candidate: see `mixing_sums`.
MIXING_SUMS = 4

#: Channels that are compared with each other.
CHANNEL_PAIRS = ((0, 1), (1, 2), (0, 2))

#: Mixtures of a kind and shading compared per pair of channels and stride, at most.
MOST_COMPARED = 350

#: Codes between the two sides of a mixture, more than which its share means anything.
LEAST_HEIGHT = 12

#: Codes by which the sides of a mixture differ between two channels, more than which the channels are compared; and
#: the part of its height, one in so many, by which b is away from both sides then.
LEAST_DIFFERENCE, INNER = 60, 5

#: A mixture is isolated when its surroundings change by less than its height divided by these.
FLATNESS = (2, 5)

#: Kinds of mixtures that are summed up: all, and those that are isolated.
KINDS = 1 + len(FLATNESS)

#: Spread of the difference between the shares of two channels that has other reasons than rounding.
SHARE_SPREAD = 0.07

#: Codes between two samples of the same shaded surface, least and most; and between channels, for them to differ.
SHADING, LEAST_CHROMA = (4, 24), 24

#: Codes that are bright and dark enough for the ratio of two of them to mean anything.
DARKEST, BRIGHTEST = 8, 247

#: Share of a logarithmic difference that is no shading.
SHADING_SPREAD = 0.4

Floats = NDArray[np.float32]
Codes = NDArray[np.uint8]


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


def mixing_sums(lines: tuple[Codes, ...]) -> tuple[Floats, Floats]:
    """Return sums over mixtures at each candidate, float32 (KINDS, 4, CANDIDATES), and their numbers, (KINDS, 2).

    First over all mixtures, then over isolated ones, for both channels of each pair: the logarithm of the density of b
    under a uniform share; the share of the brighter side, less a half; its square; and over the pairs of channels that
    differ enough how much their shares disagree, from 0 to 1. The first and the last are relative to their means over
    the candidates. The numbers are those of the shares and of the compared pairs.

    Parameters
    ----------
    lines : tuple of five ndarrays, uint8, shape (3, M)
        Samples in a row: what lies before a, then a, b, c, and what lies behind c.
    """
    tables = CandidateTables.load()
    before, a, b, c, behind = (side.astype(np.int16) for side in lines)
    heights, rises, middles = c - a, b - a, a + c
    sizes = np.abs(heights)
    is_mixture = (sizes > LEAST_HEIGHT) & (rises * np.sign(heights) >= 0) & (np.abs(rises) <= sizes)
    is_inner = INNER * np.minimum(np.abs(rises), np.abs(b - c)) > sizes
    change = np.maximum(np.abs(a - before), np.abs(c - behind))
    is_isolated = np.stack([flatness * change <= np.maximum(sizes, flatness) for flatness in FLATNESS])
    sums, numbers = np.zeros((KINDS, MIXING_SUMS, CANDIDATES), np.float32), np.zeros((KINDS, 2), np.float32)
    for first, second in CHANNEL_PAIRS:
        is_shared = is_mixture[first] & is_mixture[second]
        apart = np.abs(middles[first] - middles[second]) + np.abs(heights[first] - heights[second])
        is_telling = is_shared & is_inner[first] & is_inner[second] & (apart > LEAST_DIFFERENCE)
        shared, telling = _some(is_shared), _some(is_telling)
        shared_kinds, telling_kinds = (
            _kinds(is_isolated[:, first].take(places, axis=1) & is_isolated[:, second].take(places, axis=1))
            for places in (shared, telling)
        )
        for channel in (first, second):
            sides = [side[channel].take(shared) for side in (a, b, c)]
            share, height = _shares(*sides)
            density = tables.log_slope.take(sides[1], axis=0) - np.log(np.abs(height))
            brighter = np.where((heights[channel].take(shared) > 0)[:, None], share, 1 - share) - np.float32(0.5)
            sums[:, :3] += np.stack([shared_kinds @ part for part in (density, brighter, brighter**2)], axis=1)
        compared, spread = [], np.full((len(telling), CANDIDATES), SHARE_SPREAD**2, np.float32)
        for channel in (first, second):
            sides = [side[channel].take(telling) for side in (a, b, c)]
            share, height = _shares(*sides)
            compared.append(share)
            spread += (tables.slope.take(sides[1], axis=0) / height) ** 2 / np.float32(6)
        squared = (compared[0] - compared[1]) ** 2
        sums[:, 3] += telling_kinds @ (squared / (squared + spread))
        numbers += np.stack([2 * shared_kinds.sum(axis=1), telling_kinds.sum(axis=1)], axis=1)
    sums[:, [0, 3]] -= sums[:, [0, 3]].mean(axis=2, keepdims=True)
    return sums, numbers


def shading_sums(lines: tuple[Codes, ...]) -> tuple[Floats, Floats]:
    """Return how much channels disagree on shading at each candidate, float32 (CANDIDATES,), and of how many pairs.

    The sums are relative to their mean over the candidates.

    Parameters
    ----------
    lines : tuple of two ndarrays, uint8, shape (3, M)
        Samples in a row.
    """
    tables = CandidateTables.load()
    a, b = (side.astype(np.int16) for side in lines)
    change = np.abs(a - b).max(axis=0)
    darkest, brightest = np.minimum(a, b).min(axis=0), np.maximum(a, b).max(axis=0)
    is_shading = (change >= SHADING[0]) & (change <= SHADING[1]) & (darkest > DARKEST) & (brightest < BRIGHTEST)
    chosen = _some(is_shading & (a.max(axis=0) - a.min(axis=0) > LEAST_CHROMA))
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


def _shares(a: NDArray[np.int16], b: NDArray[np.int16], c: NDArray[np.int16]) -> tuple[Floats, Floats]:
    """Return the share of c in b, and the height c - a in irradiance, each (M, CANDIDATES)."""
    irradiance = CandidateTables.load().irradiance
    low = irradiance.take(a, axis=0)
    height = irradiance.take(c, axis=0) - low
    return (irradiance.take(b, axis=0) - low) / height, height


def _kinds(isolated: NDArray[np.bool_]) -> Floats:
    """Return whether mixtures are of each kind, 0 or 1, shape (KINDS, M), of which are isolated."""
    return np.concatenate([np.ones((1, isolated.shape[1])), isolated]).astype(np.float32)


def _some(chosen: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Return the places that are chosen, or `MOST_COMPARED` at most, evenly spread over them."""
    places = np.flatnonzero(chosen)
    return places[:: max(1, -(-len(places) // MOST_COMPARED))]
