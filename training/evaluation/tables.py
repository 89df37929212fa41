"""Sum up the cases of the protocols on synthetic photographs, with confidence intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import combinations
from typing import Any

import numpy as np

from crfnet_core.metrics import peak_signal_to_noise
from training.evaluation.baselines import GAMMA
from training.evaluation.bootstrap import Figure, Resampling
from training.evaluation.cases import CaseFile
from training.evaluation.material import Material
from training.evaluation.measure import BASELINE_PARTY
from training.evaluation.plan import CLEAN, PLAIN, Shot

Columns = dict[str, dict[str, np.ndarray]]
Table = dict[str, Any]

#: The two errors: name in the report -> (column, factor).
ERRORS = {"E_est": ("estimation", 1.0), "E_lin": ("linearisation", 100.0)}

#: The kinds of scene.
KINDS = ("panorama", "photograph")

#: Decimals of the figures in the report.
DECIMALS = 4


@dataclass(frozen=True, eq=False)
class Sheet:
    """The cases of one set of photographs: figures of every estimator, aligned, and how they are resampled.

    Parameters
    ----------
    shots : tuple of Shot
        The photographs.
    columns : dict
        Estimator -> figure -> array (N,); the estimators are the models and the baselines.
    resampling : Resampling
        Weights of the N photographs.
    """

    shots: tuple[Shot, ...]
    columns: Columns
    resampling: Resampling

    @classmethod
    def of(cls, shots: Sequence[Shot], files: dict[str, CaseFile], *, seed: int) -> Sheet:
        """Return the cases of photographs in the plain trial."""
        labels, columns = [shot.label for shot in shots], {}
        for file in files.values():
            columns |= file.columns(labels)
        scenes, curves = np.array([(shot.scene, shot.curve) for shot in shots]).T
        return cls(tuple(shots), columns, Resampling.of(scenes, curves, seed=seed))

    def subset(self, chosen: np.ndarray) -> Sheet:
        """Return the cases at which the mask (N,) is true."""
        columns = {
            name: {key: values[chosen] for key, values in figures.items()} for name, figures in self.columns.items()
        }
        shots = tuple(shot for shot, wanted in zip(self.shots, chosen, strict=True) if wanted)
        return Sheet(shots, columns, self.resampling.subset(chosen))


def written(figure: Figure) -> dict[str, float]:
    """Return a figure for report.json."""
    return {key: round(value, DECIMALS) for key, value in asdict(figure).items()}


def summary(columns: dict[str, np.ndarray], gamma: dict[str, np.ndarray], resampling: Resampling) -> Table:
    """Return the figures of one estimator: both errors, their ratios to gamma 2.2 and win rates; E_lin is x 1e-2."""
    figures = {}
    for name, (key, factor) in ERRORS.items():
        values, reference = factor * columns[key], factor * gamma[key]
        figures[f"{name} mean"] = resampling.mean(values)
        if name == "E_est":
            figures["E_est median"] = resampling.quantile(values, 0.5)
            figures["E_est p90"] = resampling.quantile(values, 0.9)
        else:
            figures["PSNR of the mean"] = _psnr(figures["E_lin mean"])
        figures[f"{name} ratio"] = resampling.ratio(values, reference)
        figures[f"{name} win rate"] = resampling.mean((values < reference).astype(np.float64))
    return {name: written(figure) for name, figure in figures.items()}


def _psnr(mean: Figure) -> Figure:
    """Return the PSNR in decibels of a mean E_lin, x 1e-2."""
    value, low, high = (peak_signal_to_noise(max(end, 1e-9) / 100) for end in (mean.value, mean.high, mean.low))
    return Figure(value, low, high)


def differences(sheet: Sheet, models: Sequence[str]) -> list[Table]:
    """Return, for every two models, the paired differences of their errors and who is better, or a tie."""
    rows = []
    for first, second in combinations(models, 2):
        for name, (key, factor) in ERRORS.items():
            pair = [factor * sheet.columns[model][key] for model in (first, second)]
            found = sheet.resampling.difference(*pair)
            winner = first if found.value < 0 else second
            verdict = "tie" if found.is_zero else f"{winner} is better"
            rows.append({"models": [first, second], "error": name, "difference": written(found), "verdict": verdict})
    return rows


def overall(sheet: Sheet, models: Sequence[str]) -> Table:
    """Return the figures of every model and baseline, and the differences between models."""
    gamma = sheet.columns[GAMMA]
    baselines = [name for name in sheet.columns if name not in models]
    return {
        "photographs": len(sheet.shots),
        "estimators": {name: summary(sheet.columns[name], gamma, sheet.resampling) for name in [*models, *baselines]},
        "differences": differences(sheet, models),
    }


def grouped(sheet: Sheet, models: Sequence[str], groups: dict[str, np.ndarray]) -> Table:
    """Return the figures of the models and of gamma 2.2 for groups, given as name -> mask (N,)."""
    table = {}
    for name, chosen in groups.items():
        part = sheet.subset(chosen)
        estimators = {
            estimator: summary(part.columns[estimator], part.columns[GAMMA], part.resampling)
            for estimator in [*models, GAMMA]
        }
        table[name] = {"photographs": len(part.shots), "estimators": estimators}
    return table


def plain_table(sheet: Sheet, models: Sequence[str], material: Material) -> Table:
    """Return the report of P0 or P2: overall, by exposure and by scene."""
    factors = np.array([shot.condition.factor for shot in sheet.shots])
    scenes = np.array([shot.scene for shot in sheet.shots])
    exposures = {f"{factor:g}": factors == factor for factor in np.unique(factors)}
    names = {material.scenes[k].name: scenes == k for k in np.unique(scenes)}
    by_scene = grouped(sheet, models, names)
    for scene in material.scenes:
        if scene.name in by_scene:
            by_scene[scene.name]["kind"] = scene.kind
    kinds = np.array([material.scenes[k].kind for k in scenes])
    return {
        **overall(sheet, models),
        "curves": len({shot.curve for shot in sheet.shots}),
        "exposures": grouped(sheet, models, exposures),
        "kinds": grouped(sheet, models, {kind: kinds == kind for kind in np.unique(kinds)}),
        "scenes": by_scene,
    }


def other_kind_table(sheet: Sheet, training: dict[str, dict[str, Any]], material: Material) -> Table:
    """Return the report of P1: for every model, the P0 photographs of scenes of a kind that it was not trained on.

    A model that saw both kinds, or does not say, gets the perspective photographs, which is not the strict protocol.

    Parameters
    ----------
    sheet : Sheet
        P0.
    training : dict
        Name of a model -> the `training` entry of its model.json.
    material : Material
        For the kinds of the scenes.
    """
    kinds, table = np.array([material.scenes[shot.scene].kind for shot in sheet.shots]), {}
    for model, entry in training.items():
        unseen = [kind for kind in KINDS if kind not in entry.get("scene_kinds", KINDS)]
        kind = unseen[0] if unseen else "photograph"
        row: Table = {"kind": kind, "is_strict": bool(unseen), "photographs": int((kinds == kind).sum())}
        if row["photographs"]:
            part = sheet.subset(kinds == kind)
            row["scenes"] = len({shot.scene for shot in part.shots})
            row["estimators"] = {
                name: summary(part.columns[name], part.columns[GAMMA], part.resampling) for name in (model, GAMMA)
            }
        table[model] = row
    return table


def stress_table(shots: Sequence[Shot], files: dict[str, CaseFile], models: Sequence[str], *, seed: int) -> Table:
    """Return the report of P3: every condition against the clean photographs, every trial against the plain one."""
    conditions = list(dict.fromkeys(shot.condition for shot in shots if shot.trial == PLAIN))
    sheets = {
        condition.name: Sheet.of(
            [shot for shot in shots if shot.condition == condition and shot.trial == PLAIN], files, seed=seed
        )
        for condition in conditions
    }
    clean = sheets[CLEAN.name]
    own = {name: file for name, file in files.items() if name != BASELINE_PARTY}
    trials = list(dict.fromkeys(shot.trial for shot in shots if shot.trial != PLAIN))
    asked = {trial.name: Sheet.of([shot for shot in shots if shot.trial == trial], own, seed=seed) for trial in trials}
    return {
        "photographs": len(clean.shots),
        "conditions": {
            name: _against(sheet, clean, sheet.columns[GAMMA], [*models, GAMMA]) for name, sheet in sheets.items()
        },
        "trials": {name: _against(sheet, clean, clean.columns[GAMMA], models) for name, sheet in asked.items()},
        "partial": {model: _partial(clean, model) for model in [*models, GAMMA]},
        "differences": {name: differences(sheet, models) for name, sheet in (sheets | asked).items()},
    }


def _against(sheet: Sheet, clean: Sheet, gamma: dict[str, np.ndarray], estimators: Sequence[str]) -> Table:
    """Return the figures under one condition or trial, and both errors against the clean, plain ones."""
    table = {}
    for name in estimators:
        row = summary(sheet.columns[name], gamma, sheet.resampling)
        for error, (key, factor) in ERRORS.items():
            values, reference = factor * sheet.columns[name][key], factor * clean.columns[name][key]
            found = sheet.resampling.difference(values, reference)
            row[f"{error} to clean"] = written(sheet.resampling.ratio(values, reference))
            row[f"{error} difference"] = written(found)
            row[f"{error} verdict"] = "tie" if found.is_zero else "worse" if found.value > 0 else "better"
        table[name] = row
    return table


def _partial(clean: Sheet, estimator: str) -> Table:
    """Return E_est over the lower part of the irradiance, and over all of it (CRF-net paper, Fig. 9)."""
    columns, resampling = clean.columns[estimator], clean.resampling
    return {
        "E_est, E <= 0.8": written(resampling.mean(columns["partial"])),
        "E_est": written(resampling.mean(columns["estimation"])),
        "ratio": written(resampling.ratio(columns["partial"], columns["estimation"])),
    }
