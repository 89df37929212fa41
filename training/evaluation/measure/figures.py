"""The figures of one estimator on one photograph."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.response.curve import SAMPLES, ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, shape_error
from crfnet_core.types import Float64Array, IndexArray
from training.evaluation.baselines import oracle_curves
from training.evaluation.report.errors import PerError

#: The part of the irradiance that a partial response covers (CRF-net paper, Fig. 9).
PARTIAL_IRRADIANCE = 0.8

#: Decimals of the kept figures, and of the kept samples of curves.
DECIMALS, DRAWN_DECIMALS = 6, 4

#: Samples of the responses that are kept for the plots.
DRAWN_SAMPLES = 65

#: The values of 8-bit codes, in [0, 1].
CODES = np.arange(256) / 255


@dataclass(frozen=True)
class PhotographFigures:
    """How well one estimator did on one photograph.

    Parameters
    ----------
    estimation, linearization, shape : float
        E_est, E_lin (a fraction of the peak) and the shape error in stops, of `crfnet_core.response.metrics`.
    partial : float
        E_est over the samples with E <= `PARTIAL_IRRADIANCE`, both responses as they are.
    uncertainty : float, optional
        The E_est that a model expected; None for a baseline, as are the following.
    shape_uncertainty : float, optional
        The shape error in stops that it expected.
    verdict : str, optional
        What it said in one word: see `crfnet_core.posterior.Verdict`.
    coverage : float, optional
        Fraction of the true response inside the 90 % band, in [0, 1].
    curve : tuple of float, optional
        The estimated response at `DRAWN_SAMPLES` uniform irradiances; only kept of real photographs, as is `band`.
    band : tuple of two tuples of float, optional
        The lower and the upper end of the 90 % band at these irradiances.
    """

    estimation: float
    linearization: float
    shape: float
    partial: float
    uncertainty: float | None = None
    shape_uncertainty: float | None = None
    verdict: str | None = None
    coverage: float | None = None
    curve: tuple[float, ...] | None = None
    band: tuple[tuple[float, ...], tuple[float, ...]] | None = None

    @property
    def errors(self) -> PerError[float]:
        """The three errors in the units of the report: E_lin is x 1e-2."""
        return PerError(self.estimation, 100 * self.linearization, self.shape)

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Return the names of the fields, in their order."""
        return tuple(field.name for field in fields(cls))

    @classmethod
    def of_values(cls, values: dict[str, Any]) -> PhotographFigures:
        """Return the figures of name -> value, as JSON keeps them."""
        return cls(**{name: _tuples(value) for name, value in values.items()})


def baseline_figures(true: ResponseCurve, estimated: ResponseCurve, counts: IndexArray) -> PhotographFigures:
    """Return the errors of one response on one photograph.

    Parameters
    ----------
    true, estimated : ResponseCurve
        The responses.
    counts : ndarray, int, shape (256,)
        How often each code occurs in the photograph.
    """
    lower = round(PARTIAL_IRRADIANCE * (SAMPLES - 1)) + 1
    difference = true.brightness - estimated.brightness
    return PhotographFigures(
        estimation=round(estimation_error(true, estimated), DECIMALS),
        linearization=round(linearization_error(CODES, true, estimated, counts=counts), DECIMALS),
        shape=round(shape_error(true, estimated), DECIMALS),
        partial=round(float(np.linalg.norm(difference[:lower])), DECIMALS),
    )


def all_baselines(
    true: ResponseCurve, counts: IndexArray, constants: dict[str, ResponseCurve]
) -> dict[str, PhotographFigures]:
    """Return the figures of every baseline on one photograph: the constant guesses and the oracles."""
    curves = constants | oracle_curves(true)
    return {name: baseline_figures(true, curve, counts) for name, curve in curves.items()}


def model_figures(
    true: ResponseCurve,
    estimate: ResponseEstimate,
    counts: IndexArray,
    *,
    curve: ResponseCurve | None = None,
    is_drawn: bool = False,
) -> PhotographFigures:
    """Return the errors of a model's estimate, its uncertainty, and how much of the truth its 90 % band holds.

    Parameters
    ----------
    true : ResponseCurve
        The response.
    estimate : ResponseEstimate
        The product's answer.
    counts : ndarray, int, shape (256,)
        How often each code occurs in the photograph.
    curve : ResponseCurve, optional
        The response to measure instead of `estimate.curve`.
    is_drawn : bool
        Whether to keep samples of the estimated response and of its band.
    """
    lower, upper = estimate.band
    inside = (true.brightness >= lower) & (true.brightness <= upper)
    figures = replace(
        baseline_figures(true, curve or estimate.curve, counts),
        uncertainty=round(estimate.uncertainty, DECIMALS),
        shape_uncertainty=round(estimate.shape_uncertainty, DECIMALS),
        verdict=estimate.verdict.value,
        coverage=round(float(inside.mean()), DECIMALS),
    )
    if not is_drawn:
        return figures
    return replace(figures, curve=_drawn(estimate.curve.brightness), band=(_drawn(lower), _drawn(upper)))


def _drawn(samples: Float64Array) -> tuple[float, ...]:
    """Return a response, shape (1024,), at `DRAWN_SAMPLES` uniform irradiances."""
    index = np.linspace(0, SAMPLES - 1, DRAWN_SAMPLES).round().astype(int)
    return tuple(round(float(value), DRAWN_DECIMALS) for value in samples[index])


def _tuples(value: Any) -> Any:
    """Return JSON's lists as tuples."""
    return tuple(_tuples(part) for part in value) if isinstance(value, list) else value
