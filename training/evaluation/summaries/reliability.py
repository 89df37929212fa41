"""P5: whether the stated uncertainty says how large the error is."""

from __future__ import annotations

import numpy as np
from scipy.stats import spearmanr

from crfnet_core.types import Float64Array
from training.evaluation.report.content import Reliability, ReliabilityBin

#: Groups of photographs, of rising uncertainty and equal size, of the reliability table.
BINS = 8


def reliability(errors: Float64Array, uncertainties: Float64Array, coverage: Float64Array) -> Reliability:
    """Return how well uncertainties foretell errors.

    Parameters
    ----------
    errors, uncertainties : ndarray, shape (N,)
        One of the errors of every photograph, and what the product expected it to be.
    coverage : ndarray, shape (N,)
        Fraction of the true response inside the 90 % band.
    """
    order = np.argsort(uncertainties, kind="stable")
    groups = [group for group in np.array_split(order, BINS) if len(group)]
    area = float(rejection_curve(errors, uncertainties).mean())
    oracle, chance = float(rejection_curve(errors, errors).mean()), float(errors.mean())
    is_constant = np.ptp(uncertainties) == 0 or np.ptp(errors) == 0
    return Reliability(
        photographs=len(errors),
        mean_uncertainty=float(uncertainties.mean()),
        mean_error=chance,
        rank_correlation=0.0 if is_constant else float(spearmanr(uncertainties, errors).statistic),
        band_coverage=float(coverage.mean()),
        rejection_area=area,
        oracle_area=oracle,
        random_area=chance,
        gain=(chance - area) / max(chance - oracle, 1e-12),
        bins=tuple(
            ReliabilityBin(float(uncertainties[group].mean()), float(errors[group].mean()), len(group))
            for group in groups
        ),
    )


def rejection_curve(errors: Float64Array, uncertainties: Float64Array) -> Float64Array:
    """Return the mean error of the n least uncertain photographs, for n = N down to 1, shape (N,).

    Photographs of equal uncertainty share their mean error, so that their order does not matter.
    """
    _, groups = np.unique(uncertainties, return_inverse=True)
    means = np.bincount(groups, weights=errors) / np.bincount(groups)
    ordered = means[groups][np.argsort(uncertainties, kind="stable")]
    return (np.cumsum(ordered) / np.arange(1, len(errors) + 1))[::-1]
