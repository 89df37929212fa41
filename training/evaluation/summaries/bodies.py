"""Sum up P4: the mean of each body, and the means over bodies, each counted once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from training.data.real.photographs import RealPhotograph
from training.evaluation.baselines import GAMMA, OTHER_BODIES
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.figures import PhotographFigures
from training.evaluation.report.errors import Interval, PerError
from training.evaluation.report.real.content import (
    POOLED,
    BodySummary,
    RealFigures,
    RealReport,
    RealRow,
    pooled_name,
)
from training.evaluation.summaries.bootstrap import Resampling
from training.evaluation.summaries.emor_weights import weight_correlations
from training.evaluation.summaries.error_table import ErrorColumns, ErrorTable
from training.evaluation.summaries.trust import trusted_wrongly

#: Whether a photograph was made smaller after the camera -> the name of this origin.
SCALING = {True: "scaled", False: "not scaled"}

#: The baselines that stand beside the models in the rows of bodies and of photographs.
SHOWN_BASELINES = (GAMMA, OTHER_BODIES)


@dataclass(frozen=True)
class RealTable:
    """Real photographs, and the figures of every estimator on them.

    Parameters
    ----------
    photographs : tuple of RealPhotograph
        The N photographs.
    figures : dict
        Name of a model or baseline -> its figures on the N photographs.
    """

    photographs: tuple[RealPhotograph, ...]
    figures: dict[str, list[PhotographFigures]]

    @classmethod
    def of(cls, photographs: Sequence[RealPhotograph], files: dict[str, CaseFile]) -> RealTable:
        """Return the figures that case files hold of real photographs."""
        names = [photograph.name for photograph in photographs]
        figures = {name: rows for file in files.values() for name, rows in file.figures(names).items()}
        return cls(tuple(photographs), figures)

    @classmethod
    def joined(cls, tables: Sequence[RealTable]) -> RealTable:
        """Return the photographs of several tables, one after the other; those without any count for nothing."""
        tables = [table for table in tables if table.photographs] or list(tables[:1])
        figures = {name: [row for table in tables for row in table.figures[name]] for name in tables[0].figures}
        return cls(tuple(photograph for table in tables for photograph in table.photographs), figures)

    def subset(self, chosen: Iterable[int]) -> RealTable:
        """Return the photographs at some positions."""
        index = list(chosen)
        figures = {name: [rows[k] for k in index] for name, rows in self.figures.items()}
        return RealTable(tuple(self.photographs[k] for k in index), figures)

    @property
    def trusted(self) -> RealTable:
        """The photographs whose response was measured well enough to count."""
        return self.subset(k for k, photograph in enumerate(self.photographs) if photograph.is_trusted)

    def groups(self, name_of: Callable[[RealPhotograph], str]) -> dict[str, RealTable]:
        """Return name -> the photographs to which `name_of` gives this name, sorted by name."""
        names = [name_of(photograph) for photograph in self.photographs]
        return {name: self.subset(k for k, own in enumerate(names) if own == name) for name in sorted(set(names))}

    @property
    def bodies(self) -> list[RealTable]:
        """The photographs of each body."""
        keys = [photograph.body_key for photograph in self.photographs]
        return [self.subset(k for k, key in enumerate(keys) if key == body) for body in dict.fromkeys(keys)]

    def with_pooled(self, files: dict[str, CaseFile]) -> RealTable:
        """Return the photographs that were given together with others, and the figures of these answers beside."""
        names = {name for file in files.values() for name in file.rows}
        table = self.subset(k for k, photograph in enumerate(self.photographs) if photograph.name in names)
        pooled = RealTable.of(table.photographs, files).figures
        return RealTable(table.photographs, table.figures | {pooled_name(way): rows for way, rows in pooled.items()})

    def columns(self, name: str) -> ErrorColumns:
        """Return the figures of one estimator as columns."""
        return ErrorColumns.of(self.figures[name])


def real_report(table: RealTable, pooled: RealTable, models: Sequence[str], *, seed: int) -> RealReport:
    """Return the report of P4 on a set of real photographs.

    Parameters
    ----------
    table : RealTable
        All photographs.
    pooled : RealTable
        Those that were given together: see `RealTable.with_pooled`.
    models : sequence of str
        The ways in which the models were asked.
    seed : int
        Of the bootstrap.
    """
    trusted = table.trusted
    has_others = len(trusted.photographs) < len(table.photographs)
    singles = [table.subset([k]) for k in range(len(table.photographs))]

    def summaries(groups: dict[str, RealTable]) -> dict[str, BodySummary]:
        return {name: _summary(group, models, seed) for name, group in groups.items()}

    return RealReport(
        trusted=_summary(trusted, models, seed),
        everything=_summary(table, models, seed) if has_others else None,
        kinds=summaries(trusted.groups(lambda photograph: photograph.kind)),
        origins=summaries(_origins(trusted)),
        origins_of_everything=summaries(_origins(table)),
        weights=_weights(trusted, models, seed),
        weights_of_everything=_weights(table, models, seed),
        trusted_wrongly={name: trusted_wrongly(trusted.figures[name]) for name in models},
        trusted_wrongly_of_everything={name: trusted_wrongly(table.figures[name]) for name in models},
        bodies=tuple(_row(part.photographs[0].body, part, models) for part in trusted.bodies),
        photographs=tuple(_row(part.photographs[0].name, part, models) for part in singles),
        pooled=_pooled(pooled, models, seed),
    )


def _pooled(table: RealTable, models: Sequence[str], seed: int) -> dict[str, BodySummary]:
    """Return the means over the bodies of which at least so many photographs were given together."""
    counts = Counter(photograph.body_key for photograph in table.photographs)
    groups = {
        name: table.subset(k for k, photograph in enumerate(table.photographs) if counts[photograph.body_key] >= least)
        for name, least in POOLED.items()
    }
    names = [pooled_name(name) for name in models]
    return {name: _summary(group, [*names, *models], seed) for name, group in groups.items() if group.photographs}


def _weights(table: RealTable, models: Sequence[str], seed: int) -> dict[str, tuple[Interval, ...]]:
    """Return, for each model, how its EMoR weights follow the true ones."""
    return {name: weight_correlations(table.photographs, table.figures[name], seed=seed) for name in models}


def _origins(table: RealTable) -> dict[str, RealTable]:
    """Return the photographs by whether an editor saved them, and by whether they were scaled."""
    edited = table.groups(lambda photograph: photograph.editing.value)
    return edited | table.groups(lambda photograph: SCALING[photograph.is_scaled])


def _summary(table: RealTable, models: Sequence[str], seed: int) -> BodySummary:
    """Return the means over bodies; bodies, not photographs, are resampled and count equally."""
    keys, body = np.unique([photograph.body_key for photograph in table.photographs], return_inverse=True)
    resampling = Resampling.of(body, np.zeros(len(body), dtype=int), seed=seed).scaled(1 / np.bincount(body)[body])
    errors = ErrorTable({name: table.columns(name) for name in table.figures}, resampling)
    return BodySummary(
        bodies=len(keys),
        photographs=len(table.photographs),
        estimators={name: errors.summary(name) for name in errors.names(models)},
        differences=errors.differences([*models, OTHER_BODIES]),
    )


def _row(name: str, table: RealTable, models: Sequence[str]) -> RealRow:
    """Return the mean figures on the photographs of one body, or on one photograph."""
    first = table.photographs[0]
    return RealRow(
        name=name,
        body=first.body,
        kind=first.kind,
        grade="".join(sorted({photograph.grade for photograph in table.photographs})),
        photographs=len(table.photographs),
        estimators={estimator: _means(table.figures[estimator]) for estimator in [*models, *SHOWN_BASELINES]},
        editing=", ".join(sorted({photograph.editing.value for photograph in table.photographs})),
        is_scaled=any(photograph.is_scaled for photograph in table.photographs),
        caution="; ".join(dict.fromkeys(photograph.caution for photograph in table.photographs)),
    )


def _means(figures: Sequence[PhotographFigures]) -> RealFigures:
    """Return the mean of every figure; a baseline has neither uncertainty nor coverage."""
    return RealFigures(
        errors=PerError.combined(lambda *values: float(np.mean(values)), *(row.errors for row in figures)),
        uncertainty=_mean([row.uncertainty for row in figures]),
        shape_uncertainty=_mean([row.shape_uncertainty for row in figures]),
        verdict=", ".join(sorted({row.verdict for row in figures if row.verdict})),
        coverage=_mean([row.coverage for row in figures]),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    """Return the mean of values, or None where one is absent."""
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if len(known) == len(values) else None
