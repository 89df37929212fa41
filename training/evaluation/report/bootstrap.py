"""Confidence intervals by resampling scenes and responses together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crfnet_core.types import Float64Array

#: Resamples, and the fraction of them inside an interval.
RESAMPLES, CONFIDENCE = 1000, 0.95


class Interval(NamedTuple):
    """A figure and the ends of its 95 % confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Resampling:
    """Weights of N photographs, float64 (1 + R, N): 1 in the first row, random counts, not all 0, in the R others.

    Scenes and responses are both samples and drawn with replacement, each on its own; a photograph counts as often as
    its scene times as its response. The same weights serve every estimator, so that differences are paired.

    Source: Owen, "The pigeonhole bootstrap", Annals of Applied Statistics 2007; its intervals are a little too wide.
    """

    weights: Float64Array

    @classmethod
    def of_labels(cls, scenes: NDArray[np.generic], curves: NDArray[np.generic], *, seed: int) -> Resampling:
        """Return the weights of photographs that belong to `scenes` and `curves`, labels of shape (N,)."""
        rng = np.random.default_rng(seed)
        parts = []
        for labels in (scenes, curves):
            _, level = np.unique(labels, return_inverse=True)
            levels = level.max() + 1
            counts = rng.multinomial(levels, np.full(levels, 1 / levels), size=RESAMPLES)  # (R, levels)
            parts.append(counts[:, level].astype(np.float64))
        drawn = parts[0] * parts[1]
        return cls(np.concatenate([np.ones((1, len(scenes))), drawn[drawn.any(axis=1)]]))

    @classmethod
    def of_bodies(cls, bodies: NDArray[np.generic], *, seed: int) -> Resampling:
        """Return the weights of photographs of `bodies`, labels of shape (N,): every body counts once."""
        _, body = np.unique(bodies, return_inverse=True)
        resampling = cls.of_labels(body, np.zeros(len(body), dtype=int), seed=seed)
        return cls(resampling.weights * (1 / np.bincount(body)[body]))

    def subset(self, chosen: Sequence[int]) -> Resampling:
        """Return the weights of some photographs, by their positions."""
        weights = self.weights[:, chosen]
        return Resampling(weights[weights.any(axis=1)])

    def means(self, values: Float64Array) -> Float64Array:
        """Return the weighted means, shape (1 + R,), of values (N,)."""
        return self.weights @ values / self.weights.sum(axis=1)

    def mean(self, values: Float64Array) -> Interval:
        """Return the mean of values (N,)."""
        return interval(self.means(values))

    def quantile(self, values: Float64Array, fraction: float) -> Interval:
        """Return a quantile of values (N,): the least value with this fraction of the weight up to it."""
        order = np.argsort(values)
        below = np.cumsum(self.weights[:, order], axis=1)  # (1 + R, N)
        reached = below >= fraction * below[:, -1:] - 1e-9
        return interval(values[order][np.argmax(reached, axis=1)])

    def ratio(self, values: Float64Array, others: Float64Array) -> Interval:
        """Return the mean of values (N,) divided by the mean of others (N,)."""
        return interval(self.means(values) / self.means(others))


def interval(samples: Float64Array) -> Interval:
    """Return the first sample with the interval of the others; without others the interval is that sample itself."""
    drawn = samples[1:] if len(samples) > 1 else samples
    low, high = np.quantile(drawn, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return Interval(float(samples[0]), float(low), float(high))
