"""Tables in Markdown that several sections of the report share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from training.evaluation import paper
from training.evaluation.baselines import GAMMA

Table = dict[str, Any]

#: Figures of an estimator, in the tables of all estimators.
COLUMNS = ["E_est mean", "median", "p90", "ratio", "wins", "E_lin mean", "PSNR", "ratio", "wins"]


def rows_of(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [f"| {' | '.join(row)} |" for row in (header, ["---"] * len(header), *rows)]
    return "\n".join(lines) + "\n"


def shown(figure: dict[str, float], decimals: int = 2) -> str:
    """Return a figure with its interval."""
    value, low, high = (f"{figure[key]:.{decimals}f}" for key in ("value", "low", "high"))
    return f"{value} [{low}, {high}]"


def percent(figure: dict[str, float]) -> str:
    """Return a share with its interval, in percent."""
    value, low, high = (f"{100 * figure[key]:.0f}" for key in ("value", "low", "high"))
    return f"{value} % [{low}, {high}]"


def cells_of(row: Table, *, is_reference: bool) -> list[str]:
    """Return the figures of one estimator, in the order of `COLUMNS`; gamma 2.2 is not compared with itself."""
    cells = [
        shown(row["E_est mean"]),
        f"{row['E_est median']['value']:.2f}",
        f"{row['E_est p90']['value']:.2f}",
        shown(row["E_est ratio"]),
        percent(row["E_est win rate"]),
        shown(row["E_lin mean"]),
        f"{row['PSNR of the mean']['value']:.1f} dB",
        shown(row["E_lin ratio"]),
        percent(row["E_lin win rate"]),
    ]
    return [
        cell if key not in ("ratio", "wins") or not is_reference else ""
        for key, cell in zip(COLUMNS, cells, strict=True)
    ]


def _paper_cells() -> list[str]:
    """Return the paper's overall figures, in the order of `COLUMNS`."""
    overall, ratio, wins = paper.OVERALL, paper.RATIO, paper.WIN_RATE
    est = [f"{overall.estimation:.3f}", "", "", f"{ratio.estimation:.3f}", f"{100 * wins.estimation:.0f} %"]
    return [*est, f"{overall.linearisation:.3f}", "", f"{ratio.linearisation:.3f}", f"{100 * wins.linearisation:.0f} %"]


def overall_table(table: Table, models: Sequence[str], *, with_paper: bool) -> str:
    """Return the table of all estimators."""
    estimators = table["estimators"]
    rows = [[bold(name, models), *cells_of(estimators[name], is_reference=name == GAMMA)] for name in estimators]
    if with_paper:
        gamma = paper.GAMMA
        quoted = [["*paper: CRF-net*", *_paper_cells()]]
        quoted += [["*paper: gamma 2.2*", f"{gamma.estimation}", "", "", "", "", f"{gamma.linearisation}", "", "", ""]]
        rows[len(models) : len(models)] = quoted
    return rows_of(["", *COLUMNS], rows)


def bold(name: str, models: Sequence[str]) -> str:
    """Return a name, models in bold."""
    return f"**{name}**" if name in models else name


def differences_table(rows: list[Table]) -> list[str]:
    """Return the paired differences between models, if there are several."""
    if not rows:
        return []
    cells = [[" - ".join(row["models"]), row["error"], shown(row["difference"]), row["verdict"]] for row in rows]
    return ["Paired differences between models:\n", rows_of(["models", "error", "difference", "verdict"], cells)]


def quoted(figures: paper.PaperFigures | None) -> str:
    """Return the paper's E_est and E_lin."""
    return f"{figures.estimation:.3f} / {figures.linearisation:.3f}" if figures else ""
