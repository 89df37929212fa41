"""Sum up P3: every condition against the clean photographs, every query against the plain one."""

from __future__ import annotations

from collections.abc import Sequence

from crfnet_core.types import Float64Array
from training.evaluation.baselines import BASELINES, GAMMA
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.plan import CLEAN, PLAIN, TestPhotograph
from training.evaluation.report.content import PartialSummary, RelativeToClean, StressReport, StressRow, StressSummary
from training.evaluation.report.errors import TIE, Comparison, PerError
from training.evaluation.summaries.error_table import ErrorTable


def stress_report(
    photographs: Sequence[TestPhotograph], files: dict[str, CaseFile], models: Sequence[str], *, seed: int
) -> StressReport:
    """Return the report of P3."""
    plain = [photograph for photograph in photographs if photograph.query == PLAIN]
    queried = [photograph for photograph in photographs if photograph.query != PLAIN]
    conditions = {
        condition.name: ErrorTable.of([each for each in plain if each.condition == condition], files, seed=seed)
        for condition in dict.fromkeys(photograph.condition for photograph in plain)
    }
    of_models = {name: file for name, file in files.items() if name != BASELINES}
    queries = {
        query.name: ErrorTable.of([each for each in queried if each.query == query], of_models, seed=seed)
        for query in dict.fromkeys(photograph.query for photograph in queried)
    }
    clean = conditions[CLEAN.name]
    return StressReport(
        photographs=clean.photographs,
        conditions={name: _row(table, clean, models, [*models, GAMMA]) for name, table in conditions.items()},
        queries={name: _row(table, clean, models, models) for name, table in queries.items()},
        partial={name: _partial(clean, name) for name in [*models, GAMMA]},
    )


def _row(table: ErrorTable, clean: ErrorTable, models: Sequence[str], estimators: Sequence[str]) -> StressRow:
    """Return the figures under one condition or query."""
    return StressRow({name: _summary(table, clean, name) for name in estimators}, table.differences(models))


def _summary(table: ErrorTable, clean: ErrorTable, estimator: str) -> StressSummary:
    """Return the figures of one estimator, and its errors against those of the clean photographs, asked plainly.

    Gamma 2.2 does not depend on the query: where it was not measured, it is that of the clean photographs.
    """
    resampling = table.resampling

    def relative(values: Float64Array, clean_values: Float64Array) -> RelativeToClean:
        difference = resampling.difference(values, clean_values)
        verdict = TIE if difference.contains_zero else "worse" if difference.value > 0 else "better"
        return RelativeToClean(resampling.ratio(values, clean_values), Comparison(difference, verdict))

    gamma = table.columns.get(GAMMA, clean.columns[GAMMA])
    parts = (part.columns[estimator].errors for part in (table, clean))
    return StressSummary(table.summary(estimator, gamma=gamma), PerError.combined(relative, *parts))


def _partial(clean: ErrorTable, estimator: str) -> PartialSummary:
    """Return E_est over the lower part of the irradiance, and over all of it (CRF-net paper, Fig. 9)."""
    columns, resampling = clean.columns[estimator], clean.resampling
    return PartialSummary(
        lower=resampling.mean(columns.partial),
        whole=resampling.mean(columns.errors.estimation),
        ratio=resampling.ratio(columns.partial, columns.errors.estimation),
    )
