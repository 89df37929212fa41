"""The part of P4 in report.md on single photographs: the worst, the wrongly trusted, those that need caution."""

from __future__ import annotations

from collections.abc import Sequence

from training.evaluation.baselines import OTHER_BODIES
from training.evaluation.report.markdown_tables import rows_of
from training.evaluation.report.real.content import FAR_OFF, FAR_OFF_STOPS, RealReport, RealRow, TrustedWrongly

#: Photographs in the table of the worst.
WORST = 10

#: What tables call the photographs that count in the means.
COUNTED = "those that count"


def single_photographs(report: RealReport, models: Sequence[str]) -> list[str]:
    """Return the tables of single photographs, of all that were measured."""
    first, *_ = models
    parts = [
        f"### The worst {WORST}: the largest shape errors of {first}\n",
        "Those that need caution are among them.\n",
        _photographs(worst(report.photographs, first), first),
        "### Verdicts that are too good\n",
        f'Of the photographs with the verdict "good" or "usable", how many have an E_est above {FAR_OFF:g}, and how'
        f" many a shape error above {FAR_OFF_STOPS:g} stops:\n",
        _trusted_wrongly(report),
    ]
    careful = [row for row in report.photographs if row.caution]
    if careful:
        parts += ["### Photographs that need caution\n", "They are left out of the means.\n"]
        parts.append(_photographs(careful, first))
    return parts


def worst(photographs: Sequence[RealRow], model: str) -> list[RealRow]:
    """Return the photographs of the largest shape error of a model, the worst first, at most `WORST`."""
    return sorted(photographs, key=lambda row: -row.estimators[model].errors.shape)[:WORST]


def _photographs(photographs: Sequence[RealRow], model: str) -> str:
    """Return a table of photographs: errors of a model and of the mean of the other bodies, and what is known."""
    rows = []
    for row in photographs:
        own, other = row.estimators[model], row.estimators[OTHER_BODIES]
        stated = own.uncertainty or 0.0
        figures = [own.errors.shape, own.shape_uncertainty or 0.0, own.errors.estimation, stated]
        origin = [row.editing, "yes" if row.is_scaled else "no", row.caution]
        cells = [f"{figure:.2f}" for figure in figures]
        others = [f"{other.errors.shape:.2f}", f"{other.errors.estimation:.2f}"]
        rows.append([row.name, row.body, row.kind, *cells, own.verdict, *others, *origin])
    header = ["photograph", "body", "kind", "shape", "expected", "E_est", "expected", "verdict"]
    header += [f"{OTHER_BODIES}: shape", "E_est", "edited", "scaled", "caution"]
    return rows_of(header, rows)


def _trusted_wrongly(report: RealReport) -> str:
    """Return how often each model trusts an answer that is far off."""
    rows = []
    for name, counts in report.trusted_wrongly.items():
        rows.append([name, COUNTED, *_counts(counts)])
        rows.append([name, "all", *_counts(report.trusted_wrongly_of_everything[name])])
    return rows_of(["", "photographs", "good or usable", "E_est", "shape", "either"], rows)


def _counts(counts: TrustedWrongly) -> list[str]:
    """Return the counts of one model as cells."""
    return [str(number) for number in (counts.photographs, counts.estimation, counts.shape, counts.either)]
