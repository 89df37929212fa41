"""The section of report.md on P3, stress."""

from __future__ import annotations

from collections.abc import Sequence

from training.evaluation.baselines import GAMMA
from training.evaluation.plan import CLEAN
from training.evaluation.report import paper
from training.evaluation.report.content import PartialSummary, StressReport, StressRow, StressSummary
from training.evaluation.report.errors import ERROR_NAMES, TIE
from training.evaluation.report.markdown_tables import (
    bold,
    differences_table,
    mean_cells,
    quoted,
    rows_of,
    with_interval,
)

CONDITIONS_TEXT = """\
{photographs} photographs of P0 at exposure s_crf, under every condition. "x clean" is the ratio to the clean ones,
"tie" a difference to them whose interval contains 0. Where the paper is short of words, we read it so: noise is
Gaussian, added after the response and before quantisation, and its variance is in squared 8-bit codes; blur is a
Gaussian in linear light, and its variance is in squared pixels; "resolution" is the linear scene enlarged by cubic
interpolation; cool white balance has gains of (0.6, 1, 1.7) in linear light at equal luminance, warm (1.7, 1, 0.6);
JPEG has subsampled chroma. Columns of the paper give E_est / E_lin.
"""

QUERIES_TEXT = """\
The clean photographs under other queries. "Random windows" do not have to hold many code values, as the product's
default windows do. The two rows of averages take the mean of the windows' own estimates instead of the product's
answer. Pooled photographs show other scenes through the same response; E_lin is that of the first photograph.
"""

PARTIAL_TEXT = "E_est of the clean photographs, both responses as they are and not rescaled.\n"


def stress_section(report: StressReport, models: Sequence[str]) -> list[str]:
    """Return the section of P3."""
    parts = [
        "## P3: stress\n",
        CONDITIONS_TEXT.format(photographs=report.photographs),
        _conditions(report.conditions, models),
        *_differences(report.conditions),
    ]
    if report.queries:
        plain = report.conditions[CLEAN.name]
        parts += ["### Windows and photographs\n", QUERIES_TEXT, _queries(report.queries, plain, models)]
        parts += _differences(report.queries)
    return [
        *parts,
        "### The lower 80 % of the irradiance (paper, Fig. 9)\n",
        PARTIAL_TEXT,
        _partial(report.partial, models),
    ]


def _conditions(conditions: dict[str, StressRow], models: Sequence[str]) -> str:
    """Return the conditions beside the paper's figures."""
    header = ["condition", "paper", "x clean"]
    header += [cell for name in models for error in ERROR_NAMES for cell in (f"{name}: {error}", "x clean")]
    rows = []
    for condition, row in conditions.items():
        figures = paper.STRESS.get(condition)
        cells = [condition, quoted(figures) or paper.IN_WORDS.get(condition, ""), _paper_to_clean(figures)]
        for name in models:
            cells += _to_clean(row.estimators[name], is_clean=condition == CLEAN.name)
        gamma = row.estimators[GAMMA].summary.errors.linearization.mean
        rows.append([*cells, f"{gamma.value:.2f}"])
    return rows_of([*header, f"{GAMMA}: E_lin"], rows)


def _paper_to_clean(figures: paper.PaperFigures | None) -> str:
    """Return the paper's ratios to its overall figures."""
    if figures is None:
        return ""
    estimation = figures.estimation / paper.OVERALL.estimation
    return f"{estimation:.2f} / {figures.linearization / paper.OVERALL.linearization:.2f}"


def _to_clean(row: StressSummary, *, is_clean: bool) -> list[str]:
    """Return the three errors and their ratios to the clean ones."""
    cells = []
    for mean, (_, relative) in zip(mean_cells(row.summary), row.to_clean.items(), strict=True):
        tie = ", tie" if relative.comparison.verdict == TIE else ""
        cells += [mean, "1" if is_clean else with_interval(relative.ratio) + tie]
    return cells


def _queries(queries: dict[str, StressRow], plain: StressRow, models: Sequence[str]) -> str:
    """Return the queries beside the plain one."""
    header = ["query"]
    for name in models:
        header += [cell for error in ERROR_NAMES for cell in (f"{name}: {error}", "difference", "verdict")]
    means = [mean_cells(plain.estimators[name].summary) for name in models]
    rows = [["as the product is", *(cell for cells in means for mean in cells for cell in (mean, "", ""))]]
    for query, row in queries.items():
        cells = [query]
        for name in models:
            found = row.estimators[name]
            for mean, (_, relative) in zip(mean_cells(found.summary), found.to_clean.items(), strict=True):
                cells += [mean, with_interval(relative.comparison.difference), relative.comparison.verdict]
        rows.append(cells)
    return rows_of(header, rows)


def _differences(table: dict[str, StressRow]) -> list[str]:
    """Return the differences between models under every condition or query, if there are several models."""
    return differences_table((name, difference) for name, row in table.items() for difference in row.differences)


def _partial(partial: dict[str, PartialSummary], models: Sequence[str]) -> str:
    """Return E_est over the lower part of the irradiance and over all of it."""
    rows = [
        [bold(name, models), *(with_interval(figure) for figure in (row.lower, row.whole, row.ratio))]
        for name, row in partial.items()
    ]
    return rows_of(["", "E_est, E <= 0.8", "E_est", "ratio"], rows)
