"""The PNGs of the report on real photographs: each beside its measured and its estimated response."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image, ImageOps

from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Uint8Array
from training.data.real.photographs import RealPhotograph
from training.evaluation.baselines import GAMMA
from training.evaluation.measure.figures import DRAWN_SAMPLES, PhotographFigures
from training.evaluation.report.plots import color, save
from training.evaluation.summaries.bodies import RealTable

#: Photographs in a row of the page.
PHOTOGRAPHS_IN_A_ROW = 3


def draw_real(path: Path, table: RealTable, model: str, title: str) -> None:
    """Draw every photograph of a table beside its measured response and a model's estimate with the band."""
    columns = PHOTOGRAPHS_IN_A_ROW
    rows = -(-len(table.photographs) // columns)
    figure = Figure(figsize=(7.2 * columns, 3.3 * rows), layout="constrained")
    grid = figure.subplots(rows, 2 * columns, squeeze=False, width_ratios=[1.15, 1] * columns)
    for axes in grid.ravel():
        axes.axis("off")
    for number, photograph in enumerate(table.photographs):
        left, right = grid[number // columns, 2 * (number % columns) :][:2]
        left.imshow(thumbnail(photograph.photograph))
        note = f"; caution: {photograph.caution}" if photograph.caution else ""
        left.set_title(f"{photograph.body}\n{photograph.name}, grade {photograph.grade}{note}", fontsize=9)
        _draw_responses(right, photograph, table.figures[model][number], table.figures[GAMMA][number])
    grid[0, 1].legend(fontsize=7, loc="lower right")
    figure.suptitle(title, fontsize=14)
    save(figure, path)


def _draw_responses(
    axes: Axes, photograph: RealPhotograph, figures: PhotographFigures, gamma: PhotographFigures
) -> None:
    """Draw the responses of one real photograph."""
    axes.axis("on")
    irradiance = np.linspace(0, 1, DRAWN_SAMPLES)
    if figures.band is not None and figures.curve is not None:
        axes.fill_between(irradiance, *figures.band, color=color(0), alpha=0.2, linewidth=0, label="90 % band")
        axes.plot(irradiance, figures.curve, color=color(0), label="estimate")
    axes.plot(irradiance, photograph.truth().forward(irradiance), color="black", label="measured")
    power = ResponseCurve.gamma(2.2).forward(irradiance)
    axes.plot(irradiance, power, color="gray", linestyle="--", label="gamma 2.2")
    first = f"E_est {figures.estimation:.2f}, expected {figures.uncertainty:.2f}; gamma {gamma.estimation:.2f}"
    axes.set_title(f"{first}\nshape {figures.shape:.2f} stops; gamma {gamma.shape:.2f}", fontsize=9)
    axes.set(xlim=(0, 1), ylim=(0, 1))
    axes.tick_params(labelsize=7)
    axes.grid(alpha=0.3)


def thumbnail(path: Path, *, side: int = 480) -> Uint8Array:
    """Return a small version of a photograph, uint8 (H, W, 3), upright; only to be looked at."""
    with Image.open(path) as image:
        image.draft("RGB", (side, side))
        upright = ImageOps.exif_transpose(image).convert("RGB")
    upright.thumbnail((side, side))
    return np.asarray(upright)
