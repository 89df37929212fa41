"""P5: whether the reported uncertainty says how large the error is."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.stats import spearmanr

#: Groups of photographs, of rising uncertainty and equal size, of the reliability table.
BINS = 8


def calibration(errors: np.ndarray, uncertainties: np.ndarray, coverage: np.ndarray) -> dict[str, Any]:
    """Return how well uncertainties foretell errors.

    Parameters
    ----------
    errors, uncertainties : ndarray, shape (N,)
        E_est of every photograph, and what the product expected it to be.
    coverage : ndarray, shape (N,)
        Share of the true response inside the 90 % band.

    Returns
    -------
    dict
        "bins": mean uncertainty, mean error and number of photographs, the least uncertain first; "rank correlation"
        (Spearman); "band coverage", the mean; "rejection area", the mean error of what is kept over all shares
        rejected, the most uncertain first; the same for an "oracle" that rejects the largest errors and for "random"
        rejection; "gain", the part in (-inf, 1] of the way from random to oracle.
    """
    order = np.argsort(uncertainties, kind="stable")
    parts = [part for part in np.array_split(order, BINS) if len(part)]
    area, oracle = rejection_curve(errors, uncertainties).mean(), rejection_curve(errors, errors).mean()
    chance = errors.mean()
    is_constant = np.ptp(uncertainties) == 0 or np.ptp(errors) == 0
    return {
        "photographs": len(errors),
        "bins": [
            {
                "uncertainty": round(float(uncertainties[part].mean()), 4),
                "error": round(float(errors[part].mean()), 4),
                "photographs": len(part),
            }
            for part in parts
        ],
        "mean uncertainty": round(float(uncertainties.mean()), 4),
        "mean error": round(float(chance), 4),
        "rank correlation": 0.0 if is_constant else round(float(spearmanr(uncertainties, errors).statistic), 4),
        "band coverage": round(float(coverage.mean()), 4),
        "rejection area": round(float(area), 4),
        "rejection area, oracle": round(float(oracle), 4),
        "rejection area, random": round(float(chance), 4),
        "gain": round(float((chance - area) / max(chance - oracle, 1e-12)), 4),
    }


def rejection_curve(errors: np.ndarray, doubts: np.ndarray) -> np.ndarray:
    """Return the mean error of the n photographs of least doubt, for n = N down to 1, shape (N,).

    Photographs of equal doubt share their mean error, so that their order does not matter.
    """
    _, groups = np.unique(doubts, return_inverse=True)
    mean = np.bincount(groups, weights=errors) / np.bincount(groups)
    ordered = mean[groups][np.argsort(doubts, kind="stable")]
    return (np.cumsum(ordered) / np.arange(1, len(errors) + 1))[::-1]
