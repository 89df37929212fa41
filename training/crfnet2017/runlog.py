"""The log of a run: speed, time spent waiting, log.csv and curves.png."""

from __future__ import annotations

import csv
import io
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import torch
from matplotlib.figure import Figure
from torch import Tensor

from crfnet_core.files import atomic_write, atomic_write_text

#: Columns of log.csv.
LOG_COLUMNS = ("step", "train_loss", "validation", "windows_per_s", "fraction_waiting")

#: Resolution of curves.png.
DOTS_PER_INCH = 110


class Clock:
    """Loss, speed, and time spent waiting for windows, since the last validation."""

    def __init__(self) -> None:
        self.saved()
        self.restart()

    def restart(self) -> None:
        """Start counting anew."""
        self._begun, self._waited, self._windows = time.perf_counter(), 0.0, 0
        self._losses: list[Tensor] = []

    def saved(self) -> None:
        """Count the time since the last checkpoint from now on."""
        self._saved = time.perf_counter()

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Count the time of the block as waiting."""
        begun = time.perf_counter()
        yield
        self._waited += time.perf_counter() - begun

    def add(self, loss: Tensor, windows: int) -> None:
        """Count a step."""
        self._losses.append(loss)
        self._windows += windows

    @property
    def loss(self) -> float:
        """The mean loss."""
        return float(torch.stack(self._losses).mean())

    @property
    def speed(self) -> float:
        """Windows per second, all processes together."""
        return self._windows / (time.perf_counter() - self._begun)

    @property
    def waiting_fraction(self) -> float:
        """The fraction of the time, in [0, 1], that was spent waiting for windows."""
        return self._waited / (time.perf_counter() - self._begun)

    @property
    def since_saved(self) -> float:
        """Seconds since the last checkpoint."""
        return time.perf_counter() - self._saved


def write_log(path: Path, rows: list[list[float]]) -> None:
    """Write log.csv, a line for every validation."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(LOG_COLUMNS)
    writer.writerows([int(step), *(f"{figure:.4f}" for figure in figures)] for step, *figures in rows)
    atomic_write_text(path, text.getvalue(), overwrite=True)


def draw_log(path: Path, rows: list[list[float]], *, classifies: bool) -> None:
    """Draw the training loss and the validation figure over the steps as a PNG."""
    steps, losses, figures = ([row[column] for row in rows] for column in range(3))
    figure = Figure(figsize=(8, 3.2), layout="constrained")
    names = ("training loss", "top-1 accuracy, validation" if classifies else "mean E_est, validation")
    for axes, name, values in zip(figure.subplots(1, 2), names, (losses, figures), strict=True):
        axes.plot(steps, values, marker=".")
        axes.set(title=name, xlabel="step")
        axes.grid(alpha=0.3)
    with atomic_write(path, overwrite=True) as temporary:
        figure.savefig(temporary, dpi=DOTS_PER_INCH, metadata={"Software": None})
