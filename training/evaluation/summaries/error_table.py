"""The errors of all estimators on the same photographs, side by side, and their summaries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from crfnet_core.response.metrics import peak_signal_to_noise
from crfnet_core.types import BoolArray, Float64Array, IndexArray
from training.evaluation.baselines import GAMMA
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.figures import PhotographFigures
from training.evaluation.plan import TestPhotograph
from training.evaluation.report.content import GroupSummary
from training.evaluation.report.errors import (
    TIE,
    Comparison,
    ErrorSummary,
    EstimatorDifference,
    EstimatorSummary,
    Interval,
    PerError,
)
from training.evaluation.summaries.bootstrap import Resampling

#: The least mean E_lin (x 1e-2) of which a PSNR is given.
LEAST_LINEARIZATION = 1e-9


@dataclass(frozen=True, eq=False)
class ErrorColumns:
    """The figures of one estimator on N photographs: an array for each figure.

    Parameters
    ----------
    errors : PerError of ndarray, float64, shape (N,)
        In the units of the report: E_lin is x 1e-2.
    partial : ndarray, float64, shape (N,)
        E_est over the lower part of the irradiance.
    uncertainty, shape_uncertainty, coverage : ndarray, float64, shape (N,)
        Expected E_est, expected shape error in stops, and fraction of the true response inside the band; NaN for a
        baseline.
    """

    errors: PerError[Float64Array]
    partial: Float64Array
    uncertainty: Float64Array
    shape_uncertainty: Float64Array
    coverage: Float64Array

    @classmethod
    def of(cls, rows: Sequence[PhotographFigures]) -> ErrorColumns:
        """Return the columns of the figures on N photographs."""
        return cls(
            PerError.combined(lambda *values: np.array(values), *(row.errors for row in rows)),
            partial=np.array([row.partial for row in rows]),
            uncertainty=np.array([row.uncertainty for row in rows], dtype=np.float64),
            shape_uncertainty=np.array([row.shape_uncertainty for row in rows], dtype=np.float64),
            coverage=np.array([row.coverage for row in rows], dtype=np.float64),
        )

    def subset(self, chosen: BoolArray | IndexArray) -> ErrorColumns:
        """Return the columns of some photographs, from a mask (N,) or indices."""
        errors = PerError.combined(lambda values: values[chosen], self.errors)
        stated = (self.uncertainty, self.shape_uncertainty, self.coverage)
        return ErrorColumns(errors, self.partial[chosen], *(values[chosen] for values in stated))

    def expected(self, error: str) -> Float64Array:
        """Return what a model expected "E_est" or "shape" to be, shape (N,)."""
        return {"E_est": self.uncertainty, "shape": self.shape_uncertainty}[error]


@dataclass(frozen=True, eq=False)
class ErrorTable:
    """The figures of all estimators on N photographs, and how the photographs are resampled.

    Parameters
    ----------
    columns : dict
        Name of a model or baseline -> its figures.
    resampling : Resampling
        Weights of the N photographs.
    """

    columns: dict[str, ErrorColumns]
    resampling: Resampling

    @classmethod
    def of(cls, photographs: Sequence[TestPhotograph], files: dict[str, CaseFile], *, seed: int) -> ErrorTable:
        """Return the figures that case files hold of simulated photographs."""
        labels = [photograph.label for photograph in photographs]
        rows = {name: figures for file in files.values() for name, figures in file.figures(labels).items()}
        scenes, curves = np.array([(photograph.scene, photograph.curve) for photograph in photographs]).T
        return cls(
            {name: ErrorColumns.of(figures) for name, figures in rows.items()},
            Resampling.of(scenes, curves, seed=seed),
        )

    @property
    def photographs(self) -> int:
        """How many photographs there are."""
        return self.resampling.weights.shape[1]

    def subset(self, chosen: BoolArray | IndexArray) -> ErrorTable:
        """Return the figures on some photographs, from a mask (N,) or indices."""
        columns = {name: part.subset(chosen) for name, part in self.columns.items()}
        return ErrorTable(columns, self.resampling.subset(chosen))

    def names(self, models: Sequence[str]) -> list[str]:
        """Return the names of all estimators, models first."""
        return [*models, *(name for name in self.columns if name not in models)]

    def summary(self, estimator: str, *, gamma: ErrorColumns | None = None) -> EstimatorSummary:
        """Return the figures of one estimator; `gamma` are those of gamma 2.2, by default the table's own."""
        reference = self.columns[GAMMA] if gamma is None else gamma
        errors = PerError.combined(self._error_summary, self.columns[estimator].errors, reference.errors)
        return EstimatorSummary(errors, psnr=_psnr(errors.linearization.mean))

    def _error_summary(self, values: Float64Array, gamma: Float64Array) -> ErrorSummary:
        """Return the figures of one error."""
        return ErrorSummary(
            mean=self.resampling.mean(values),
            median=self.resampling.quantile(values, 0.5),
            p90=self.resampling.quantile(values, 0.9),
            ratio=self.resampling.ratio(values, gamma),
            win_rate=self.resampling.mean((values < gamma).astype(np.float64)),
        )

    def group(self, estimators: Sequence[str], *, kind: str = "") -> GroupSummary:
        """Return the figures of some estimators."""
        return GroupSummary(self.photographs, {name: self.summary(name) for name in estimators}, kind)

    def differences(self, estimators: Sequence[str]) -> tuple[EstimatorDifference, ...]:
        """Return, for every two of some estimators, the paired differences of their errors, and who is better."""
        return tuple(self._difference(first, second) for first, second in combinations(estimators, 2))

    def _difference(self, first: str, second: str) -> EstimatorDifference:
        """Return how two estimators differ in every error."""

        def compared(values: Float64Array, others: Float64Array) -> Comparison:
            difference = self.resampling.difference(values, others)
            better = first if difference.value < 0 else second
            return Comparison(difference, TIE if difference.contains_zero else f"{better} is better")

        parts = (self.columns[name].errors for name in (first, second))
        return EstimatorDifference(first, second, PerError.combined(compared, *parts))


def _psnr(mean: Interval) -> Interval:
    """Return the PSNR in decibels of a mean E_lin, x 1e-2; a larger error has a smaller PSNR."""
    ends = (mean.value, mean.high, mean.low)
    return Interval(*(peak_signal_to_noise(max(end, LEAST_LINEARIZATION) / 100) for end in ends))
