"""Run the protocols one after the other, and write their report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from crfnet_core.posterior import ResponseBank
from crfnet_core.types import Float64Array
from training.data.real.photographs import RealPhotograph, real_photographs
from training.data.response_bank import make_bank
from training.evaluation.baselines import BASELINES
from training.evaluation.measure.case_files import CaseFile, code_digest
from training.evaluation.measure.pooled import measure_pooled
from training.evaluation.measure.real import measure_real
from training.evaluation.measure.simulated import measure_simulated
from training.evaluation.measure.unusual import measure_unusual, unusual_report
from training.evaluation.measure.verdict_files import VerdictFile
from training.evaluation.plan import TestPhotograph, clean_photographs, stress_photographs
from training.evaluation.report.content import (
    CleanReport,
    OtherKindReport,
    Reliability,
    Report,
    ReportSettings,
    StressReport,
)
from training.evaluation.report.document import read_report, write_report
from training.evaluation.report.markdown import report_text
from training.evaluation.report.plots import draw_distributions, draw_reliability, draw_stress
from training.evaluation.report.real.content import BOTH, RealReport, ways_of
from training.evaluation.report.real.plots import draw_real
from training.evaluation.report.unusual import UnusualReport
from training.evaluation.settings import Settings
from training.evaluation.summaries.bodies import RealTable, real_report
from training.evaluation.summaries.clean import clean_report, other_kind_report
from training.evaluation.summaries.error_table import ErrorColumns, ErrorTable
from training.evaluation.summaries.reliability import reliability
from training.evaluation.summaries.stress import stress_report
from training.evaluation.test_sets import TestSet

#: Error -> the file of its plot in P5.
RELIABILITY_FILES = {"E_est": "p5.png", "shape": "p5-shape.png"}

QUICK_NOTE = (
    "photographs of the bundled lights through formulas, to see that all works and that nothing got worse: not to"
    " be compared with the paper's figures"
)


@dataclass
class Evaluation:
    """One evaluation: call `run`.

    Parameters
    ----------
    settings : Settings
        What is measured.
    test_set : TestSet
        Scenes and responses.
    """

    settings: Settings
    test_set: TestSet
    _notes: list[str] = field(default_factory=list)
    _with_uncertainty: dict[str, dict[str, ErrorColumns]] = field(default_factory=dict)

    def run(self) -> Report:
        """Measure what is not kept yet, write report.json, report.md and the PNGs, and return the report.

        Raises
        ------
        CRFNetError
            If two models have one name, or P2 is asked of a model that knows its responses.
        """
        self._check()
        self.settings.out.mkdir(parents=True, exist_ok=True)
        steps = {"p0": self._p0, "p1": self._p1, "p2": self._p2, "p3": self._p3, "p4": self._p4, "p6": self._p6}
        parts: dict[str, Any] = {name: step() for name, step in steps.items() if name in self.settings.protocols}
        if self._with_uncertainty:
            parts["p5"] = self._p5()
        report = Report(
            settings=ReportSettings(self.settings.photographs, self.settings.seed, self.test_set.digest),
            models={model.name: model.measured for model in self.settings.models},
            notes=tuple([] if self.test_set.data else [QUICK_NOTE]) + tuple(self._notes),
            **parts,
        )
        write_report(self._path("report.json"), report)
        kept = read_report(self._path("report.json"))
        atomic_write_text(self._path("report.md"), report_text(kept), overwrite=True)
        return kept

    def _check(self) -> None:
        """Refuse models of one name, and for P2 models that know its responses."""
        names, held_out = self.settings.names, self.test_set.held_out
        if len(set(names)) < len(names):
            raise CRFNetError(f"models need different names, found {', '.join(names)}; copy one to another folder")
        for model in self.settings.models if "p2" in self.settings.protocols else ():
            if not held_out or not model.lacks(held_out):
                raise CRFNetError(
                    f"{model.name}: model.json does not say that it was trained without the held-out curves of"
                    " training/data/splits.json, so P2 would measure known curves; train one without them, or leave p2"
                    " out"
                )

    @cached_property
    def _exposures(self) -> Float64Array:
        """Return s_crf of every response, found once."""
        return self.test_set.exposures()

    @cached_property
    def _code(self) -> str:
        """Return the hash of the measuring code."""
        return code_digest()

    @property
    def _folders(self) -> dict[str, Path]:
        """Return name of a model -> its folder."""
        return {model.name: model.folder for model in self.settings.models}

    def _path(self, name: str) -> Path:
        """Return the path of a file of the report."""
        return self.settings.out / name

    def _files(self, protocol: str, depends_on: dict[str, Any]) -> dict[str, CaseFile]:
        """Return the case files of a protocol: those of the baselines and of every model."""
        estimators: dict[str, dict[str, str]] = {BASELINES: {}}
        for model in self.settings.models:
            estimators[model.name] = {"sha256": model.measured.sha256}
        files = {}
        for name, own in estimators.items():
            path = self._path(f"cases/{name}/{protocol}.json")
            files[name] = CaseFile.opened(path, depends_on | {"seed": self.settings.seed} | own, self._code)
            if files[name].is_of_other_code:
                relative = path.relative_to(self.settings.out)
                self._notes.append(f"{relative} was measured before the code changed; delete it to measure again")
        return files

    def _measured(self, protocol: str, photographs: Sequence[TestPhotograph]) -> dict[str, CaseFile]:
        """Return the case files of a protocol on simulated photographs, complete."""
        files = self._files(protocol, {"test_set": self.test_set.digest})
        measure_simulated(
            photographs,
            self.test_set,
            self._folders,
            files,
            exposures=lambda: self._exposures,
            bank=self._bank_of(protocol),
            workers=self.settings.workers,
            seed=self.settings.seed,
            title=protocol.upper(),
        )
        return files

    def _bank_of(self, protocol: str) -> ResponseBank | None:
        """Return the responses to choose from: for P2 those without the held-out curves, else the packaged ones."""
        if protocol != "p2" or self.test_set.data is None:
            return None
        return make_bank(self.test_set.data, without_held_out=True)

    def _clean(self, protocol: str, curves: Sequence[int]) -> tuple[list[TestPhotograph], ErrorTable]:
        """Return the photographs of P0 or P2 and their errors."""
        scenes = range(len(self.test_set.scenes))
        settings = self.settings
        photographs = clean_photographs(scenes, curves, count=settings.photographs, seed=settings.seed)
        return photographs, ErrorTable.of(photographs, self._measured(protocol, photographs), seed=settings.seed)

    @cached_property
    def _known(self) -> tuple[list[TestPhotograph], ErrorTable]:
        """Return the photographs of P0 and their errors, of which P1 is a part."""
        return self._clean("p0", range(len(self.test_set.curves)))

    def _p0(self) -> CleanReport:
        """Measure known responses."""
        return self._clean_report("P0", *self._known)

    def _p1(self) -> dict[str, OtherKindReport]:
        """Pick the photographs of P0 that show another kind of scene than training."""
        models = {model.name: model.measured for model in self.settings.models}
        return other_kind_report(*self._known, models, self.test_set)

    def _p2(self) -> CleanReport:
        """Measure unseen responses."""
        return self._clean_report("P2", *self._clean("p2", self.test_set.held_out))

    def _clean_report(self, name: str, photographs: list[TestPhotograph], table: ErrorTable) -> CleanReport:
        """Return the report of P0 or P2, and draw it."""
        models = self.settings.names
        draw_distributions(self._path(f"{name.lower()}.png"), table, models, f"{name}: {len(photographs)} photographs")
        self._with_uncertainty[name] = {model: table.columns[model] for model in models}
        return clean_report(photographs, table, models, self.test_set)

    def _p3(self) -> StressReport:
        """Measure stress."""
        settings = self.settings
        photographs = stress_photographs(
            range(len(self.test_set.scenes)),
            range(len(self.test_set.curves)),
            count=min(settings.stress_photographs, settings.photographs),
            seed=settings.seed,
            conditions=settings.conditions,
            queries=settings.queries,
        )
        report = stress_report(photographs, self._measured("p3", photographs), settings.names, seed=settings.seed)
        draw_stress(self._path("p3.png"), report, settings.names)
        return report

    def _p4(self) -> dict[str, RealReport]:
        """Measure real photographs, in each folder and together."""
        if self.test_set.data is None:
            raise CRFNetError("p4 needs real photographs; give --data instead of --quick")
        names = [name for model in self.settings.names for name in ways_of(model)]
        sets = real_photographs(self.test_set.data)
        tables = {name: self._real_table(name, photographs) for name, photographs in sets.items()}
        pooled = {name: self._pooled_table(name, table) for name, table in tables.items()}
        if len(tables) > 1:
            tables[BOTH], pooled[BOTH] = (RealTable.joined(list(parts.values())) for parts in (tables, pooled))
        for name, table in tables.items():
            self._with_uncertainty[f"P4 {name}"] = {model: table.trusted.columns(model) for model in names}
        return {
            name: real_report(table, pooled[name], names, seed=self.settings.seed) for name, table in tables.items()
        }

    def _real_table(self, name: str, photographs: Sequence[RealPhotograph]) -> RealTable:
        """Measure the real photographs of one folder, and draw them."""
        files = self._files(f"p4-{name}", {"photographs": [photograph.name for photograph in photographs]})
        assert self.test_set.data is not None
        measure_real(photographs, self._folders, files, self.test_set.curves, self.test_set.data, title=f"P4 {name}")
        table = RealTable.of(photographs, files)
        for model in self.settings.names:
            draw_real(self._path(f"p4-{name}-{model}.png"), table, model, f"P4, data/{name}: {model}")
        return table

    def _pooled_table(self, name: str, table: RealTable) -> RealTable:
        """Measure several photographs of each body of one folder, given together."""
        files = self._files(f"p4-{name}-pooled", {"photographs": [photograph.name for photograph in table.photographs]})
        del files[BASELINES]
        assert self.test_set.data is not None
        measure_pooled(table.photographs, self._folders, files, self.test_set.data, title=f"P4 {name}, pooled")
        return table.with_pooled(files)

    def _p5(self) -> dict[str, dict[str, dict[str, Reliability]]]:
        """Compare uncertainties with errors."""
        measured = self._with_uncertainty
        report: dict[str, dict[str, dict[str, Reliability]]] = {}
        for error, file in RELIABILITY_FILES.items():
            report[error] = {
                protocol: {
                    name: reliability(columns.errors[error], columns.expected(error), columns.coverage)
                    for name, columns in models.items()
                }
                for protocol, models in measured.items()
            }
            draw_reliability(self._path(file), measured, report[error], error=error)
        return report

    def _p6(self) -> dict[str, UnusualReport]:
        """Ask about pictures that no response explains."""
        scenes, settings = self.test_set.scenes, {"test_set": self.test_set.digest, "code": self._code}
        files = {
            model.name: VerdictFile.opened(
                self._path(f"cases/{model.name}/p6.json"), settings | {"sha256": model.measured.sha256}
            )
            for model in self.settings.models
        }
        measure_unusual(scenes, self._folders, files)
        return {name: unusual_report(scenes, file) for name, file in files.items()}
