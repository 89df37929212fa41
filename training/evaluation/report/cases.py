"""Photographs with the figures of several estimators, and confidence intervals of their means."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crfnet_core.types import Float64Array
from training.evaluation.measure.table import Row
from training.evaluation.plan import SEED

#: Resamples, and the fraction of them inside an interval.
RESAMPLES, CONFIDENCE = 1000, 0.95


class Interval(NamedTuple):
    """A figure and the ends of its 95 % confidence interval."""

    value: float
    low: float
    high: float

    @classmethod
    def from_samples(cls, samples: Float64Array) -> Interval:
        """Return the first sample with the interval of the others, or of itself without others."""
        drawn = samples[1:] if len(samples) > 1 else samples
        low, high = np.quantile(drawn, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2])
        return cls(float(samples[0]), float(low), float(high))


@dataclass(frozen=True, eq=False)
class Cases:
    """The rows of several estimators on the same photographs, side by side."""

    rows: dict[str, list[Row]]  # estimator -> its rows on the N photographs, in one order

    @property
    def first(self) -> list[Row]:
        """The rows of the first estimator: for the columns that belong to the photograph."""
        return next(iter(self.rows.values()))

    def __len__(self) -> int:
        return len(self.first)

    @cached_property
    def resampling(self) -> Resampling:
        """The weights of simulated photographs by scene and response, of real ones by body, each body counted once."""
        if self.is_real:
            return Resampling.from_bodies(self.labels("body key"))
        return Resampling.from_labels(self.labels("scene number"), self.labels("curve"))

    @property
    def is_real(self) -> bool:
        """Whether the photographs are real, of known bodies."""
        return "body key" in self.first[0]

    def column(self, name: str, estimator: str) -> Float64Array:
        """Return a figure of an estimator, shape (N,)."""
        return np.array([row[name] for row in self.rows[estimator]], dtype=np.float64)

    def labels(self, name: str) -> NDArray[Any]:
        """Return a column that belongs to the photographs, shape (N,)."""
        return np.array([row[name] for row in self.first])

    def part(self, index: Sequence[int]) -> Cases:
        """Return the photographs at some positions."""
        return Cases({name: [rows[number] for number in index] for name, rows in self.rows.items()})

    def groups(self, column: str) -> dict[Any, list[int]]:
        """Return value of a column -> positions of the photographs with this value, sorted by value."""
        labels = self.labels(column)
        return {value: np.flatnonzero(labels == value).tolist() for value in np.unique(labels).tolist()}

    def joined(self, other: Cases) -> Cases:
        """Return the photographs of both, of the estimators that both have."""
        return Cases({name: rows + other.rows[name] for name, rows in self.rows.items() if name in other.rows})


@dataclass(frozen=True, eq=False)
class Resampling:
    """Weights of N photographs, float64 (1 + R, N): 1 in the first row, random counts, not all 0, in the R others.

    Scenes and responses are drawn with replacement, each on its own; a photograph counts as often as its scene times as
    its response. The same weights serve every estimator, so that differences are paired. Source: Owen, "The pigeonhole
    bootstrap", Annals of Applied Statistics 2007; its intervals are a little too wide.
    """

    weights: Float64Array

    @classmethod
    def from_labels(cls, scenes: NDArray[np.generic], curves: NDArray[np.generic]) -> Resampling:
        """Return the weights of photographs that belong to `scenes` and `curves`, labels of shape (N,)."""
        rng = np.random.default_rng(SEED)
        drawn = _drawn(scenes, rng) * _drawn(curves, rng)
        return cls(np.concatenate([np.ones((1, len(scenes))), drawn[drawn.any(axis=1)]]))

    @classmethod
    def from_bodies(cls, bodies: NDArray[np.generic]) -> Resampling:
        """Return the weights of photographs of `bodies`, labels of shape (N,): every body counts once."""
        _, body, counts = np.unique(bodies, return_inverse=True, return_counts=True)
        return cls(cls.from_labels(body, np.zeros(len(body))).weights * (1 / counts[body]))

    def means(self, values: Float64Array) -> Float64Array:
        """Return the weighted means, shape (1 + R,), of values (N,)."""
        return self.weights @ values / self.weights.sum(axis=1)

    def mean(self, values: Float64Array) -> Interval:
        """Return the mean of values (N,)."""
        return Interval.from_samples(self.means(values))

    def quantile(self, values: Float64Array, fraction: float) -> Interval:
        """Return a quantile of values (N,): the least value with this fraction of the weight up to it."""
        order = np.argsort(values)
        below = np.cumsum(self.weights[:, order], axis=1)  # (1 + R, N)
        reached = below >= fraction * below[:, -1:] - 1e-9
        return Interval.from_samples(values[order][np.argmax(reached, axis=1)])

    def ratio(self, values: Float64Array, others: Float64Array) -> Interval:
        """Return the mean of values (N,) divided by the mean of others (N,)."""
        return Interval.from_samples(self.means(values) / self.means(others))


def _drawn(labels: NDArray[np.generic], rng: np.random.Generator) -> Float64Array:
    """Return how often each of the labels (N,) is drawn with replacement, shape (R, N)."""
    _, level = np.unique(labels, return_inverse=True)
    levels = level.max() + 1
    counts = rng.multinomial(levels, np.full(levels, 1 / levels), size=RESAMPLES)  # (R, levels)
    return counts[:, level].astype(np.float64)
