"""The section of report.md on P4, real photographs."""

from __future__ import annotations

from collections.abc import Sequence

from training.evaluation.baselines import GAMMA, MEAN_CURVE, OTHER_BODIES
from training.evaluation.measure.real_photographs import REAL, REAL_BODIES
from training.evaluation.report import paper
from training.evaluation.report.content import BOTH, BodySummary, RealReport, RealRow
from training.evaluation.report.errors import ERROR_NAMES
from training.evaluation.report.markdown_tables import (
    bold,
    differences_table,
    error_header,
    mean_cells,
    overall_table,
    rows_of,
)

INTRODUCTION = """\
Photographs of cameras whose response was measured from exposure stacks. All figures are means over bodies, each counted
once; bodies are resampled. "{others}" is what someone estimates who knows cameras and does not look at the
photograph: the mean response, in log irradiance, of the bodies of the same folder that are not in the same fold (in
data/real each body is a fold of its own). A measured response knows its shape well and its scale, where white is
reached, much worse: so the shape error says more than E_est. The paper's Fig. 6 has 8 real photographs, E_est {low} to
{high}.
"""

#: Set of real photographs -> its title.
TITLES = {REAL: "data/real: responses of grade A and B", REAL_BODIES: "data/real_bodies", BOTH: "Both folders"}


def real_section(sets: dict[str, RealReport], models: Sequence[str]) -> list[str]:
    """Return the section of P4."""
    low, high = paper.REAL_RANGE
    parts = ["## P4: real photographs\n", INTRODUCTION.format(others=OTHER_BODIES, low=low, high=high)]
    for name, report in sets.items():
        parts += _set(TITLES[name], report, models)
    for name, report in sets.items():
        if name != BOTH:
            parts += [f"### By body, data/{name}\n", _by_body(report.bodies, models)]
    return parts


def _set(title: str, report: RealReport, models: Sequence[str]) -> list[str]:
    """Return the tables of one set of photographs."""
    parts = [f"### {title}: {_counts(report.trusted)}\n", *_means(report.trusted, models)]
    if report.all_grades:
        parts += [f"All grades: {_counts(report.all_grades)}.\n", *_means(report.all_grades, models)]
    return [*parts, "By kind of body:\n", _by_kind(report.kinds, models)]


def _counts(summary: BodySummary) -> str:
    """Return how many photographs and bodies there are."""
    bodies = "body" if summary.bodies == 1 else "bodies"
    return f"{summary.photographs} photographs of {summary.bodies} {bodies}"


def _means(summary: BodySummary, models: Sequence[str]) -> list[str]:
    """Return the table of all estimators, and the differences between the models and the mean of the other bodies."""
    differences = differences_table(("", difference) for difference in summary.differences)
    return [overall_table(summary.estimators, models, with_paper=False), *differences]


def _by_kind(kinds: dict[str, BodySummary], models: Sequence[str]) -> str:
    """Return the means over the bodies of each kind."""
    rows = []
    for kind, summary in kinds.items():
        for name in [*models, GAMMA, MEAN_CURVE, OTHER_BODIES]:
            cells = mean_cells(summary.estimators[name])
            rows.append([kind, str(summary.bodies), str(summary.photographs), bold(name, models), *cells])
    return rows_of(["kind", "bodies", "photographs", "", *ERROR_NAMES], rows)


def _by_body(bodies: Sequence[RealRow], models: Sequence[str]) -> str:
    """Return the mean errors of every body."""
    header = ["body", "kind", "grade", "n"]
    header += [*error_header([*models, GAMMA, OTHER_BODIES]), *(f"{name}: expected E_est" for name in models)]
    rows = []
    for row in bodies:
        errors = [row.estimators[name].errors for name in [*models, GAMMA, OTHER_BODIES]]
        cells = [f"{value:.2f}" for each in errors for _, value in each.items()]
        expected = [f"{row.estimators[name].uncertainty:.2f}" for name in models]
        rows.append([row.name, row.kind, row.grade, str(row.photographs), *cells, *expected])
    return rows_of(header, rows)
