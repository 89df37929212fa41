"""Run the protocols one after the other and gather their report."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from crfnet_core.network import MODELS, ModelConfig, model_folder
from training.evaluation.calibration import calibration
from training.evaluation.cameras import real_table
from training.evaluation.cases import CaseFile, code_digest
from training.evaluation.figures import draw_calibration, draw_distribution, draw_real, draw_stress
from training.evaluation.markdown import report_text
from training.evaluation.material import Material
from training.evaluation.measure import BASELINE_PARTY, measure
from training.evaluation.plan import (
    CONDITIONS,
    STRESS_PHOTOGRAPHS,
    TRIALS,
    Condition,
    Shot,
    Trial,
    plain_shots,
    stress_shots,
)
from training.evaluation.real import measure_real, real_cases, real_settings
from training.evaluation.tables import Sheet, other_kind_table, plain_table, stress_table

PROTOCOLS = ("p0", "p1", "p2", "p3", "p4")

#: Photographs of P0: every curve with every test scene.
ALL_PHOTOGRAPHS = 4020

QUICK_NOTE = (
    "photographs of the bundled lights through formulas, to see that all works and that nothing got worse: not to"
    " be compared with the paper's figures"
)

Table = dict[str, Any]


@dataclass(frozen=True)
class Model:
    """A model folder under the name that it has in the report; `calibration` is a hash, as `sha256` is of the graph."""

    name: str
    folder: Path
    sha256: str
    calibration: str
    training: dict[str, Any]

    @classmethod
    def found(cls, wanted: str) -> Model:
        """Return the model of this name in crfnet_core/models, or in the folder of this path.

        Raises
        ------
        CRFNetError
            If there is neither, or the folder is no model.
        """
        folder = model_folder(wanted)
        if not (folder / "model.json").is_file():
            names = ", ".join(sorted(entry.parent.name for entry in MODELS.glob("*/model.json")))
            raise CRFNetError(f"{wanted}: is no model folder; give its path, or one of {names}")
        config = ModelConfig.read(folder / "model.json")
        calibration = hashlib.sha256(repr(config.uncertainty_model).encode()).hexdigest()[:16]
        return cls(folder.resolve().name, folder, config.sha256, calibration, config.training)

    def lacks(self, held_out: Sequence[int]) -> bool:
        """Return whether model.json says that these curves were kept out of its training."""
        return set(held_out) <= set(self.training.get("held_out_curves") or ())


@dataclass(frozen=True)
class Settings:
    """What is measured.

    Parameters
    ----------
    out : Path
        The folder of the report.
    models : tuple of Model
        Measured on the same photographs.
    protocols : tuple of str
        Of `PROTOCOLS`.
    photographs : int
        At most, of P0 and P2; P3 has at most `stress_photographs` and no more than this.
    workers : int
        Processes; with 1, this one.
    seed : int
        Of the choice of photographs, of dither, noise and bootstrap.
    stress_photographs : int
        See `photographs`.
    conditions, trials : tuple
        Of P3.
    """

    out: Path
    models: tuple[Model, ...]
    protocols: tuple[str, ...] = PROTOCOLS
    photographs: int = ALL_PHOTOGRAPHS
    workers: int = 2
    seed: int = 2017
    stress_photographs: int = STRESS_PHOTOGRAPHS
    conditions: tuple[Condition, ...] = CONDITIONS
    trials: tuple[Trial, ...] = TRIALS


@dataclass
class Evaluation:
    """One evaluation: call `run`.

    Parameters
    ----------
    settings : Settings
        What is measured.
    material : Material
        Scenes and responses.
    """

    settings: Settings
    material: Material
    report: Table = field(default_factory=dict)
    _calibrated: dict[str, dict[str, dict[str, np.ndarray]]] = field(default_factory=dict)

    @cached_property
    def _exposures(self) -> np.ndarray:
        """Return s_crf of every curve, found once."""
        return self.material.exposures()

    @cached_property
    def _code(self) -> str:
        """Return the hash of the measuring code."""
        return code_digest()

    @property
    def _names(self) -> list[str]:
        return [model.name for model in self.settings.models]

    def run(self) -> Table:
        """Measure what is not kept yet, write report.json, report.md and the PNGs, and return the report.

        Raises
        ------
        CRFNetError
            If two models have one name, or P2 is asked of a model that knows its curves.
        """
        if len(set(self._names)) < len(self._names):
            raise CRFNetError(
                f"models need different names, found {', '.join(self._names)}; copy one to another folder"
            )
        wanted = self.settings.protocols
        if "p2" in wanted:
            self._check_held_out()
        self.settings.out.mkdir(parents=True, exist_ok=True)
        self.report = self._head()
        steps: dict[str, Callable[[], None]] = {"p2": self._p2, "p3": self._p3, "p4": self._p4}
        if "p0" in wanted or "p1" in wanted:
            self._p0_and_p1()
        for name, step in steps.items():
            if name in wanted:
                step()
        if self._calibrated:
            self._p5()
        self._write()
        return self.report

    def _check_held_out(self) -> None:
        """Refuse models that know the curves of P2."""
        for model in self.settings.models:
            if not self.material.held_out or not model.lacks(self.material.held_out):
                raise CRFNetError(
                    f"{model.name}: model.json does not say that it was trained without the held-out curves of"
                    " training/data/splits.json, so P2 would measure known curves; train one without them, or leave p2 out"
                )

    def _head(self) -> Table:
        """Return what the report begins with."""
        settings = self.settings
        models = {model.name: {"sha256": model.sha256, "training": model.training} for model in settings.models}
        shown = {"photographs": settings.photographs, "seed": settings.seed, "material": self.material.digest}
        return {"settings": shown, "models": models, "notes": [] if self.material.data else [QUICK_NOTE]}

    def _files(self, protocol: str, depends_on: Table) -> dict[str, CaseFile]:
        """Return the case files of a protocol: those of the baselines and of every model."""
        files = {}
        parties: dict[str, Table] = {BASELINE_PARTY: {}}
        parties |= {m.name: {"sha256": m.sha256, "calibration": m.calibration} for m in self.settings.models}
        for name, own in parties.items():
            settings = depends_on | {"seed": self.settings.seed} | own
            path = self.settings.out / "cases" / name / f"{protocol}.json"
            files[name] = CaseFile.opened(path, settings, self._code)
            if files[name].is_of_other_code:
                self.report["notes"].append(
                    f"cases/{name}/{protocol}.json was measured before the code changed; delete it to measure again"
                )
        return files

    def _measured(self, protocol: str, shots: Sequence[Shot]) -> dict[str, CaseFile]:
        """Return the case files of a protocol, complete."""
        files = self._files(protocol, {"material": self.material.digest})
        measure(
            shots,
            self.material,
            {model.name: model.folder for model in self.settings.models},
            files,
            exposures=lambda: self._exposures,
            workers=self.settings.workers,
            seed=self.settings.seed,
            title=protocol.upper(),
        )
        return files

    def _plain_sheet(self, protocol: str, curves: Sequence[int]) -> Sheet:
        """Return the cases of P0 or P2."""
        scenes = range(len(self.material.scenes))
        shots = plain_shots(scenes, curves, count=self.settings.photographs, seed=self.settings.seed)
        return Sheet.of(shots, self._measured(protocol, shots), seed=self.settings.seed)

    def _p0_and_p1(self) -> None:
        """Measure P0; P1 is some of its photographs."""
        sheet = self._plain_sheet("p0", range(len(self.material.curves)))
        if "p0" in self.settings.protocols:
            self.report["P0"] = plain_table(sheet, self._names, self.material)
            draw_distribution(self._path("p0.png"), sheet, self._names, f"P0: {len(sheet.shots)} photographs")
            self._keep_for_calibration("P0", sheet.columns)
        if "p1" in self.settings.protocols:
            training = {model.name: model.training for model in self.settings.models}
            self.report["P1"] = other_kind_table(sheet, training, self.material)

    def _p2(self) -> None:
        """Measure P2."""
        sheet = self._plain_sheet("p2", self.material.held_out)
        self.report["P2"] = plain_table(sheet, self._names, self.material)
        draw_distribution(self._path("p2.png"), sheet, self._names, f"P2: {len(sheet.shots)} photographs")
        self._keep_for_calibration("P2", sheet.columns)

    def _p3(self) -> None:
        """Measure P3."""
        settings = self.settings
        shots = stress_shots(
            range(len(self.material.scenes)),
            range(len(self.material.curves)),
            count=min(settings.stress_photographs, settings.photographs),
            seed=settings.seed,
            conditions=settings.conditions,
            trials=settings.trials,
        )
        files = self._measured("p3", shots)
        self.report["P3"] = stress_table(shots, files, self._names, seed=settings.seed)
        draw_stress(self._path("p3.png"), self.report["P3"], self._names)

    def _p4(self) -> None:
        """Measure P4."""
        data, models = self.material.data, {model.name: model.folder for model in self.settings.models}
        if data is None:
            raise CRFNetError("p4 needs real photographs; give --data instead of --quick")
        cases = real_cases(data)
        files = self._files("p4", real_settings(cases))
        measure_real(cases, models, files, self.material.curves)
        self.report["P4"] = real_table(cases, files, self._names, seed=self.settings.seed)
        for name in self._names:
            draw_real(self._path(f"p4-{name}.png"), cases, files[name], files[BASELINE_PARTY], name)
        trusted = [case.name for case in cases if case.is_trusted]
        self._keep_for_calibration("P4", {name: files[name].columns(trusted)[name] for name in self._names})

    def _keep_for_calibration(self, protocol: str, columns: dict[str, dict[str, np.ndarray]]) -> None:
        """Remember the cases of a protocol for P5."""
        self._calibrated[protocol] = {name: columns[name] for name in self._names}

    def _p5(self) -> None:
        """Compare uncertainties with errors."""
        self.report["P5"] = {
            protocol: {
                name: calibration(part["estimation"], part["uncertainty"], part["coverage"])
                for name, part in models.items()
            }
            for protocol, models in self._calibrated.items()
        }
        draw_calibration(self._path("p5.png"), self._calibrated, self.report["P5"])

    def _path(self, name: str) -> Path:
        """Return the path of a file of the report."""
        return self.settings.out / name

    def _write(self) -> None:
        """Write report.json and report.md."""
        atomic_write_text(self._path("report.json"), json.dumps(self.report, indent=1) + "\n", overwrite=True)
        atomic_write_text(self._path("report.md"), report_text(self.report), overwrite=True)
