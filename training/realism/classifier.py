"""A classifier between two sets of photographs: how well it does says how different they are."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import rankdata

from crfnet_core.types import Float64Array, IndexArray

#: Folds of the cross-validation, principal components that the classifier sees, and the weight of the squared norm of
#: its coefficients.
FOLDS, COMPONENTS, RIDGE = 5, 20, 3.0

#: Standardised features are clipped to this.
LIMIT = 5.0

#: Redrawings of scenes and of bodies that the interval is from, and its ends in percent.
REDRAWINGS, INTERVAL = 1000, (5, 95)


@dataclass(frozen=True)
class Separation:
    """How well two sets are told apart.

    Parameters
    ----------
    auc : float
        Area under the ROC curve: the probability that of two photographs, one of each set, the classifier takes the
        right one for the real one; 0.5 is a guess.
    interval : tuple of float
        Its 90 % interval over scenes and bodies.
    """

    auc: float
    interval: tuple[float, float]

    def __str__(self) -> str:
        low, high = self.interval
        return f"{self.auc:.2f} ({low:.2f} to {high:.2f})"


def separation(
    first: Float64Array, second: Float64Array, first_groups: IndexArray, second_groups: IndexArray, *, seed: int = 0
) -> Separation:
    """Return how well a classifier tells two sets apart that has seen other groups of both.

    Parameters
    ----------
    first, second : ndarray, shape (N, F) and (M, F)
        Features.
    first_groups, second_groups : ndarray of int, shape (N,) and (M,)
        The scene or the body of each.
    seed : int
        Of the folds and of the interval.
    """
    rng = np.random.default_rng(seed)
    folds = [_folds(groups, rng) for groups in (first_groups, second_groups)]
    scores = np.empty(len(first)), np.empty(len(second))
    for fold in range(FOLDS):
        judged = [part == fold for part in folds]
        classifier = _Classifier.fitted(first[~judged[0]], second[~judged[1]])
        for values, part, into in zip((first, second), judged, scores, strict=True):
            into[part] = classifier.scores(values[part])
    wins = (scores[1][None] > scores[0][:, None]) + 0.5 * (scores[1][None] == scores[0][:, None])
    redrawn = []
    for _ in range(REDRAWINGS):
        rows, columns = (_redrawn(groups, rng) for groups in (first_groups, second_groups))
        redrawn.append(rows @ wins @ columns / (rows.sum() * columns.sum()))
    low, high = np.percentile(redrawn, INTERVAL)
    return Separation(float(wins.mean()), (float(low), float(high)))


def single_aucs(first: Float64Array, second: Float64Array) -> Float64Array:
    """Return the area under the ROC curve of every feature alone, shape (F,): 0.5 separates nothing."""
    ranks = rankdata(np.concatenate([first, second]), axis=0)[len(first) :]
    wins = ranks.sum(axis=0) - len(second) * (len(second) + 1) / 2
    areas: Float64Array = wins / (len(first) * len(second))
    return areas


def _folds(groups: IndexArray, rng: np.random.Generator) -> IndexArray:
    """Return the fold of each photograph: groups shared out at random."""
    names, index = np.unique(groups, return_inverse=True)
    folds: IndexArray = (rng.permutation(len(names)) % FOLDS)[index]
    return folds


def _redrawn(groups: IndexArray, rng: np.random.Generator) -> Float64Array:
    """Return how often each photograph is in a drawing of groups with replacement."""
    names, index = np.unique(groups, return_inverse=True)
    counts = np.bincount(rng.integers(len(names), size=len(names)), minlength=len(names))
    return counts[index].astype(np.float64)


@dataclass(frozen=True)
class _Classifier:
    """Logistic regression on principal components of standardised features, both sets weighing the same."""

    mean: Float64Array
    scale: Float64Array
    axes: Float64Array
    coefficients: Float64Array

    @classmethod
    def fitted(cls, first: Float64Array, second: Float64Array) -> _Classifier:
        """Return the classifier of two sets, (N, F) and (M, F)."""
        values = np.concatenate([first, second])
        weights = np.repeat([0.5 / len(first), 0.5 / len(second)], [len(first), len(second)])
        mean = weights @ values
        scale = np.sqrt(weights @ (values - mean) ** 2) + 1e-6
        standard = np.clip((values - mean) / scale, -LIMIT, LIMIT)
        centered = standard - weights @ standard
        axes = _principal_axes(centered * np.sqrt(weights)[:, None])
        spread = np.sqrt(weights @ (centered @ axes) ** 2) + 1e-9
        unfitted = cls(mean, scale, axes / spread, np.zeros(0))
        labels = np.repeat([0.0, 1.0], [len(first), len(second)])
        return replace(unfitted, coefficients=_logistic(unfitted._inputs(values), labels, weights * len(values)))

    def scores(self, values: Float64Array) -> Float64Array:
        """Return the log-odds that photographs are of the second set, shape (N,)."""
        scores: Float64Array = self._inputs(values) @ self.coefficients
        return scores

    def _inputs(self, values: Float64Array) -> Float64Array:
        """Return principal components of unit variance and a column of ones, shape (N, COMPONENTS + 1)."""
        standard = np.clip((values - self.mean) / self.scale, -LIMIT, LIMIT)
        return np.column_stack([standard @ self.axes, np.ones(len(values))])


def _principal_axes(centered: Float64Array) -> Float64Array:
    """Return the first principal axes, shape (F, COMPONENTS), of photographs (N, F), where N is much below F."""
    values, vectors = np.linalg.eigh(centered @ centered.T)
    first = np.argsort(values)[::-1][: min(COMPONENTS, len(centered) - 1)]
    axes: Float64Array = centered.T @ vectors[:, first] / np.sqrt(np.maximum(values[first], 1e-12))
    return axes


def _logistic(inputs: Float64Array, labels: Float64Array, weights: Float64Array) -> Float64Array:
    """Return the coefficients of a ridge logistic regression, by Newton's method; the last is the constant."""
    coefficients = np.zeros(inputs.shape[1])
    penalty = np.diag(np.append(np.full(inputs.shape[1] - 1, RIDGE), 1e-6))
    for _ in range(15):
        probability = 1 / (1 + np.exp(-np.clip(inputs @ coefficients, -30, 30)))
        gradient = inputs.T @ (weights * (probability - labels)) + penalty @ coefficients
        hessian = (inputs * (weights * probability * (1 - probability))[:, None]).T @ inputs + penalty
        coefficients = coefficients - np.linalg.solve(hessian, gradient)
    return coefficients
