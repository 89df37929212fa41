"""The section of report.md on P4, real photographs."""

from __future__ import annotations

from collections.abc import Sequence

from crfnet_core.photograph.metadata.origin import SCALED_BELOW
from training.data.real.file_origin import Editing
from training.data.real.photographs import REAL, REAL_BODIES
from training.evaluation.baselines import GAMMA, MEAN_CURVE, ORACLE_DORF, ORACLE_HEADROOM, OTHER_BODIES
from training.evaluation.report import paper
from training.evaluation.report.errors import ERROR_NAMES
from training.evaluation.report.markdown_tables import (
    bold,
    differences_table,
    error_header,
    mean_cells,
    overall_table,
    rows_of,
    with_interval,
)
from training.evaluation.report.real.content import (
    BOTH,
    BodySummary,
    RealReport,
    RealRow,
    pooled_name,
    ways_of,
)
from training.evaluation.report.real.photographs import COUNTED, single_photographs

INTRODUCTION = """\
Photographs of cameras whose response was measured from exposure stacks. All figures are means over bodies, each counted
once; bodies are resampled. Photographs that need caution are shown apart and left out of all other means, unless a
table says that it counts them. A measured response knows its shape well and its scale, where white is reached, much
worse: so the shape error says more than E_est. The paper's Fig. 6 has 8 real photographs, E_est {low} to {high}.

- Each model is asked four times: as users ask it, with the metadata of the file as evidence; with "EXIF lost", as web
  sites send pictures, so that the file says nothing but their size; "kind told" by users who then say whether a phone,
  a compact or another camera took it, where that is known; and with "metadata ignored".
- The bank of responses that answers are chosen from knows nothing of the bodies of the photograph's fold.
- "{others}" is what someone estimates who knows cameras and does not look at the photograph: the
  mean response, in log irradiance, of the bodies of the same folder that are not in the same fold (in data/real each
  body is a fold of its own).
- "{headroom}" is how far one gets by knowing that this is a camera's own
  rendering and where it is cut: the same mean response with the factor on irradiance, below the shoulder, of least
  E_est.
- "{dorf}" is the one of DoRF's 201 responses of least E_est, picked in hindsight.
"""

ORIGIN_TEXT = f"""\
By what happened to the file after the camera: whether a program that changes tones is known to have saved it, and
whether its longest side has fewer than {SCALED_BELOW} pixels, which counts as scaled. "{Editing.UNKNOWN.value}": no
EXIF names the camera, or the list of the folder has none.
"""

POOLED_TEXT = """\
"Pooled" is the answer when up to 4 photographs of one body are given together, measured on each of them by the response
of its own exposure stack; below it stand the answers for the same photographs one by one. Stacks of one body may be of
one scene or of several. Those that need caution count too, since few bodies have 4 photographs.
"""

#: Set of real photographs -> its title.
TITLES = {REAL: "data/real: responses of grade A and B", REAL_BODIES: "data/real_bodies", BOTH: "Both folders"}


def real_section(sets: dict[str, RealReport], models: Sequence[str]) -> list[str]:
    """Return the section of P4; tables of means have each model in all ways of asking, the others as users ask it."""
    ways = [way for model in models for way in ways_of(model)]
    parts = ["## P4: real photographs\n", _introduction()]
    for name, report in sets.items():
        parts += _set(TITLES[name], report, ways)
    for name, report in sets.items():
        if name != BOTH:
            parts += [f"### By body, data/{name}\n", _by_body(report.bodies, models)]
    last = list(sets.values())[-1]
    parts += [*_origins(last, ways), *_pooled(last, ways), *single_photographs(last, models)]
    return parts


def _introduction() -> str:
    """Return what P4 is, with the names of its baselines."""
    low, high = paper.REAL_RANGE
    return INTRODUCTION.format(others=OTHER_BODIES, headroom=ORACLE_HEADROOM, dorf=ORACLE_DORF, low=low, high=high)


def _set(title: str, report: RealReport, models: Sequence[str]) -> list[str]:
    """Return the tables of one set of photographs."""
    parts = [f"### {title}: {_counts(report.trusted)}\n", *_means(report.trusted, models)]
    if report.everything:
        parts += [f"With those that need caution: {_counts(report.everything)}.\n", *_means(report.everything, models)]
    parts += ["By kind of body:\n", _by_group("kind", report.kinds, models)]
    return [*parts, *_weights(report)]


def _origins(report: RealReport, models: Sequence[str]) -> list[str]:
    """Return the tables by what happened to the file, of the photographs that count and of all."""
    parts = ["### Edited or not, scaled or not\n", ORIGIN_TEXT, _by_group("file", report.origins, models)]
    if report.everything:
        groups = _by_group("file", report.origins_of_everything, models)
        parts += ["The same with those that need caution:\n", groups]
    return parts


def _pooled(report: RealReport, ways: Sequence[str]) -> list[str]:
    """Return the tables of several photographs of one body; none if no body has two."""
    if not report.pooled:
        return []
    rows = []
    for group, summary in report.pooled.items():
        for name in [name for way in ways for name in (pooled_name(way), way)] + [OTHER_BODIES]:
            cells = mean_cells(summary.estimators[name])
            rows.append([group, str(summary.bodies), str(summary.photographs), bold(name, ways), *cells])
    table = rows_of(["given together", "bodies", "photographs", "", *ERROR_NAMES], rows)
    return ["### Several photographs of one body\n", POOLED_TEXT, table]


def _weights(report: RealReport) -> list[str]:
    """Return the correlations of the first EMoR weights; none where there are too few bodies."""
    rows = []
    for name, counted in report.weights.items():
        for group, figures in ((COUNTED, counted), ("all", report.weights_of_everything[name])):
            if figures:
                rows.append([name, group, *map(with_interval, figures)])
    if not rows:
        return []
    header = ["", "photographs", *(f"EMoR weight {k + 1}" for k in range(len(rows[0]) - 2))]
    return ["Correlation over bodies of the true and the estimated weight:\n", rows_of(header, rows)]


def _counts(summary: BodySummary) -> str:
    """Return how many photographs and bodies there are."""
    bodies = "body" if summary.bodies == 1 else "bodies"
    return f"{summary.photographs} photographs of {summary.bodies} {bodies}"


def _means(summary: BodySummary, models: Sequence[str]) -> list[str]:
    """Return the table of all estimators, and the differences between the models and the mean of the other bodies."""
    differences = differences_table(("", difference) for difference in summary.differences)
    return [overall_table(summary.estimators, models, with_paper=False), *differences]


def _by_group(title: str, groups: dict[str, BodySummary], models: Sequence[str]) -> str:
    """Return the means over the bodies of each group."""
    rows = []
    for group, summary in groups.items():
        for name in [*models, GAMMA, MEAN_CURVE, OTHER_BODIES, ORACLE_HEADROOM]:
            cells = mean_cells(summary.estimators[name])
            rows.append([group, str(summary.bodies), str(summary.photographs), bold(name, models), *cells])
    return rows_of([title, "bodies", "photographs", "", *ERROR_NAMES], rows)


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
