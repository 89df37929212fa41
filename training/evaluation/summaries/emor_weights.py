"""P4: whether the estimated EMoR weights follow the true ones from body to body."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crfnet_core.response.curve import SAMPLES
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float64Array, IndexArray
from training.data.real.photographs import RealPhotograph
from training.evaluation.measure.figures import DRAWN_SAMPLES, PhotographFigures
from training.evaluation.report.errors import Interval
from training.evaluation.summaries.bootstrap import Resampling, interval

#: EMoR weights that are correlated: those that matter (docs/METHOD.md).
WEIGHTS = 3

#: Fewer bodies have no correlation that says anything.
LEAST_BODIES = 3

#: Product of the two variances up to which a weight counts as constant.
LEAST_SPREAD = 1e-12


def weight_correlations(
    photographs: Sequence[RealPhotograph], figures: Sequence[PhotographFigures], *, seed: int
) -> tuple[Interval, ...]:
    """Return the correlation over bodies of each of the first EMoR weights, true against estimated.

    The weights of a body are the means over its photographs; bodies are resampled.

    Parameters
    ----------
    photographs : sequence of RealPhotograph
        N real photographs.
    figures : sequence of PhotographFigures
        Those of one model on them, with the curves.
    seed : int
        Of the bootstrap.

    Returns
    -------
    tuple of Interval
        `WEIGHTS` of them; none with fewer than `LEAST_BODIES` bodies.
    """
    _, body = np.unique([photograph.body_key for photograph in photographs], return_inverse=True)
    bodies = body.max() + 1
    if bodies < LEAST_BODIES:
        return ()
    true = EmorBasis.load().project(np.stack([photograph.truth().brightness for photograph in photographs]))
    drawn = np.array([row.curve for row in figures], dtype=np.float64)
    resampling = Resampling.of(np.arange(bodies), np.zeros(bodies, dtype=int), seed=seed)
    first, second = (_means(weights[:, :WEIGHTS], body) for weights in (true, fitted_weights(drawn)))
    return tuple(_correlation(first[:, k], second[:, k], resampling) for k in range(WEIGHTS))


def fitted_weights(drawn: Float64Array) -> Float64Array:
    """Return the EMoR weights, shape (N, 11), of responses kept at `DRAWN_SAMPLES` irradiances, by least squares."""
    basis = EmorBasis.load()
    index = np.linspace(0, SAMPLES - 1, DRAWN_SAMPLES).round().astype(int)
    return np.linalg.lstsq(basis.components[:, index].T, (drawn - basis.mean[index]).T)[0].T


def _means(values: Float64Array, groups: IndexArray) -> Float64Array:
    """Return the means, shape (G, K), of rows (N, K) of each group; `groups` (N,) are numbers from 0."""
    return np.stack([values[groups == k].mean(axis=0) for k in range(groups.max() + 1)])


def _correlation(first: Float64Array, second: Float64Array, resampling: Resampling) -> Interval:
    """Return Pearson's correlation of two weights of G bodies, 0 where one does not vary.

    A resample that draws one body only has no correlation, and is left out.
    """

    def covariance(one: Float64Array, other: Float64Array) -> Float64Array:
        return resampling.means(one * other) - resampling.means(one) * resampling.means(other)

    product = covariance(first, first) * covariance(second, second)  # (1 + R,)
    has_spread = product > LEAST_SPREAD
    if not has_spread[0]:
        return Interval(0.0, 0.0, 0.0)
    correlations = covariance(first, second)[has_spread] / np.sqrt(product[has_spread])
    return interval(np.clip(correlations, -1, 1))
