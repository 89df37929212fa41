"""Figures of a group of photographs: means, intervals, comparisons, reliability; each a dict of name -> figure."""

from typing import Any

import numpy as np
from scipy.stats import spearmanr

from crfnet_core.posterior import Verdict
from crfnet_core.types import Float64Array
from training.evaluation.baselines import GAMMA
from training.evaluation.measure.figures import ERRORS, WEIGHTS
from training.evaluation.report.cases import Cases, Interval, Resampling

#: Name of a figure -> its value, with or without an interval.
Figures = dict[str, Any]

#: Above these an answer is far off: in E_est, as much as gamma 2.2 on DoRF; in stops of shape error, four times as
#: much as the mean of the other bodies.
FAR_OFF = {"E_est": 3.0, "shape": 0.4}

LEAST_LINEARIZATION = 1e-9  # the least mean E_lin (x 1e-2) of which a PSNR is given
LEAST_BODIES = 3  # fewer bodies have no meaningful correlation
LEAST_SPREAD = 1e-12  # product of the two variances up to which a weight counts as constant


def errors(cases: Cases, estimator: str) -> Figures:
    """Return mean, median, 90th percentile, ratio to gamma 2.2 and win rate of every error, and the PSNR."""
    figures, resampling = dict[str, Any](), cases.resampling
    for error in ERRORS:
        values, gamma = cases.column(error, estimator), cases.column(error, GAMMA)
        figures |= {
            f"{error} mean": resampling.mean(values),
            f"{error} median": resampling.quantile(values, 0.5),
            f"{error} p90": resampling.quantile(values, 0.9),
            f"{error} ratio": resampling.ratio(values, gamma),
            f"{error} win rate": resampling.mean((values < gamma).astype(np.float64)),
        }
    return figures | {"PSNR of the mean": _psnr(figures["E_lin mean"])}


def differences(cases: Cases, first: str, second: str) -> Figures:
    """Return the paired differences of the errors of two estimators."""
    return {
        f"{error} difference": cases.resampling.mean(cases.column(error, first) - cases.column(error, second))
        for error in ERRORS
    }


def changes(cases: Cases, clean: Cases, estimator: str) -> Figures:
    """Return the errors under a condition relative to the errors on the same photographs without it."""
    return {
        f"{error} x clean": cases.resampling.ratio(cases.column(error, estimator), clean.column(error, estimator))
        for error in ERRORS
    }


def partial_errors(cases: Cases, estimator: str) -> Figures:
    """Return E_est over the lower part of the brightness, and the same of scaled estimates (CRF-net paper, Fig. 9)."""
    return {f"{name} mean": cases.resampling.mean(cases.column(name, estimator)) for name in ("lower", "partial")}


def verdicts(cases: Cases, estimator: str) -> Figures:
    """Return how many answers of a model are accepted ("usable"), and how many of these are far off."""
    accepted = [row for row in cases.rows[estimator] if row["verdict"] != Verdict.DO_NOT_TRUST]
    far_off = [row for row in accepted if any(row.get(error, 0) > limit for error, limit in FAR_OFF.items())]
    return {"accepted": len(accepted), "refused": len(cases) - len(accepted), "far off": len(far_off)}


def means(cases: Cases, estimator: str) -> Figures:
    """Return the plain means of the errors, and of what a model expected."""
    names = [name for name in (*ERRORS, "expected E_est", "expected shape") if name in cases.rows[estimator][0]]
    return {f"{name} mean": float(cases.column(name, estimator).mean()) for name in names}


def reliability(cases: Cases, error: str, estimator: str) -> Figures:
    """Return how well a model's expected E_est or shape error foretells the error (P5).

    "gain" is the part, at most 1, of the way from rejecting at random to rejecting the largest errors first that is
    reached when the most uncertain answers are rejected first.
    """
    errors, stated = cases.column(error, estimator), cases.column(f"expected {error}", estimator)
    chance, area, best = errors.mean(), rejection_curve(errors, stated).mean(), rejection_curve(errors, errors).mean()
    is_constant = np.ptp(stated) == 0 or np.ptp(errors) == 0
    return {
        "stated mean": float(stated.mean()),
        "error mean": float(chance),
        "rank correlation": 0.0 if is_constant else float(spearmanr(stated, errors).statistic),
        "band coverage": float(cases.column("band coverage", estimator).mean()),
        "gain": float((chance - area) / max(chance - best, 1e-12)),
    }


def rejection_curve(errors: Float64Array, uncertainties: Float64Array) -> Float64Array:
    """Return the mean error of the n least uncertain photographs, n = N to 1, (N,); equals share their mean."""
    _, groups = np.unique(uncertainties, return_inverse=True)
    means = np.bincount(groups, weights=errors) / np.bincount(groups)
    ordered = means[groups][np.argsort(uncertainties, kind="stable")]
    return (np.cumsum(ordered) / np.arange(1, len(errors) + 1))[::-1]


def weight_correlations(cases: Cases, estimator: str) -> Figures:
    """Return the correlation over bodies, true against estimated, of the first EMoR weights: means over photographs."""
    groups = cases.groups("body key").values()
    if len(groups) < LEAST_BODIES:
        return {}
    resampling = Resampling.from_labels(np.arange(len(groups)), np.zeros(len(groups)))
    rows = cases.rows[estimator]
    true, estimated = (
        np.array([np.mean([rows[number][name] for number in group], axis=0) for group in groups])
        for name in ("true weights", "weights")
    )
    correlations = (_correlation(true[:, k], estimated[:, k], resampling) for k in range(WEIGHTS))
    return {f"weight {number} correlation": correlation for number, correlation in enumerate(correlations, 1)}


def rounded(figures: Figures) -> Figures:
    """Return figures with their floats rounded to 4 decimals, intervals as lists."""
    return {name: _rounded(value) for name, value in figures.items()}


def _rounded(value: Any) -> Any:
    if isinstance(value, Interval):
        return [round(part, 4) for part in value]
    return round(value, 4) if isinstance(value, float) else value


def _psnr(mean: Interval) -> Interval:
    """Return the PSNR in decibels of a mean E_lin, x 1e-2; a larger error has a smaller PSNR."""
    ends = (mean.value, mean.high, mean.low)
    return Interval(*(float(-20 * np.log10(max(end, LEAST_LINEARIZATION) / 100)) for end in ends))


def _correlation(first: Float64Array, second: Float64Array, resampling: Resampling) -> Interval:
    """Return Pearson's correlation of two weights of G bodies, 0 where one is constant; not of one-body resamples."""

    def covariance(one: Float64Array, other: Float64Array) -> Float64Array:
        return resampling.means(one * other) - resampling.means(one) * resampling.means(other)

    product = covariance(first, first) * covariance(second, second)  # (1 + R,)
    has_spread = product > LEAST_SPREAD
    if not has_spread[0]:
        return Interval(0.0, 0.0, 0.0)
    correlations = covariance(first, second)[has_spread] / np.sqrt(product[has_spread])
    return Interval.from_samples(np.clip(correlations, -1, 1))
