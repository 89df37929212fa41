"""Run protocols one after the other: measure what the table lacks, and sum it up."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from training.data.real.photographs import RealPhotograph, real_photographs
from training.data.response_bank import make_bank
from training.evaluation.baselines import GAMMA
from training.evaluation.measure import unusual
from training.evaluation.measure.real import POOLED, measure_pooled, measure_real, pooled_groups, ways_of
from training.evaluation.measure.simulated import PAPER, WAYS, Job, measure_simulated
from training.evaluation.measure.table import TABLE_FILE, Cases, Table, code_digest
from training.evaluation.models import Model
from training.evaluation.plan import (
    CLEAN,
    CONDITIONS,
    STRESS_PHOTOGRAPHS,
    Condition,
    TestPhotograph,
    clean_photographs,
    stress_photographs,
)
from training.evaluation.report import sums
from training.evaluation.report.document import Report, ReportRow, write_report
from training.evaluation.report.markdown import report_text
from training.evaluation.report.summary import rounded
from training.evaluation.test_sets import TestSet
from training.synthesis.unusual import UnusualKind

#: The protocols. P5, the reliability of the uncertainty, comes with P0, P2 and P4.
PROTOCOLS = ("p0", "p2", "paper", "p4", "p6")

#: Photographs of P0: every response with every test scene.
ALL_PHOTOGRAPHS = 4020

#: The name of the real photographs of both folders together.
BOTH = "P4 both"

QUICK_NOTE = "bundled lights and formulas instead of the data: not to be compared with the paper's figures"

CODE_NOTE = f"some photographs were measured before the code changed; delete {TABLE_FILE} to measure them again"


@dataclass(frozen=True)
class Settings:
    """The scope of an evaluation.

    out: the folder of the table and the report
    models: all are measured on the same photographs
    protocols: some of `PROTOCOLS`
    photographs: the most photographs in P0 and P2
    workers: processes; 1 measures in this one
    seed: of the choice of photographs, of dither, noise and bootstrap
    stress_photographs: the most photographs in "paper" under each condition; also limited by `photographs`
    conditions: of "paper"
    """

    out: Path
    models: tuple[Model, ...]
    protocols: tuple[str, ...] = PROTOCOLS
    photographs: int = ALL_PHOTOGRAPHS
    workers: int = 2
    seed: int = 2017
    stress_photographs: int = STRESS_PHOTOGRAPHS
    conditions: tuple[Condition, ...] = CONDITIONS


@dataclass
class Evaluation:
    """One evaluation: call `run`."""

    settings: Settings
    test_set: TestSet
    _with_uncertainty: dict[str, tuple[Cases, Sequence[str]]] = field(default_factory=dict)

    def run(self) -> Report:
        """Measure what the table lacks, write report.json and report.md, and return the report.

        Raise CRFNetError if two models have one name, or P2 is asked of a model that knows its responses.
        """
        self._check()
        every, held_out = range(len(self.test_set.curves)), self.test_set.held_out
        steps = {
            "p0": lambda: self._clean("P0", every),
            "p2": lambda: self._clean("P2", held_out),
            "paper": self._paper,
            "p4": self._real,
            "p6": self._unusual,
        }
        rows = [row for name, step in steps.items() if name in self.settings.protocols for row in step()]
        rows += sums.reliability_rows(self._with_uncertainty)
        report = Report(
            settings={"photographs": self.settings.photographs} | self._depends_on,
            models={model.name: model.sha256 for model in self.settings.models},
            notes=[QUICK_NOTE] * (self.test_set.data is None) + [CODE_NOTE] * self._table.is_of_other_code,
            rows=[rounded(row) for row in rows],
        )
        write_report(self.settings.out / "report.json", report)
        atomic_write_text(self.settings.out / "report.md", report_text(report), overwrite=True)
        return report

    def _check(self) -> None:
        """Refuse models of one name, and for P2 models that know its responses."""
        names, held_out = [model.name for model in self.settings.models], self.test_set.held_out
        if len(set(names)) < len(names):
            raise CRFNetError(f"models need different names, found {', '.join(names)}; rename the folder of one")
        for model in self.settings.models if "p2" in self.settings.protocols else ():
            if not held_out or not model.lacks(held_out):
                raise CRFNetError(
                    f"{model.name}: model.json does not list the held-out curves of training/data/splits.json; train a"
                    " model without them, or leave p2 out"
                )

    @property
    def _depends_on(self) -> dict[str, object]:
        """The settings that every row of the table depends on."""
        return {"seed": self.settings.seed, "test_set": self.test_set.digest}

    @cached_property
    def _table(self) -> Table:
        """The table on disk."""
        return Table(self.settings.out / TABLE_FILE, self._depends_on, code_digest())

    @cached_property
    def _models(self) -> dict[str, str]:
        """Name of a model -> its key in the table."""
        return {model.name: model.key for model in self.settings.models}

    @cached_property
    def _ways(self) -> dict[str, str]:
        """Name of a way in which P4 asks a model -> the model's key in the table."""
        return {way: key for name, key in self._models.items() for way in ways_of(name)}

    def _cases(self, protocol: str, photographs: Sequence[str], models: dict[str, str]) -> Cases:
        """Return the rows of models and of all baselines on these photographs."""
        baselines = dict.fromkeys(self._table.baselines(protocol), "")
        return Cases(self._table.rows(protocol, models | baselines, photographs))

    def _simulated(self, protocol: str, photographs: Sequence[TestPhotograph]) -> None:
        """Measure simulated photographs; in P2 with a bank without the held-out curves."""
        data = self.test_set.data if protocol == "P2" else None
        bank = make_bank(data, without_held_out=True) if data else None
        settings = self.settings
        job = Job(protocol, tuple(photographs), self.test_set, settings.models, bank=bank, seed=settings.seed)
        measure_simulated(job, self._table, workers=settings.workers)

    def _clean(self, protocol: str, curves: Sequence[int]) -> Iterator[ReportRow]:
        """Measure clean photographs through some responses, and return their figures."""
        scenes, settings = range(len(self.test_set.scenes)), self.settings
        photographs = clean_photographs(scenes, curves, count=settings.photographs, seed=settings.seed)
        self._simulated(protocol, photographs)
        cases = self._cases(protocol, [photograph.label for photograph in photographs], self._models)
        self._with_uncertainty[protocol] = cases, list(self._models)
        return sums.clean_rows(protocol, cases, list(self._models), seed=settings.seed)

    def _paper(self) -> Iterator[ReportRow]:
        """Repeat the experiments of the CRF-net paper, and return the figures under every condition."""
        settings, scenes = self.settings, len(self.test_set.scenes)
        chosen = [one for one in settings.conditions if self.test_set.originals or not one.averaged]
        photographs = stress_photographs(
            range(scenes),
            range(len(self.test_set.curves)),
            count=min(settings.stress_photographs, settings.photographs),
            seed=settings.seed,
            conditions=chosen,
            originals=range(scenes, len(self.test_set.files)),
        )
        self._simulated(PAPER, photographs)

        conditions = dict[str, Cases]()
        for condition in chosen:
            names = [photograph.label for photograph in photographs if photograph.condition == condition]
            ways = {model + way: key for model, key in self._models.items() for way in WAYS}
            estimators = self._models | (ways if condition == CLEAN else {}) | {GAMMA: ""}
            conditions[condition.name] = Cases(self._table.rows(PAPER, estimators, names))
        return sums.stress_rows(conditions, seed=settings.seed)

    def _real(self) -> Iterator[ReportRow]:
        """Measure real photographs, and yield the figures of each folder and of both."""
        if self.test_set.data is None:
            raise CRFNetError("p4 needs real photographs; give --data instead of --quick")
        ways, seed, alone, together = list(self._ways), self.settings.seed, {}, []
        for folder, photographs in real_photographs(self.test_set.data).items():
            protocol = f"P4 {folder}"
            measure_real(protocol, photographs, self.settings.models, self._table, self.test_set)
            measure_pooled(protocol + POOLED, photographs, self.settings.models, self._table, self.test_set)
            alone[protocol] = self._cases(protocol, [photograph.name for photograph in photographs], self._ways)
            together.append(self._pooled(protocol, photographs))
        if len(alone) > 1:
            first, second = alone.values()
            alone[BOTH], together = first.joined(second), [together[0].joined(together[1])]
        for protocol, cases in alone.items():
            self._with_uncertainty[protocol] = sums.without_caution(cases), ways
            yield from sums.real_rows(protocol, cases, ways, seed=seed)
        yield from sums.body_rows(protocol, cases, ways)
        yield from sums.pooled_rows(protocol + POOLED, together[0], list(self._models), seed=seed)

    def _pooled(self, protocol: str, photographs: Sequence[RealPhotograph]) -> Cases:
        """Return the photographs that were estimated together, with these answers and the single ones."""
        chosen = {photograph.name for group in pooled_groups(photographs) for photograph in group}
        names = [photograph.name for photograph in photographs if photograph.name in chosen]
        pooled = self._table.rows(protocol + POOLED, self._ways, names)
        single = self._cases(protocol, names, self._ways).rows
        return Cases(single | {way + POOLED: rows for way, rows in pooled.items()})

    def _unusual(self) -> Iterator[ReportRow]:
        """Measure pictures that no response explains, and return how many are accepted."""
        scenes = self.test_set.scenes
        unusual.measure_unusual(scenes, self.settings.models, self._table)
        ways = {way: key for name, key in self._models.items() for way in unusual.ways_of(name)}
        names = [unusual.label(scene, kind) for kind in UnusualKind for scene in scenes]
        return sums.unusual_rows(Cases(self._table.rows(unusual.PROTOCOL, ways, names)))
