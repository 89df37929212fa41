"""The pictures of the report; matplotlib without pyplot, so that nothing needs a screen."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image, ImageOps

from crfnet_core.files import atomic_write
from crfnet_core.response import ResponseCurve
from training.evaluation import paper
from training.evaluation.baselines import GAMMA, ORACLE_GAMMA
from training.evaluation.calibration import rejection_curve
from training.evaluation.cases import CaseFile
from training.evaluation.real import DRAWN_SAMPLES, RealCase
from training.evaluation.tables import Sheet

#: Colours of the models, in their order; gray and black are for baselines and truth.
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown", "tab:pink", "tab:olive")
PAPER_COLOUR = "black"

DPI = 100


def colour(number: int) -> str:
    """Return the colour of a model."""
    return COLOURS[number % len(COLOURS)]


def save(figure: Figure, path: Path) -> None:
    """Write a PNG that is the same for the same figures."""
    with atomic_write(path, overwrite=True) as temporary:
        figure.savefig(temporary, format="png", dpi=DPI, metadata={"Software": None})


def draw_distribution(path: Path, sheet: Sheet, models: Sequence[str], title: str) -> None:
    """Draw the share of photographs below each error, for the models and some baselines."""
    figure = Figure(figsize=(12, 4.8), layout="constrained")
    baselines = {GAMMA: "--", "mean curve": ":", ORACLE_GAMMA: "-."}
    panels = (("estimation", 1.0, "E_est"), ("linearisation", 100.0, "E_lin x 1e-2"))
    for axes, (key, factor, label) in zip(figure.subplots(1, 2), panels, strict=True):
        for name, style in baselines.items():
            _cumulative(axes, factor * sheet.columns[name][key], name, "gray", style)
        for number, name in enumerate(models):
            _cumulative(axes, factor * sheet.columns[name][key], name, colour(number), "-")
        upper = factor * np.quantile(sheet.columns[GAMMA][key], 0.97)
        axes.set(xlim=(0, upper), ylim=(0, 1), xlabel=label, ylabel="share of photographs below")
        axes.grid(alpha=0.3)
    figure.axes[0].legend(fontsize=9, loc="lower right")
    figure.suptitle(title)
    save(figure, path)


def _cumulative(axes: Axes, values: np.ndarray, name: str, colour: str, style: str) -> None:
    """Draw one distribution; the legend has its mean."""
    heights = np.arange(1, len(values) + 1) / len(values)
    axes.step(
        np.sort(values), heights, where="post", color=colour, linestyle=style, label=f"{name} ({values.mean():.2f})"
    )


def draw_stress(path: Path, table: dict[str, Any], models: Sequence[str]) -> None:
    """Draw both errors under every condition relative to the clean photographs, beside the paper's."""
    names = [name for name in table["conditions"] if name != "clean"]
    if not names:
        return
    figure = Figure(figsize=(13, 0.36 * len(names) + 1.8), layout="constrained")
    places = np.arange(len(names))[::-1]
    for axes, error in zip(figure.subplots(1, 2, sharey=True), ("E_est", "E_lin"), strict=True):
        for number, model in enumerate(models):
            _stress_points(axes, table, names, places + 0.14 * number, model, error, colour(number))
        quoted = [(place, _paper_ratio(name, error)) for place, name in zip(places, names, strict=True)]
        known = np.array([(place, ratio) for place, ratio in quoted if ratio])
        if len(known):
            axes.plot(known[:, 1], known[:, 0] - 0.18, "x", color=PAPER_COLOUR, label="paper")
        axes.axvline(1, color="gray", linewidth=1)
        axes.set_xscale("log")
        axes.set_xticks([0.5, 1, 2, 4, 8, 16], labels=["0.5", "1", "2", "4", "8", "16"])
        axes.minorticks_off()
        axes.set_yticks(places, labels=names)
        axes.set_xlabel(f"{error}, times that of the clean photographs")
        axes.grid(alpha=0.3)
    figure.axes[0].legend(fontsize=9)
    figure.suptitle(f"P3: stress, {table['photographs']} photographs under every condition; bars are 95 % intervals")
    save(figure, path)


def _stress_points(
    axes: Axes, table: dict[str, Any], names: list[str], places: np.ndarray, model: str, error: str, colour: str
) -> None:
    """Draw one model's ratios to the clean photographs with their intervals."""
    found = [table["conditions"][name][model][f"{error} to clean"] for name in names]
    value, low, high = (np.array([row[key] for row in found]) for key in ("value", "low", "high"))
    spans = np.abs([value - low, high - value])
    mean = table["conditions"]["clean"][model][f"{error} mean"]["value"]
    label = f"{model} (clean: {mean:.2f})"
    axes.errorbar(value, places, xerr=spans, fmt="o", markersize=4, color=colour, capsize=2, label=label)


def _paper_ratio(name: str, error: str) -> float | None:
    """Return the paper's error under a condition relative to its overall error."""
    if name not in paper.STRESS:
        return None
    key = "estimation" if error == "E_est" else "linearisation"
    return float(getattr(paper.STRESS[name], key) / getattr(paper.OVERALL, key))


def draw_real(path: Path, cases: Sequence[RealCase], file: CaseFile, baselines: CaseFile, model: str) -> None:
    """Draw every real photograph, as its file is, beside its measured and its estimated response with the band."""
    columns = 3
    rows = -(-len(cases) // columns)
    figure = Figure(figsize=(7.2 * columns, 3.3 * rows), layout="constrained")
    grid = figure.subplots(rows, 2 * columns, squeeze=False, width_ratios=[1.15, 1] * columns)
    for axes in grid.ravel():
        axes.axis("off")
    for number, case in enumerate(cases):
        left, right = grid[number // columns, 2 * (number % columns) :][:2]
        left.imshow(thumbnail(case.photograph))
        left.set_title(f"{case.camera}\n{case.name}, grade {case.grade}", fontsize=9)
        _real_curves(right, case, file.rows[case.name][model], baselines.rows[case.name][GAMMA]["estimation"])
    grid[0, 1].legend(fontsize=7, loc="lower right")
    figure.suptitle(f"P4: real photographs, {model}", fontsize=14)
    save(figure, path)


def _real_curves(axes: Axes, case: RealCase, row: dict[str, Any], gamma: float) -> None:
    """Draw the responses of one real photograph."""
    axes.axis("on")
    irradiance = np.linspace(0, 1, DRAWN_SAMPLES)
    axes.fill_between(irradiance, *row["band"], color=colour(0), alpha=0.2, linewidth=0, label="90 % band")
    axes.plot(irradiance, row["curve"], color=colour(0), label="estimate")
    axes.plot(irradiance, case.truth().forward(irradiance), color="black", label="measured")
    power = ResponseCurve.gamma(2.2).forward(irradiance)
    axes.plot(irradiance, power, color="gray", linestyle="--", label="gamma 2.2")
    title = f"E_est {row['estimation']:.2f}, expected {row['uncertainty']:.2f}; gamma {gamma:.2f}"
    axes.set_title(title, fontsize=9)
    axes.set(xlim=(0, 1), ylim=(0, 1))
    axes.tick_params(labelsize=7)
    axes.grid(alpha=0.3)


def thumbnail(path: Path, *, side: int = 480) -> np.ndarray:
    """Return a small view of a photograph, uint8 (H, W, 3), upright; only to be looked at."""
    with Image.open(path) as image:
        image.draft("RGB", (side, side))
        upright = ImageOps.exif_transpose(image).convert("RGB")
    upright.thumbnail((side, side))
    return np.asarray(upright)


def draw_calibration(path: Path, sheets: dict[str, dict[str, dict[str, np.ndarray]]], table: dict[str, Any]) -> None:
    """Draw reliability and rejection for every protocol.

    Parameters
    ----------
    path : Path
        The PNG.
    sheets : dict
        Protocol -> model -> figure -> array (N,).
    table : dict
        The report of P5.
    """
    figure = Figure(figsize=(4.8 * len(sheets), 8.4), layout="constrained")
    grid = figure.subplots(2, len(sheets), squeeze=False)
    for column, (protocol, models) in enumerate(sheets.items()):
        upper = max(
            part[key] for row in table[protocol].values() for part in row["bins"] for key in ("uncertainty", "error")
        )
        grid[0, column].plot([0, 1.1 * upper], [0, 1.1 * upper], color="gray", linewidth=1)
        for number, (model, columns) in enumerate(models.items()):
            row = table[protocol][model]
            _reliability(
                grid[0, column], row, f"{model}, rank correlation {row['rank correlation']:.2f}", colour(number)
            )
            _rejection(grid[1, column], columns, f"{model}, gain {row['gain']:.2f}", colour(number))
        count = next(iter(table[protocol].values()))["photographs"]
        grid[0, column].set(title=f"{protocol}, {count} photographs", xlabel="mean uncertainty", ylabel="mean E_est")
        grid[0, column].set(xlim=(0, 1.1 * upper), ylim=(0, 1.1 * upper))
        grid[1, column].set(xlabel="share rejected, most uncertain first", ylabel="mean E_est of the others")
        grid[1, column].set(xlim=(0, 1), ylim=(0, None))
        for axes in grid[:, column]:
            axes.grid(alpha=0.3)
            axes.legend(fontsize=8)
    figure.suptitle("P5: does the uncertainty foretell the error?")
    save(figure, path)


def _reliability(axes: Axes, row: dict[str, Any], label: str, colour: str) -> None:
    """Draw mean error against mean uncertainty."""
    points = np.array([(part["uncertainty"], part["error"]) for part in row["bins"]])
    axes.plot(points[:, 0], points[:, 1], "o-", color=colour, markersize=4, label=label)


def _rejection(axes: Axes, columns: dict[str, np.ndarray], label: str, colour: str) -> None:
    """Draw the mean error of what is kept, with that of the oracle as dots."""
    errors, doubts = columns["estimation"], columns["uncertainty"]
    shares = np.arange(len(errors)) / len(errors)
    axes.plot(shares, rejection_curve(errors, doubts), color=colour, label=label)
    axes.plot(shares, rejection_curve(errors, errors), color=colour, linestyle=":", label="oracle")
    axes.axhline(errors.mean(), color=colour, linewidth=0.8, linestyle="--", label="random")
