"""Tables in Markdown that several sections of the report share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from training.evaluation.baselines import GAMMA
from training.evaluation.report import paper
from training.evaluation.report.errors import ERROR_NAMES, ErrorSummary, EstimatorDifference, EstimatorSummary, Interval

#: Figures of an estimator, in the tables of all estimators.
COLUMNS = (
    *("E_est mean", "median", "p90", "ratio", "wins"),
    *("E_lin mean", "median", "p90", "ratio", "wins", "PSNR"),
    *("shape mean", "median", "p90", "ratio", "wins"),
)


def rows_of(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a Markdown table."""
    lines = [f"| {' | '.join(row)} |" for row in (header, ["---"] * len(header), *rows)]
    return "\n".join(lines) + "\n"


def with_interval(figure: Interval) -> str:
    """Return a figure with its interval."""
    return f"{figure.value:.2f} [{figure.low:.2f}, {figure.high:.2f}]"


def percent(figure: Interval) -> str:
    """Return a fraction with its interval, in percent."""
    return f"{100 * figure.value:.0f} % [{100 * figure.low:.0f}, {100 * figure.high:.0f}]"


def bold(name: str, models: Sequence[str]) -> str:
    """Return a name, models in bold."""
    return f"**{name}**" if name in models else name


def summary_cells(summary: EstimatorSummary, *, is_reference: bool) -> list[str]:
    """Return the figures of one estimator, in the order of `COLUMNS`; gamma 2.2 is not compared with itself."""
    estimation, linearization, shape = (
        _error_cells(error, is_reference=is_reference) for _, error in summary.errors.items()
    )
    return [*estimation, *linearization, f"{summary.psnr.value:.1f} dB", *shape]


def _error_cells(error: ErrorSummary, *, is_reference: bool) -> list[str]:
    """Return mean, median, 90th percentile, ratio and win rate of one error."""
    compared = ["", ""] if is_reference else [with_interval(error.ratio), percent(error.win_rate)]
    return [with_interval(error.mean), f"{error.median.value:.2f}", f"{error.p90.value:.2f}", *compared]


def overall_table(estimators: dict[str, EstimatorSummary], models: Sequence[str], *, with_paper: bool) -> str:
    """Return the table of all estimators; the paper's figures follow the models."""
    rows = [
        [bold(name, models), *summary_cells(summary, is_reference=name == GAMMA)]
        for name, summary in estimators.items()
    ]
    if with_paper:
        rows[len(models) : len(models)] = _paper_rows()
    return rows_of(["", *COLUMNS], rows)


def _paper_rows() -> list[list[str]]:
    """Return the paper's overall figures, in the order of `COLUMNS`."""
    overall, gamma, ratio, wins = paper.OVERALL, paper.GAMMA, paper.RATIO, paper.WIN_RATE
    estimation = [f"{overall.estimation:.3f}", "", "", f"{ratio.estimation:.3f}", f"{100 * wins.estimation:.0f} %"]
    linearization = [f"{overall.linearization:.3f}", "", "", f"{ratio.linearization:.3f}"]
    rows = [
        ["*paper: CRF-net*", *estimation, *linearization, f"{100 * wins.linearization:.0f} %"],
        ["*paper: gamma 2.2*", f"{gamma.estimation}", *[""] * 4, f"{gamma.linearization}"],
    ]
    return [[*row, *[""] * (1 + len(COLUMNS) - len(row))] for row in rows]


def mean_cells(summary: EstimatorSummary) -> list[str]:
    """Return the means of the three errors with their intervals."""
    return [with_interval(error.mean) for _, error in summary.errors.items()]


def error_header(names: Iterable[str]) -> list[str]:
    """Return the heads of columns with the three errors of each estimator."""
    return [f"{name}: {error}" for name in names for error in ERROR_NAMES]


def differences_table(rows: Iterable[tuple[str, EstimatorDifference]]) -> list[str]:
    """Return the paired differences, if there are any, from (name of the row, or "", difference)."""
    cells = [
        [name, f"{row.first} - {row.second}", error, with_interval(comparison.difference), comparison.verdict]
        for name, row in rows
        for error, comparison in row.errors.items()
    ]
    if not cells:
        return []
    header = ["", "first - second", "error", "difference", "verdict"]
    if not any(row[0] for row in cells):
        header, cells = header[1:], [row[1:] for row in cells]
    return ["Paired differences:\n", rows_of(header, cells)]


def quoted(figures: paper.PaperFigures | None) -> str:
    """Return the paper's E_est and E_lin."""
    return f"{figures.estimation:.3f} / {figures.linearization:.3f}" if figures else ""
