"""report.md: every table of a report through one writer; the tables are described by data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import Any

from training.data.real.photographs import REAL, REAL_BODIES
from training.evaluation.baselines import GAMMA, MEAN_CURVE, OTHER_BODIES
from training.evaluation.measure.simulated import PAPER
from training.evaluation.report import paper
from training.evaluation.report.document import Report, ReportRow, value


@dataclass(frozen=True)
class Listed:
    """A table with a row for each estimator; `figures` are head of a column -> figure, no `groups` show all."""

    tables: tuple[str, ...]
    figures: dict[str, str]
    groups: tuple[str, ...] = ()


@dataclass(frozen=True)
class Crossed:
    """A table with a row for each group, and a column for each estimator, with `has_ways` for each way of asking."""

    tables: tuple[str, ...]
    figures: tuple[str, ...] = ("E_est mean", "shape mean")
    has_ways: bool = False


@dataclass(frozen=True)
class Section:
    """A title, a text, and tables."""

    title: str
    text: str
    tables: tuple[Listed | Crossed, ...]


#: The most characters of a line of text.
WIDTH = 120

#: Figures that are shown with their interval, by the end of their names.
WITH_INTERVAL = ("E_est mean", "shape mean", "partial mean", "difference", "correlation")

#: Baselines that report.json has and these tables have not.
HIDDEN = ("sRGB", "Rec.709", "geometric median curve", "oracle: EMoR, 1 component")

ERROR_FIGURES = {
    "E_est": "E_est mean",
    "ratio": "E_est ratio",
    "wins": "E_est win rate",
    "E_lin": "E_lin mean",
    "shape": "shape mean",
}

STATED = {
    "stated": "stated mean",
    "found": "error mean",
    "rank correlation": "rank correlation",
    "band holds": "band coverage",
    "gain": "gain",
}

#: The estimators that tables by group show beside the models.
SHOWN_BASELINES = (GAMMA, MEAN_CURVE, OTHER_BODIES, paper.PAPER)

INTRODUCTION = """# How accurate the models are

E_est, E_lin (x 1e-2) and the shape error in stops are defined in `docs/METHOD.md` (Eq. 32 to 34), the protocols in
`training/README.md`. "Ratio" is the mean divided by the mean of gamma 2.2 on the same photographs, "wins" the fraction
of photographs on which gamma 2.2 is worse. [Brackets] hold 95 % bootstrap intervals over scenes and responses together,
on P4 over bodies; a difference whose interval contains 0 is a tie. Tables by group give E_est, shape. The
paper is Li & Peers, 2017, on photographs of its own.
"""

SECTIONS = (
    Section(
        "P0: known responses, unseen photographs",
        f"The paper: E_est {paper.OVERALL.estimation} (gamma 2.2: {paper.GAMMA.estimation}), E_lin"
        f" {paper.OVERALL.linearization} ({paper.GAMMA.linearization}), wins {paper.WIN_RATE.estimation:.2f}.",
        (Listed(("P0",), ERROR_FIGURES), Crossed(("P0 by exposure", "P0 by kind"))),
    ),
    Section(
        "P2: unseen responses, unseen photographs",
        "The responses were held out of training and of the bank.",
        (Listed(("P2",), ERROR_FIGURES),),
    ),
    Section(
        "The paper's experiments",
        "Photographs of P0 at exposure s_crf: E_est, and its ratio to the clean ones, or to resolution 1x. Noise is"
        " Gaussian before the response, its variance in squared 255ths of the irradiance that saturates; blur is"
        " Gaussian in linear light, its variance in squared pixels; JPEG has subsampled chroma; resolutions are"
        " means of larger raw photographs. Below, E_est over brightness up to 0.8, and the same with the irradiance"
        " scaled to fit.",
        (
            Crossed((PAPER,), ("E_est mean", "E_est x clean")),
            Listed((PAPER,), {"E_est": "E_est mean", "lower": "lower mean", "scaled": "partial mean"}, ("clean",)),
        ),
    ),
    Section(
        "P4: real photographs",
        "Means over bodies, each counted once. The bank of responses knows nothing of the bodies of the photograph's"
        ' fold. "EXIF lost": the file states only its size; "kind stated": the user then states phone, compact or'
        ' camera. "Mean of the other bodies" does not look at the photograph; oracles choose by the true response.'
        " Photographs with caution (edited, very small, or poorly measured) count only where a table names them.",
        (
            Listed(("P4 both",), ERROR_FIGURES),
            Crossed(
                tuple(
                    f"P4 {folder}{caution}"
                    for folder in (REAL, REAL_BODIES, "both")
                    for caution in ("", ", with caution")
                )
            ),
            Crossed(("P4 both by kind",)),
        ),
    ),
    Section(
        "P4: differences",
        "The first model, as users ask it, less each other row.",
        (Listed(("P4 both",), {error: f"{error} difference" for error in ("E_est", "shape")}),),
    ),
    Section(
        "P4: several photographs of one body",
        "Up to four photographs estimated together, and the same photographs one by one, with caution included.",
        (Listed(("P4 both, pooled",), {"E_est": "E_est mean", "shape": "shape mean"}, ("4 photographs",)),),
    ),
    Section(
        "P4: verdicts and weights",
        'Refused is the verdict "do not trust"; far off is an accepted answer with an E_est above 3'
        " or a shape error above 0.4 stop. Weights: the correlation over bodies of true and estimated EMoR weights.",
        (
            Listed(("P4 both, with caution",), {name: name for name in ("refused", "far off")}),
            Listed(("P4 both",), {f"weight {k}": f"weight {k} correlation" for k in (1, 2, 3)}),
        ),
    ),
    Section(
        "P5: reliability of the uncertainty",
        'Stated and found E_est. "Gain" is 1 if rejecting the most uncertain answers first is as good as rejecting the'
        " worst first, and 0 if it is as good as chance.",
        (Listed(("P5 E_est",), STATED, ("P0", "P2", "P4 both")),),
    ),
    Section(
        "P6: pictures that no response explains",
        "Accepted, of all and by kind. Files name no camera; renders and messengers' copies have the metadata that"
        " their programs write, unless a column excludes it.",
        (Crossed(("P6", "P6 by kind"), ("accepted",), has_ways=True),),
    ),
)


def report_text(report: Report) -> str:
    """Return report.md."""
    settings = ", ".join(f"{name.replace('_', ' ')} {setting}" for name, setting in report.settings.items())
    models = ", ".join(f"{name} (`{sha256[:12]}`)" for name, sha256 in report.models.items())
    measured = fill(f"Models: {models}. Settings: {settings}.", WIDTH)
    parts = [INTRODUCTION, measured + "\n", *(f"- {note}\n" for note in report.notes)]
    for section in SECTIONS:
        texts = (_listed(report, one) if isinstance(one, Listed) else _crossed(report, one) for one in section.tables)
        tables = [text for text in texts if text]
        parts += [f"## {section.title}\n", fill(section.text, WIDTH) + "\n", *tables] if tables else []
    return "\n".join(parts)


def markdown_table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [f"| {' | '.join(row)} |" for row in (header, ["---"] * len(header), *rows)]
    return "\n".join(lines) + "\n"


def _listed(report: Report, table: Listed) -> str:
    """Return tables, one for each group, with a row for each estimator that has the first figure.

    Of models after the first, only the answers with the file's metadata are listed.
    """
    others = [f"{model}, {way}" for model in list(report.models)[1:] for way in ("EXIF", "metadata")]
    first, unlisted = next(iter(table.figures.values())), (*HIDDEN, *others)
    groups: dict[str, list[list[str]]] = {}
    for row in report.table(*table.tables):
        is_chosen = first in row and (not table.groups or row["group"] in table.groups)
        if is_chosen and not row["estimator"].startswith(unlisted):
            cells = [row["estimator"], *(_cell(name, row.get(name)) for name in table.figures.values())]
            groups.setdefault(f"{_name(row)}: {_counts(row)}", []).append(cells)
    return "\n".join(markdown_table([place, *table.figures], cells) for place, cells in groups.items())


def _crossed(report: Report, table: Crossed) -> str:
    """Return a table with a row for each group and a column for each model and shown baseline."""
    models = tuple(report.models)
    estimators = dict[str, None]()
    groups: dict[str, dict[str, ReportRow]] = {}
    for row in report.table(*table.tables):
        name = row["estimator"]
        if name in (*models, *SHOWN_BASELINES) or (table.has_ways and name.startswith(models)):
            estimators[name] = None
            groups.setdefault(_name(row), {})[name] = row
    cells = [
        [f"{name}: {_counts(next(iter(group.values())))}", *(_means(group.get(each), table) for each in estimators)]
        for name, group in groups.items()
    ]
    return markdown_table(["", *estimators], cells) if cells else ""


def _means(row: ReportRow | None, table: Crossed) -> str:
    """Return the figures of one estimator on one group, without intervals."""
    return ", ".join(_number(value(row[figure])) for figure in table.figures) if row else ""


def _name(row: ReportRow) -> str:
    """Return the name of a row's group, or of its table."""
    return str(row["group"] or row["table"])


def _counts(row: ReportRow) -> str:
    """Return the number of photographs, and of bodies."""
    bodies = f" of {row['bodies']} bodies" if "bodies" in row else ""
    return f"{row['photographs']} photographs{bodies}"


def _cell(name: str, figure: Any) -> str:
    """Return a figure, with its interval where it has one that is shown."""
    if isinstance(figure, list) and name.endswith(WITH_INTERVAL):
        return "{} [{}, {}]".format(*map(_number, figure))
    return "" if figure is None else _number(value(figure))


def _number(figure: Any) -> str:
    """Return a figure as text."""
    return f"{figure:.2f}" if isinstance(figure, float) else str(figure)
