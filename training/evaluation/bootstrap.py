"""Confidence intervals by resampling scenes and curves together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Resamples, and the share of them inside an interval.
RESAMPLES, CONFIDENCE = 1000, 0.95


@dataclass(frozen=True)
class Figure:
    """A figure and its 95 % confidence interval."""

    value: float
    low: float
    high: float

    @property
    def is_zero(self) -> bool:
        """Whether the interval contains 0: a difference is then a tie."""
        return self.low <= 0 <= self.high


@dataclass(frozen=True, eq=False)
class Resampling:
    """How often each of N cases counts: once in the first row, at random in the R others.

    Every case belongs to a scene and to a curve, and both are only samples of what there is: scenes and curves are
    drawn with replacement, each on its own, and a case counts as often as its scene times as its curve. The same
    weights serve every estimator, so that differences are paired.

    Source: Owen, "The pigeonhole bootstrap", Annals of Applied Statistics 2007; its intervals are a little too wide.

    Parameters
    ----------
    weights : ndarray, float64, shape (1 + R, N)
        No row is all 0.
    """

    weights: np.ndarray

    @classmethod
    def of(cls, scenes: np.ndarray, curves: np.ndarray, *, seed: int, resamples: int = RESAMPLES) -> Resampling:
        """Return the weights of cases that belong to `scenes` and `curves`, labels of shape (N,)."""
        rng = np.random.default_rng(seed)
        parts = []
        for labels in (scenes, curves):
            _, places = np.unique(labels, return_inverse=True)
            levels = places.max() + 1
            counts = rng.multinomial(levels, np.full(levels, 1 / levels), size=resamples)
            parts.append(counts[:, places].astype(np.float64))
        drawn = parts[0] * parts[1]
        return cls(np.concatenate([np.ones((1, len(scenes))), drawn[drawn.any(axis=1)]]))

    def subset(self, chosen: np.ndarray) -> Resampling:
        """Return the weights of some cases, from a mask or indices."""
        weights = self.weights[:, chosen]
        return Resampling(weights[weights.any(axis=1)])

    def scaled(self, shares: np.ndarray) -> Resampling:
        """Return weights multiplied by positive shares (N,), as for a mean over groups of different sizes."""
        return Resampling(self.weights * shares)

    def means(self, values: np.ndarray) -> np.ndarray:
        """Return the weighted means, shape (1 + R,), of values (N,)."""
        return self.weights @ values / self.weights.sum(axis=1)

    def quantiles(self, values: np.ndarray, share: float) -> np.ndarray:
        """Return the weighted quantiles, shape (1 + R,): the least value up to which this share of the weight lies."""
        order = np.argsort(values)
        below = np.cumsum(self.weights[:, order], axis=1)
        reached = below >= share * below[:, -1:] - 1e-9
        return values[order][np.argmax(reached, axis=1)]

    def mean(self, values: np.ndarray) -> Figure:
        """Return the mean of values (N,)."""
        return figure(self.means(values))

    def quantile(self, values: np.ndarray, share: float) -> Figure:
        """Return a quantile of values (N,)."""
        return figure(self.quantiles(values, share))

    def ratio(self, values: np.ndarray, others: np.ndarray) -> Figure:
        """Return the mean of values (N,) divided by that of others (N,)."""
        return figure(self.means(values) / self.means(others))

    def difference(self, values: np.ndarray, others: np.ndarray) -> Figure:
        """Return the mean of the paired differences of values (N,) and others (N,)."""
        return figure(self.means(values - others))


def figure(samples: np.ndarray) -> Figure:
    """Return the first sample with the interval of the others; without others the interval is the figure itself."""
    drawn = samples[1:] if len(samples) > 1 else samples
    low, high = np.quantile(drawn, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
    return Figure(float(samples[0]), float(low), float(high))
