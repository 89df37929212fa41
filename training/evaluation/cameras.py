"""Sum up P4: the mean of each camera, and the mean over cameras."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from training.evaluation.baselines import GAMMA
from training.evaluation.bootstrap import Resampling
from training.evaluation.cases import CaseFile
from training.evaluation.real import RealCase
from training.evaluation.tables import Sheet, differences, summary

Table = dict[str, Any]


def real_table(cases: Sequence[RealCase], files: dict[str, CaseFile], models: Sequence[str], *, seed: int) -> Table:
    """Return the report of P4: every camera and photograph, and the means over cameras of grade A and B, and over all.

    Cameras, not photographs, are resampled and count equally.
    """
    columns: dict[str, dict[str, np.ndarray]] = {}
    for file in files.values():
        columns |= file.columns([case.name for case in cases])
    trusted = np.array([case.is_trusted for case in cases])
    everywhere = np.ones(len(cases), dtype=bool)
    return {
        "photographs": len(cases),
        "trusted": _means(cases, columns, models, trusted, seed),
        "all": _means(cases, columns, models, everywhere, seed),
        "cameras": _by_camera(cases, columns, models),
        "cases": [_one(case, columns, models, k) for k, case in enumerate(cases)],
    }


def _means(
    cases: Sequence[RealCase],
    columns: dict[str, dict[str, np.ndarray]],
    models: Sequence[str],
    chosen: np.ndarray,
    seed: int,
) -> Table:
    """Return the means over the cameras of the chosen photographs."""
    cameras = np.array([case.camera for case in cases])[chosen]
    _, places = np.unique(cameras, return_inverse=True)
    shares = 1 / np.bincount(places)[places]
    resampling = Resampling.of(cameras, np.zeros(len(cameras), dtype=int), seed=seed).scaled(shares)
    part = {
        name: {key: values[chosen] for key, values in figures.items() if values.ndim == 1}
        for name, figures in columns.items()
    }
    sheet = Sheet((), part, resampling)
    names = [*models, *(name for name in part if name not in models)]
    return {
        "cameras": int(places.max()) + 1,
        "photographs": len(cameras),
        "estimators": {name: summary(part[name], part[GAMMA], resampling) for name in names},
        "differences": differences(sheet, models),
    }


def _by_camera(cases: Sequence[RealCase], columns: dict[str, dict[str, np.ndarray]], models: Sequence[str]) -> Table:
    """Return the mean errors of every camera."""
    table = {}
    for camera in dict.fromkeys(case.camera for case in cases):
        chosen = np.array([case.camera == camera for case in cases])
        row: Table = {
            "photographs": int(chosen.sum()),
            "grades": "".join(sorted({case.grade for case in cases if case.camera == camera})),
            "estimators": {},
        }
        for name in [*models, GAMMA]:
            figures = {"E_est": columns[name]["estimation"], "E_lin": 100 * columns[name]["linearisation"]}
            if name in models:
                figures["uncertainty"] = columns[name]["uncertainty"]
            row["estimators"][name] = {key: round(float(part[chosen].mean()), 4) for key, part in figures.items()}
        table[camera] = row
    return table


def _one(case: RealCase, columns: dict[str, dict[str, np.ndarray]], models: Sequence[str], number: int) -> Table:
    """Return the errors on one photograph."""
    figures: Table = {GAMMA: {"E_est": float(columns[GAMMA]["estimation"][number])}}
    for name in models:
        part = columns[name]
        figures[name] = {
            "E_est": float(part["estimation"][number]),
            "E_lin": round(100 * float(part["linearisation"][number]), 4),
            "uncertainty": float(part["uncertainty"][number]),
            "coverage": float(part["coverage"][number]),
        }
    return {"photograph": case.name, "camera": case.camera, "grade": case.grade, "estimators": figures}
