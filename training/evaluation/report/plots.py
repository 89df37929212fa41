"""The PNGs of the report on simulated photographs; matplotlib without pyplot, so that nothing needs a screen."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crfnet_core.files import atomic_write
from crfnet_core.types import Float64Array
from training.evaluation.baselines import GAMMA, MEAN_CURVE, ORACLE_GAMMA
from training.evaluation.plan import CLEAN
from training.evaluation.report import paper
from training.evaluation.report.content import Reliability, StressReport
from training.evaluation.report.errors import PerError
from training.evaluation.summaries.error_table import ErrorColumns, ErrorTable
from training.evaluation.summaries.reliability import rejection_curve

#: Colors of the models, in their order; gray and black are for baselines and truth.
COLORS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown", "tab:pink", "tab:olive")
PAPER_COLOR = "black"

#: Line styles of the baselines in the distributions.
BASELINE_STYLES = {GAMMA: "--", MEAN_CURVE: ":", ORACLE_GAMMA: "-."}

DPI = 100

#: The labels of the errors' axes.
LABELS = PerError("E_est", "E_lin x 1e-2", "shape error, stops")

#: The quantile of gamma 2.2's errors at which the axes of distributions end.
SHOWN_QUANTILE = 0.97


def color(number: int) -> str:
    """Return the color of a model."""
    return COLORS[number % len(COLORS)]


def save(figure: Figure, path: Path) -> None:
    """Write a PNG that is the same for the same figures."""
    with atomic_write(path, overwrite=True) as temporary:
        figure.savefig(temporary, format="png", dpi=DPI, metadata={"Software": None})


def draw_distributions(path: Path, table: ErrorTable, models: Sequence[str], title: str) -> None:
    """Draw the fraction of photographs below each error, for the models and some baselines."""
    figure = Figure(figsize=(16, 4.8), layout="constrained")
    columns = {name: table.columns[name].errors for name in [*BASELINE_STYLES, *models]}
    for axes, (error, label) in zip(figure.subplots(1, 3), LABELS.items(), strict=True):
        for name, style in BASELINE_STYLES.items():
            _draw_cumulative(axes, columns[name][error], name, "gray", style)
        for number, name in enumerate(models):
            _draw_cumulative(axes, columns[name][error], name, color(number), "-")
        upper = np.quantile(columns[GAMMA][error], SHOWN_QUANTILE)
        axes.set(xlim=(0, upper), ylim=(0, 1), xlabel=label, ylabel="fraction of photographs below")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, loc="lower right", title="mean in brackets", title_fontsize=8)
    figure.suptitle(title)
    save(figure, path)


def _draw_cumulative(axes: Axes, values: Float64Array, name: str, color: str, style: str) -> None:
    """Draw one distribution; the legend has its mean."""
    heights = np.arange(1, len(values) + 1) / len(values)
    label = f"{name} ({values.mean():.2f})"
    axes.step(np.sort(values), heights, where="post", color=color, linestyle=style, label=label)


def draw_stress(path: Path, report: StressReport, models: Sequence[str]) -> None:
    """Draw the errors under every condition relative to the clean photographs, beside the paper's."""
    names = [name for name in report.conditions if name != CLEAN.name]
    if not names:
        return
    figure = Figure(figsize=(18, 0.36 * len(names) + 1.8), layout="constrained")
    heights = np.arange(len(names), dtype=np.float64)[::-1]
    for axes, (error, _) in zip(figure.subplots(1, 3, sharey=True), LABELS.items(), strict=True):
        for number, model in enumerate(models):
            _draw_stressed(axes, report, names, heights + 0.14 * number, model, error, color(number))
        quoted = [(height, _paper_ratio(name, error)) for height, name in zip(heights, names, strict=True)]
        known = np.array([(height, ratio) for height, ratio in quoted if ratio])
        if len(known):
            axes.plot(known[:, 1], known[:, 0] - 0.18, "x", color=PAPER_COLOR, label="paper")
        axes.axvline(1, color="gray", linewidth=1)
        axes.set_xscale("log")
        axes.set_xticks([0.5, 1, 2, 4, 8, 16], labels=["0.5", "1", "2", "4", "8", "16"])
        axes.minorticks_off()
        axes.set_yticks(heights, labels=names)
        axes.set_xlabel(f"{error}, times that of the clean photographs")
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    figure.suptitle(f"P3: stress, {report.photographs} photographs under every condition; bars are 95 % intervals")
    save(figure, path)


def _draw_stressed(
    axes: Axes, report: StressReport, names: list[str], heights: Float64Array, model: str, error: str, color: str
) -> None:
    """Draw one model's ratios to the clean photographs with their intervals."""
    rows = [report.conditions[name].estimators[model] for name in names]
    ratios = [row.to_clean[error].ratio for row in rows]
    value = np.array([ratio.value for ratio in ratios])
    spans = np.abs([value - [ratio.low for ratio in ratios], value - [ratio.high for ratio in ratios]])
    clean = report.conditions[CLEAN.name].estimators[model].summary
    label = f"{model} (clean: {clean.errors[error].mean.value:.2f})"
    axes.errorbar(value, heights, xerr=spans, fmt="o", markersize=4, color=color, capsize=2, label=label)


def _paper_ratio(condition: str, error: str) -> float | None:
    """Return the paper's error under a condition relative to its overall error; it has no shape error."""
    figures, overall = paper.STRESS.get(condition), paper.OVERALL
    if figures is None or error == "shape":
        return None
    if error == "E_est":
        return figures.estimation / overall.estimation
    return figures.linearization / overall.linearization


def draw_reliability(
    path: Path, columns: dict[str, dict[str, ErrorColumns]], report: dict[str, dict[str, Reliability]], *, error: str
) -> None:
    """Draw a mean error against its uncertainty, and the error of what is kept, for every protocol.

    Parameters
    ----------
    path : Path
        The PNG.
    columns : dict
        Protocol -> model -> its figures.
    report : dict
        Protocol -> model -> reliability.
    error : str
        "E_est" or "shape".
    """
    unit = LABELS[error]
    figure = Figure(figsize=(4.8 * len(columns), 8.4), layout="constrained")
    grid = figure.subplots(2, len(columns), squeeze=False)
    for (above, below), (protocol, models) in zip(grid.T, columns.items(), strict=True):
        rows = report[protocol]
        upper = 1.1 * max(max(part.uncertainty, part.error) for row in rows.values() for part in row.bins)
        above.plot([0, upper], [0, upper], color="gray", linewidth=1)
        for number, (model, part) in enumerate(models.items()):
            row = rows[model]
            _draw_bins(above, row, f"{model}, rank correlation {row.rank_correlation:.2f}", color(number))
            label = f"{model}, gain {row.gain:.2f}"
            _draw_rejection(below, part.errors[error], part.expected(error), label, color(number))
        count = next(iter(rows.values())).photographs
        above.set(title=f"{protocol}, {count} photographs", xlabel="mean uncertainty", ylabel=f"mean {unit}")
        above.set(xlim=(0, upper), ylim=(0, upper))
        below.set(xlabel="fraction rejected, most uncertain first", ylabel=f"mean {unit} of the others")
        below.set(xlim=(0, 1), ylim=(0, None))
        for axes in (above, below):
            axes.grid(alpha=0.3)
            axes.legend(fontsize=8)
    figure.suptitle(f"P5: does the uncertainty foretell the error? {unit}")
    save(figure, path)


def _draw_bins(axes: Axes, row: Reliability, label: str, color: str) -> None:
    """Draw mean error against mean uncertainty."""
    points = np.array([(part.uncertainty, part.error) for part in row.bins])
    axes.plot(points[:, 0], points[:, 1], "o-", color=color, markersize=4, label=label)


def _draw_rejection(axes: Axes, errors: Float64Array, uncertainties: Float64Array, label: str, color: str) -> None:
    """Draw the mean error of what is kept, with that of the oracle dotted."""
    fractions = np.arange(len(errors)) / len(errors)
    axes.plot(fractions, rejection_curve(errors, uncertainties), color=color, label=label)
    axes.plot(fractions, rejection_curve(errors, errors), color=color, linestyle=":", label="oracle")
    axes.axhline(errors.mean(), color=color, linewidth=0.8, linestyle="--", label="random")
