"""P4: real photographs of cameras whose responses were measured."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from crfnet_core.estimate import estimate_response
from crfnet_core.image_io import read_photo
from crfnet_core.network import ResponseNetwork
from crfnet_core.response import SAMPLES, ResponseCurve
from training.evaluation.baselines import GAMMA, OTHER_CAMERAS, constant_curves
from training.evaluation.cases import CaseFile, Row
from training.evaluation.measure import BASELINE_PARTY, baseline_rows, model_row
from training.evaluation.plan import PLAIN
from training.synthesis.camera import code_counts

#: Grades of the measured responses that count; the others are shown.
TRUSTED_GRADES = ("A", "B")

#: Samples of the curves that are kept to be drawn.
DRAWN_SAMPLES = 65


@dataclass(frozen=True)
class RealCase:
    """A row of DATA/real/cases.csv: the photograph, its camera, and how well the response was measured."""

    name: str
    camera: str
    grade: str
    photograph: Path
    measured: Path

    @property
    def is_trusted(self) -> bool:
        """Whether the measured response is good enough to count."""
        return self.grade in TRUSTED_GRADES

    def truth(self) -> ResponseCurve:
        """Return the measured response."""
        return ResponseCurve.from_samples(np.loadtxt(self.measured, delimiter=",", skiprows=1)[:, 1])


def real_cases(data: Path) -> list[RealCase]:
    """Return the real photographs of the folder `data`, in the order of their file."""
    folder = data / "real"
    with (folder / "cases.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [
        RealCase(row["id"], row["camera"], row["grade"], folder / row["input_file"], folder / "gt" / f"{row['id']}.csv")
        for row in rows
    ]


def measure_real(cases: list[RealCase], models: dict[str, Path], files: dict[str, CaseFile], known: np.ndarray) -> None:
    """Fill the case files with what is absent; a photograph is read once for all models.

    Parameters
    ----------
    cases : list of RealCase
        The photographs.
    models : dict
        Name -> folder.
    files : dict
        Name of a model, or "baselines" -> its cases.
    known : ndarray, shape (N, 1024)
        Responses for the constant baselines.
    """
    wanted = [case for case in cases if any(case.name not in file.rows for file in files.values())]
    if not wanted:
        return
    constants, truths = constant_curves(known), {case.name: case.truth() for case in cases}
    networks = {name: ResponseNetwork.load(folder) for name, folder in models.items()}
    for case in tqdm(wanted, desc="P4", unit="photograph"):
        photo, true = read_photo(case.photograph), truths[case.name]
        counts = code_counts(photo)
        others = {OTHER_CAMERAS: other_cameras(case, cases, truths)}
        for name, file in files.items():
            if case.name in file.rows:
                continue
            if name == BASELINE_PARTY:
                file.rows[case.name] = baseline_rows(true, counts, constants | others)
            else:
                estimate = estimate_response(photo, network=networks[name])
                drawn = {"curve": _drawn(estimate.curve.brightness), "band": [_drawn(end) for end in estimate.band]}
                file.rows[case.name] = {name: model_row(true, counts, estimate, PLAIN) | drawn}
            file.save()


def other_cameras(case: RealCase, cases: list[RealCase], truths: dict[str, ResponseCurve]) -> ResponseCurve:
    """Return the mean of the other cameras' responses, each camera once: what knows cameras but not the photograph."""
    curves: dict[str, list[np.ndarray]] = {}
    for other in cases:
        if other.camera != case.camera:
            curves.setdefault(other.camera, []).append(truths[other.name].brightness)
    if not curves:
        return ResponseCurve.gamma(2.2)
    return ResponseCurve.from_samples(np.mean([np.mean(group, axis=0) for group in curves.values()], axis=0))


def _drawn(samples: np.ndarray) -> list[float]:
    """Return a curve at `DRAWN_SAMPLES` uniform irradiances."""
    places = np.linspace(0, SAMPLES - 1, DRAWN_SAMPLES).round().astype(int)
    return [round(float(value), 4) for value in samples[places]]


def real_settings(cases: list[RealCase]) -> Row:
    """Return what the cases of P4 depend on."""
    return {"photographs": [case.name for case in cases], "reference": GAMMA}
