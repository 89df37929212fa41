"""Run protocols one after the other: each measures what the table lacks, and sums it up."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from training.data.real_photographs import RealPhotograph, real_photographs
from training.data.response_bank import make_bank
from training.evaluation.baselines import GAMMA
from training.evaluation.measure import real, simulated, unusual
from training.evaluation.measure.real import POOLED, measure_real, pooled_groups
from training.evaluation.measure.simulated import PAPER, Job, measure_simulated
from training.evaluation.measure.table import TABLE_FILE, Table
from training.evaluation.models import Model
from training.evaluation.plan import CLEAN, CONDITIONS, SEED, clean_photographs, stress_photographs
from training.evaluation.report import rows
from training.evaluation.report.cases import Cases
from training.evaluation.report.document import Report, ReportRow, write_report
from training.evaluation.report.markdown import report_text
from training.evaluation.report.summary import rounded
from training.evaluation.test_sets import TestSet
from training.synthesis.unusual import UnusualKind

#: The name of the real photographs of both folders together.
BOTH = "P4 both"

QUICK_NOTE = "bundled lights and formulas instead of the data: not to be compared with the paper's figures"

CODE_NOTE = f"some photographs were measured before the code changed; delete {TABLE_FILE} to measure them again"


@dataclass(frozen=True)
class Evaluation:
    """The scope of an evaluation."""

    out: Path  # the folder of the table and the report
    test_set: TestSet
    models: tuple[Model, ...]  # all are measured on the same photographs
    protocols: Sequence[str]  # some of `PROTOCOLS`
    photographs: int  # the most photographs in P0 and P2
    stressed: int  # the most photographs in "paper" under each condition
    workers: int  # processes; 1 measures in this one

    def asked(self, ways: Iterable[str] = ("",)) -> dict[str, str]:
        """Return the name of each model, followed by each way of asking it -> the model's key in the table."""
        return {model.name + way: model.key for model in self.models for way in ways}


def evaluate(evaluation: Evaluation) -> Report:
    """Measure what the table lacks, write report.json and report.md, and return the report."""
    _check(evaluation)
    header = {"seed": SEED, "test_set": evaluation.test_set.digest}
    table = Table(evaluation.out / TABLE_FILE, header)
    chosen = [run for name, run in PROTOCOLS.items() if name in evaluation.protocols]
    report = Report(
        settings={"photographs": evaluation.photographs} | header,
        models={model.name: model.sha256 for model in evaluation.models},
        notes=[QUICK_NOTE] * (evaluation.test_set.data is None) + [CODE_NOTE] * table.is_of_other_code,
        rows=[rounded(row) for run in chosen for row in run(evaluation, table)],
    )
    write_report(evaluation.out / "report.json", report)
    atomic_write_text(evaluation.out / "report.md", report_text(report), overwrite=True)
    return report


def _check(evaluation: Evaluation) -> None:
    """Refuse models of one name, and for P2 models that know its responses."""
    names, held_out = [model.name for model in evaluation.models], evaluation.test_set.held_out
    if len(set(names)) < len(names):
        raise CRFNetError(f"models need different names, found {', '.join(names)}; rename the folder of one")
    for model in evaluation.models if "p2" in evaluation.protocols else ():
        if not held_out or not model.lacks(held_out):
            raise CRFNetError(
                f"{model.name}: model.json does not list the held-out curves of training/data/splits.json; train a"
                " model without them, or leave p2 out"
            )


def _clean(protocol: str, evaluation: Evaluation, table: Table) -> Iterator[ReportRow]:
    """Measure clean photographs, in P2 of the held-out responses with a bank without them, and return their figures."""
    test_set, bank = evaluation.test_set, None
    curves: Sequence[int] = range(len(test_set.curves))
    if protocol == "P2" and test_set.data:
        curves, bank = test_set.held_out, make_bank(test_set.data, without_held_out=True)
    photographs = clean_photographs(range(len(test_set.scenes)), curves, count=evaluation.photographs)
    measure_simulated(Job(protocol, photographs, test_set, evaluation.models, bank=bank), table, evaluation.workers)
    names = [photograph.label for photograph in photographs]
    cases = Cases(table.rows(protocol, evaluation.asked() | table.baselines(protocol), names))
    return rows.clean_rows(protocol, cases, list(evaluation.asked()))


def _paper(evaluation: Evaluation, table: Table) -> Iterator[ReportRow]:
    """Repeat the experiments of the CRF-net paper, and return the figures under every condition."""
    test_set, scenes = evaluation.test_set, len(evaluation.test_set.scenes)
    photographs = stress_photographs(
        range(scenes),
        range(scenes, len(test_set.files)),
        range(len(test_set.curves)),
        count=min(evaluation.stressed, evaluation.photographs),
    )
    measure_simulated(Job(PAPER, photographs, test_set, evaluation.models), table, evaluation.workers)
    conditions: dict[str, Cases] = {}
    for condition in CONDITIONS:
        if names := [photograph.label for photograph in photographs if photograph.condition == condition]:
            ways = evaluation.asked(simulated.WAYS) if condition == CLEAN else {}
            conditions[condition.name] = Cases(table.rows(PAPER, evaluation.asked() | ways | {GAMMA: ""}, names))
    return rows.stress_rows(conditions)


def _real(evaluation: Evaluation, table: Table) -> Iterator[ReportRow]:
    """Measure real photographs (P4), and yield the figures of each folder and of both."""
    if evaluation.test_set.data is None:
        raise CRFNetError("p4 needs real photographs; give --data instead of --quick")
    ways, alone, together = evaluation.asked(real.WAYS), {}, []
    for folder, photographs in real_photographs(evaluation.test_set.data).items():
        protocol = f"P4 {folder}"
        measure_real(protocol, photographs, evaluation.models, table, evaluation.test_set)
        names = [photograph.name for photograph in photographs]
        alone[protocol] = Cases(table.rows(protocol, ways | table.baselines(protocol), names))
        together.append(_pooled(protocol, photographs, ways, table))
    if len(alone) > 1:
        first, second = alone.values()
        alone[BOTH], together = first.joined(second), [together[0].joined(together[1])]
    for protocol, cases in alone.items():
        yield from rows.real_rows(protocol, cases, list(ways))
    yield from rows.body_rows(protocol, cases, list(ways))
    yield from rows.pooled_rows(protocol + POOLED, together[0], list(evaluation.asked()))


def _pooled(protocol: str, photographs: Sequence[RealPhotograph], ways: dict[str, str], table: Table) -> Cases:
    """Return the photographs that were estimated together, with these answers and the single ones."""
    chosen = {photograph.name for group in pooled_groups(photographs) for photograph in group}
    names = [photograph.name for photograph in photographs if photograph.name in chosen]
    pooled = table.rows(protocol + POOLED, ways, names)
    single = table.rows(protocol, ways | table.baselines(protocol), names)
    return Cases(single | {way + POOLED: answers for way, answers in pooled.items()})


def _unusual(evaluation: Evaluation, table: Table) -> Iterator[ReportRow]:
    """Measure pictures that no response explains (P6), and return how many are accepted."""
    scenes = evaluation.test_set.scenes
    unusual.measure_unusual(scenes, evaluation.models, table)
    names = [unusual.label(scene, kind) for kind in UnusualKind for scene in scenes]
    return rows.unusual_rows(Cases(table.rows(unusual.PROTOCOL, evaluation.asked(unusual.WAYS), names)))


#: Name of a protocol -> measures it and returns its rows. P0, P2 and P4 include P5, the reliability of uncertainties.
PROTOCOLS: Mapping[str, Callable[[Evaluation, Table], Iterator[ReportRow]]] = {
    "p0": partial(_clean, "P0"),
    "p2": partial(_clean, "P2"),
    "paper": _paper,
    "p4": _real,
    "p6": _unusual,
}
