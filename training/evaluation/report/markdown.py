"""report.md: the text of the file report.md beside this module, filled with the tables of a report."""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from textwrap import fill
from typing import Any

from training.data.real_photographs import REAL, REAL_BODIES
from training.evaluation.baselines import GAMMA, MEAN_CURVE, OTHER_BODIES
from training.evaluation.measure.simulated import PAPER
from training.evaluation.report import paper
from training.evaluation.report.document import Report, ReportRow, value

#: The text; the names in braces are filled in, and a section whose tables are all empty is left out.
TEMPLATE = Path(__file__).with_name("report.md")

#: The most characters of a line of text.
WIDTH = 120

#: Figures that are shown with their interval, by the end of their names.
WITH_INTERVAL = ("E_est mean", "shape mean", "partial mean", "difference", "correlation")

#: The estimators that tables by group show beside the models.
SHOWN_BASELINES = (GAMMA, MEAN_CURVE, OTHER_BODIES, paper.PAPER)

#: Columns of tables: head -> figure.
ERRORS = {
    "E_est": "E_est mean",
    "ratio": "E_est ratio",
    "wins": "E_est win rate",
    "E_lin": "E_lin mean",
    "shape": "shape mean",
}
MEANS = {name: ERRORS[name] for name in ("E_est", "shape")}
PARTIAL = {"E_est": "E_est mean", "lower": "lower mean", "scaled": "partial mean"}
DIFFERENCES = {name: f"{name} difference" for name in MEANS}
VERDICTS = {name: name for name in ("refused", "far off")}
WEIGHTS = {f"weight {k}": f"weight {k} correlation" for k in (1, 2, 3)}
RELIABILITY = {
    "stated": "stated mean",
    "found": "error mean",
    "rank correlation": "rank correlation",
    "band holds": "band coverage",
    "gain": "gain",
}

#: The tables of P4: of each folder, and of both.
REAL_TABLES = [f"P4 {folder}{part}" for folder in (REAL, REAL_BODIES, "both") for part in ("", ", with caution")]


def report_text(report: Report) -> str:
    """Return report.md."""
    settings = ", ".join(f"{name.replace('_', ' ')} {setting}" for name, setting in report.settings.items())
    models = ", ".join(f"{name} (`{sha256[:12]}`)" for name, sha256 in report.models.items())
    measured = fill(f"Models: {models}. Settings: {settings}.", WIDTH)
    notes = "\n\n".join(f"- {note}" for note in report.notes)
    return filled(TEMPLATE, report_tables(report), measured=measured, notes=notes, paper=paper)


def report_tables(report: Report) -> dict[str, str]:
    """Return the tables of `TEMPLATE` by name."""
    by_estimator, by_group = partial(estimator_tables, report), partial(group_table, report)
    return {
        "p0": by_estimator("P0", ERRORS),
        "p0_groups": by_group("P0 by exposure", "P0 by kind"),
        "p2": by_estimator("P2", ERRORS),
        "conditions": by_group(PAPER, figures=("E_est mean", "E_est x clean")),
        "partial": by_estimator(PAPER, PARTIAL, groups=("clean",)),
        "real": by_estimator("P4 both", ERRORS),
        "real_folders": by_group(*REAL_TABLES),
        "real_kinds": by_group("P4 both by kind"),
        "differences": by_estimator("P4 both", DIFFERENCES),
        "pooled": by_estimator("P4 both, pooled", MEANS, groups=("4 photographs",)),
        "verdicts": by_estimator("P4 both, with caution", VERDICTS),
        "weights": by_estimator("P4 both", WEIGHTS),
        "reliability": by_estimator("P5 E_est", RELIABILITY, groups=("P0", "P2", "P4 both")),
        "unusual": by_group("P6", "P6 by kind", figures=("accepted",), has_ways=True),
    }


def filled(template: Path, tables: Mapping[str, str], **facts: Any) -> str:
    """Return the text of a template with its tables and facts, without the sections whose tables are all empty."""
    head, *sections = re.split(r"^(?=## )", template.read_text(encoding="utf-8"), flags=re.MULTILINE)
    empty = dict.fromkeys(tables, "")
    chosen = [part for part in sections if part.format(**tables, **facts) != part.format(**empty, **facts)]
    text = "".join([head, *chosen]).format(**tables, **facts)
    return re.sub(r"\n{3,}", "\n\n", text).rstrip() + "\n"


def markdown_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    return markdown_rows((header, ["---"] * len(header), *rows)) + "\n"


def markdown_rows(rows: Iterable[Sequence[str]]) -> str:
    """Return rows of a Markdown table."""
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def estimator_tables(report: Report, table: str, figures: Mapping[str, str], groups: Sequence[str] = ()) -> str:
    """Return a table for each group of photographs, with a row for each estimator that has the first figure.

    Of models after the first, only the answers with the file's metadata are listed. Without `groups` all are shown.
    """
    others = [f"{model}, {way}" for model in list(report.models)[1:] for way in ("EXIF", "metadata")]
    first = next(iter(figures.values()))
    tables: dict[str, list[list[str]]] = {}
    for row in report.table(table):
        is_chosen = first in row and (not groups or row["group"] in groups)
        if is_chosen and not row["estimator"].startswith(tuple(others)):
            cells = [row["estimator"], *(_cell(name, row.get(name)) for name in figures.values())]
            tables.setdefault(_name(row), []).append(cells)
    return "\n".join(markdown_table([name, *figures], rows) for name, rows in tables.items())


def group_table(
    report: Report, *tables: str, figures: Sequence[str] = tuple(MEANS.values()), has_ways: bool = False
) -> str:
    """Return a table with a row for each group, and a column for each model and shown baseline, without intervals.

    With `has_ways` each way of asking a model has a column of its own.
    """
    models = tuple(report.models)
    groups: dict[str, dict[str, ReportRow]] = {}
    for row in report.table(*tables):
        estimator = row["estimator"]
        if estimator in (*models, *SHOWN_BASELINES) or (has_ways and estimator.startswith(models)):
            groups.setdefault(row["group"] or row["table"], {})[estimator] = row
    estimators = list(dict.fromkeys(estimator for group in groups.values() for estimator in group))
    rows = [
        [_name(next(iter(group.values()))), *(_means(group.get(each), figures) for each in estimators)]
        for group in groups.values()
    ]
    return markdown_table(["", *estimators], rows) if rows else ""


def _name(row: ReportRow) -> str:
    """Return the name of a row's group, or of its table, with the number of photographs, and of bodies."""
    bodies = f" of {row['bodies']} bodies" if "bodies" in row else ""
    return f"{row['group'] or row['table']}: {row['photographs']} photographs{bodies}"


def _means(row: ReportRow | None, figures: Sequence[str]) -> str:
    """Return figures of one estimator on one group, without intervals."""
    return ", ".join(_number(value(row[figure])) for figure in figures) if row else ""


def _cell(name: str, figure: Any) -> str:
    """Return a figure, with its interval where it has one that is shown."""
    if isinstance(figure, list) and name.endswith(WITH_INTERVAL):
        return "{} [{}, {}]".format(*map(_number, figure))
    return "" if figure is None else _number(value(figure))


def _number(figure: Any) -> str:
    return f"{figure:.2f}" if isinstance(figure, float) else str(figure)
