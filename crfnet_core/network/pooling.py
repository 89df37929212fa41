"""From the windows' predictions to one answer, as the CRF-net paper makes it: outliers removed, then a mean.

Only a network without learned pooling is pooled this way. `inliers` runs for every network, because the report says
how many windows agree.
"""

from __future__ import annotations

import numpy as np

from crfnet_core.network.inference import Answer, Predictions
from crfnet_core.types import BoolArray, Float64Array

#: A window is an outlier when its prediction lies farther than this many median distances from the median prediction.
OUTLIER_FACTOR = 2.0


def inliers(weights: Float64Array) -> BoolArray:
    """Return which windows agree with the others, shape (N,), from weights of shape (N, 11): Eq. 19 of docs/METHOD.md.

    The distance of each prediction from the component-wise median is an E_est between two responses, since the basis
    is orthonormal. Those up to `OUTLIER_FACTOR` times the median distance stay: always at least half of them.
    """
    distances = np.linalg.norm(weights - np.median(weights, axis=0), axis=1)
    return np.asarray(distances <= OUTLIER_FACTOR * np.median(distances))


def robust_mean(predictions: Predictions, kept: BoolArray) -> Answer:
    """Return the mean over the windows kept, shape (N,), of their weights (N, 11) and of the errors expected (N,)."""
    return Answer(predictions.weights[kept].mean(axis=0), float(predictions.expected_errors[kept].mean()))


def spread(weights: Float64Array) -> float:
    """Return the RMS distance of weights, shape (N, 11), from their mean: how far windows differ, in units of E_est."""
    return float(np.sqrt(np.mean(np.sum((weights - weights.mean(axis=0)) ** 2, axis=1))))
