"""The levels of a picture: the brightness of its darkest, its middle and its brightest samples."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.types import Float32Array, Float64Array, Pixels

#: Fractions of the samples below which black, the middle and white lie: Eq. 38 of docs/METHOD.md. What lies
#: below black is dead pixels, and what lies above white is reflections.
BLACK, MIDDLE, WHITE = 1e-5, 0.5, 0.999

#: Luma of red, green and blue, as JPEG and most video encoders compute it (ITU-R BT.601).
LUMA = np.array([0.299, 0.587, 0.114], np.float32)

#: Bins of the histograms: the codes of 10 bits.
BINS = 1024

#: Rows and columns are skipped until at most so many samples remain; nothing is averaged.
MOST_SAMPLES = 3_000_000

#: Rows of samples counted at a time.
ROWS = 64

#: Range of luma below which a picture is flat, such as black frames and gray cards without noise: four codes of 255.
FLAT_RANGE = 4 / 255


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

    def quantile(self, fraction: float) -> float:
        """Return the brightness in [0, 1] of which at most this fraction of the samples lies below."""
        return _quantile(self.histogram, fraction)

    def luma_quantile(self, fraction: float) -> float:
        """Return the luma in [0, 1] of which at most this fraction of the pixels lies below."""
        return _quantile(self.luma, fraction)

    def fraction(self, low: float, high: float) -> float:
        """Return the fraction of the samples from one brightness to another, both included."""
        first, last = round(low * (BINS - 1)), round(high * (BINS - 1))
        return float(self.histogram[max(first, 0) : last + 1].sum() / self.histogram.sum())

    @property
    def is_flat(self) -> bool:
        """Whether luma has no range to speak of, so that no response shows."""
        return self.luma_quantile(1 - BLACK) - self.luma_quantile(BLACK) < FLAT_RANGE

    @property
    def black(self) -> float:
        """The brightness of the darkest samples."""
        return self.quantile(BLACK)

    @property
    def middle(self) -> float:
        """The median brightness."""
        return self.quantile(MIDDLE)

    @property
    def white(self) -> float:
        """The brightness of the brightest samples."""
        return self.quantile(WHITE)


def _histogram(samples: Float32Array) -> Float64Array:
    """Return the number of samples at each code of 10 bits, shape (1024,)."""
    codes = np.rint(samples * np.float32(BINS - 1)).astype(np.uint16)
    return np.bincount(codes.ravel(), minlength=BINS).astype(np.float64)


def _quantile(histogram: Float64Array, fraction: float) -> float:
    """Return the code in [0, 1] of which at most this fraction lies below."""
    cumulative = np.cumsum(histogram)
    position = int(np.searchsorted(cumulative, fraction * cumulative[-1], side="right"))
    return min(position, BINS - 1) / (BINS - 1)
