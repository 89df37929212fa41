"""The levels of a picture: its darkest, its middle and its brightest samples; limited range, and few levels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.types import Float32Array, Float64Array, Pixels

#: Fractions of the samples below which black, the middle and white lie: Eq. L.1 of docs/METHOD.md. What lies
#: below black is dead pixels, and what lies above white is reflections.
BLACK, MIDDLE, WHITE = 1e-5, 0.5, 0.999

LUMA = np.array([0.299, 0.587, 0.114], np.float32)  # of R, G, B, as in JPEG and most video (ITU-R BT.601)

#: Bins of the histograms: the codes of 10 bits. Rows and columns are skipped until at most so many samples remain;
#: nothing is averaged. Rows of samples counted at a time.
BINS, MOST_SAMPLES, ROWS = 1024, 3_000_000, 64

#: Codes of 8 bits beyond black of limited range (16, ITU-R BT.709, item 6), near it and next to it; the same of white.
BLACK_BANDS, WHITE_BANDS = ((0, 12.5), (13, 19), (19.5, 26.5)), ((238.5, 255), (232, 238), (224.5, 231.5))

#: The largest fraction of samples beyond either, and the least fraction near it.
MOST_OUTSIDE, LEAST_AT_END = 0.002, 1e-4

#: The least fraction of luma near either, of which a part as large as this may lie beyond, by ringing of compression.
LEAST_LUMA, MOST_RINGING = 3e-5, 1 / 3

#: The largest fractions of samples below the codes of black and above the codes of white: channels of saturated colors
#: go beyond their luma, of bright ones more than of dark ones.
MOST_BELOW, MOST_ABOVE = 0.01, 0.02

#: Bins in which a photograph's histogram is smooth, the least range of pictures to ask, and the unevenness of
#: pictures of few levels: 104 real photographs have at most 0.13, and up to 0.26 after edits in 8 bits.
SMOOTH_BINS, LEAST_RANGE, FEW_LEVELS = (32, 64), 0.4, 0.3

#: Levels of green at which the other channels of a gray or toned picture stay the same, and by how much they may differ
#: in `TONED` of the samples, by noise, compression or a few colored marks: in 104 real photographs and 47 crops of some
#: they differ by 4.3 codes of 8 bits and more.
GREEN_LEVELS, MOST_CHROMA, TONED = 64, 3 / 255, 0.9

MOST_AT_ENDS = 0.5  # of samples that are black or white, where no camera is named; 104 photographs have at most 0.29


@dataclass(frozen=True, eq=False)
class Levels:
    """The numbers of samples of all channels together, and of luma, at each code of 10 bits: float64, shape (1024,)."""

    histogram: Float64Array
    luma: Float64Array

    @classmethod
    def from_pixels(cls, pixels: Pixels) -> Levels:
        """Return the levels of a picture, float32 (H, W, 3) in [0, 1]; of a large one, only every n-th pixel counts."""
        step = max(1, math.ceil(math.sqrt(math.prod(pixels.shape) / MOST_SAMPLES)))
        counts, luma, rows = np.zeros(BINS), np.zeros(BINS), ROWS * step
        for top in range(0, pixels.shape[0], rows):
            samples = pixels[top : top + rows : step, ::step]
            counts += _histogram(samples)
            luma += _histogram(samples @ LUMA)
        return cls(counts, luma)

    @classmethod
    def joint(cls, levels: Sequence[Levels]) -> Levels:
        """Return the levels of several pictures of one camera together; each counts the same."""
        return cls(
            np.sum([each.histogram / each.histogram.sum() for each in levels], axis=0),
            np.sum([each.luma / each.luma.sum() for each in levels], axis=0),
        )

    @property
    def luma_ends(self) -> tuple[float, float]:
        """The brightness between which nearly all luma lies."""
        return quantile(self.luma, BLACK), quantile(self.luma, 1 - BLACK)

    @property
    def black(self) -> float:
        """The brightness of the darkest samples."""
        return quantile(self.histogram, BLACK)

    @property
    def middle(self) -> float:
        """The median brightness."""
        return quantile(self.histogram, MIDDLE)

    @property
    def white(self) -> float:
        """The brightness of the brightest samples."""
        return quantile(self.histogram, WHITE)


def has_few_levels(levels: Levels) -> bool:
    """Return whether the samples of a picture of some range pile up at a few levels: Eq. L.5 of docs/METHOD.md."""
    is_wide = levels.white - levels.black >= LEAST_RANGE
    return is_wide and any(_unevenness(levels.histogram, bins) > FEW_LEVELS for bins in SMOOTH_BINS)


def is_mostly_ends(levels: Levels) -> bool:
    """Return whether most samples are exactly black or white, as in mattes and passes of renders."""
    return float(levels.histogram[[0, -1]].sum()) > MOST_AT_ENDS * float(levels.histogram.sum())


def is_monochrome(samples: Float32Array) -> bool:
    """Return whether red and blue are functions of green in pixels (N, H, W, 3): the picture is gray or toned."""
    red, green, blue = np.moveaxis(samples[:, ::4, ::4], -1, 0).reshape(3, -1)
    level = np.rint(green * (GREEN_LEVELS - 1)).astype(np.intp)
    for chroma in (red - green, blue - green):
        means = np.bincount(level, chroma) / np.maximum(np.bincount(level), 1)
        if np.quantile(np.abs(chroma - means[level]), TONED) > MOST_CHROMA:
            return False
    return True


def is_limited_range(levels: Levels) -> bool:
    """Return whether a picture has the histogram of limited range: Eq. L.2; of 104 real photographs none has."""
    samples, luma = levels.histogram / levels.histogram.sum(), levels.luma / levels.luma.sum()
    bars = luma * (np.arange(BINS) == 0)  # of pure black, which may have been added later
    samples, luma = map(_ends, (samples - bars, luma - bars))
    # hardly a sample lies outside the codes 16 to 235, and they reach both and pile up at one
    is_reached = all(near >= LEAST_AT_END and beyond <= min(near, MOST_OUTSIDE) for beyond, near, _ in samples)
    if is_reached and any(near > inside for _, near, inside in samples):
        return True
    # hardly any luma lies beyond 16 and 235: JPEG compression blurs piles, and least of all in luma
    is_reached = all(near >= LEAST_LUMA and beyond <= MOST_RINGING * near for beyond, near, _ in luma)
    return is_reached and samples[0][0] <= MOST_BELOW and samples[1][0] <= MOST_ABOVE


def _unevenness(histogram: Float64Array, bins: int) -> float:
    """Return how far, in their mean, the roots of bins are from the mean of their neighbors; infinity for two levels.

    The ends, where photographs clip, are left out, and the two highest bins count as the third: plain backgrounds.
    """
    roots = np.sqrt(histogram.reshape(bins, -1).sum(axis=1))[1:-1]
    roots = np.minimum(roots, np.sort(roots)[-3])
    steps = np.abs(roots[1:-1] - (roots[:-2] + roots[2:]) / 2)
    return float(steps.sum() / roots.sum()) if roots.any() else math.inf


def _ends(histogram: Float64Array) -> list[list[float]]:
    """Return the parts of a histogram in each of `BLACK_BANDS` and of `WHITE_BANDS`, whose ends are included."""
    edges = np.rint(np.array((BLACK_BANDS, WHITE_BANDS)) / 255 * (BINS - 1)).astype(int)
    return [[float(histogram[low : high + 1].sum()) for low, high in bands] for bands in edges]


def _histogram(samples: Float32Array) -> Float64Array:
    """Return the number of samples at each code of 10 bits, shape (1024,)."""
    codes = np.rint(samples * np.float32(BINS - 1)).astype(np.uint16)
    return np.bincount(codes.ravel(), minlength=BINS).astype(np.float64)


def quantile(histogram: Float64Array, fraction: float) -> float:
    """Return the brightness in [0, 1] of which at most this fraction of the samples, or of luma, lies below."""
    cumulative = np.cumsum(histogram)
    position = int(np.searchsorted(cumulative, fraction * cumulative[-1], side="right"))
    return min(position, BINS - 1) / (BINS - 1)
