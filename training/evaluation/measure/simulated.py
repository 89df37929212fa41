"""Measure all simulated photographs, on several processes, and keep the figures."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path

from tqdm import tqdm

from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Float64Array
from training.evaluation.baselines import BASELINES, constant_curves
from training.evaluation.measure import jobs
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.jobs import Job, Measurement
from training.evaluation.plan import PLAIN, TestPhotograph
from training.evaluation.test_sets import TestSet

#: Photographs of a job: small enough to spread over processes and to keep often.
JOB_SIZE = 20

#: Seconds between two writes of the case files.
SAVE_EVERY = 10.0


def measure_simulated(
    photographs: Sequence[TestPhotograph],
    test_set: TestSet,
    models: dict[str, Path],
    files: dict[str, CaseFile],
    *,
    exposures: Callable[[], Float64Array],
    bank: ResponseBank | None = None,
    workers: int,
    seed: int,
    title: str,
) -> None:
    """Add to the case files what they lack, on `workers` processes.

    Parameters
    ----------
    photographs : sequence of TestPhotograph
        The photographs.
    test_set : TestSet
        Scenes and responses.
    models : dict
        Name -> folder.
    files : dict
        Name of a model, or `BASELINES` -> its figures.
    exposures : callable
        Returns s_crf of every response; called only when a photograph has to be taken.
    bank : ResponseBank, optional
        The responses that estimates choose from; by default the packaged ones.
    workers : int
        Processes.
    seed : int
        Of dither and noise.
    title : str
        Of the progress bar.
    """
    absent = {name: _absent(photographs, file, name) for name, file in files.items()}
    if not any(absent.values()):
        return
    parts = list(_parts(photographs, absent))
    scales, constants = exposures(), constant_curves(test_set.curves)
    folders: dict[str, Path | None] = {BASELINES: None, **models}
    work = [
        _job(part, {name: folders[name] for name in names}, test_set, scales, constants, bank, seed)
        for names, part in parts
    ]
    _measure(work, files, workers=workers, title=title)


def _measure(work: list[Job], files: dict[str, CaseFile], *, workers: int, title: str) -> None:
    """Add what the jobs measure to the case files, and write these every now and then and at the end."""
    written = time.monotonic()
    with tqdm(total=sum(len(job.photographs) for job in work), desc=title, unit="photograph") as bar:
        try:
            for job, measured in zip(work, _run(work, workers), strict=True):
                for row in measured:
                    files[row.file].rows[row.label] = row.figures
                bar.update(len(job.photographs))
                if time.monotonic() - written > SAVE_EVERY:
                    _save(files)
                    written = time.monotonic()
        finally:
            _save(files)


def _absent(photographs: Sequence[TestPhotograph], file: CaseFile, name: str) -> set[str]:
    """Return the labels of the photographs that a file lacks; baselines are only measured in the plain query."""
    wanted = (photograph for photograph in photographs if photograph.query == PLAIN or name != BASELINES)
    return {photograph.label for photograph in wanted if photograph.label not in file.rows}


def _run(work: list[Job], workers: int) -> Iterator[list[Measurement]]:
    """Yield what each job measured, in their order; one worker is this process."""
    if workers == 1:
        yield from map(jobs.run_job, work)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            yield from pool.map(jobs.run_job, work)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _save(files: dict[str, CaseFile]) -> None:
    """Write all case files."""
    for file in files.values():
        file.save()


def _parts(
    photographs: Sequence[TestPhotograph], absent: dict[str, set[str]]
) -> Iterator[tuple[tuple[str, ...], tuple[TestPhotograph, ...]]]:
    """Yield (names of the case files that lack them, at most `JOB_SIZE` photographs of one scene under one light)."""

    def lacking(photograph: TestPhotograph) -> tuple[str, ...]:
        return tuple(name for name in absent if photograph.label in absent[name])

    def place(photograph: TestPhotograph) -> tuple[tuple[str, ...], int, str]:
        return lacking(photograph), photograph.scene, repr(photograph.condition.light)

    wanted = (photograph for photograph in photographs if lacking(photograph))
    ordered = sorted(wanted, key=lambda each: (*place(each), each.curve, repr(each.condition)))
    for (names, *_), group in groupby(ordered, key=place):
        members = tuple(group)
        for start in range(0, len(members), JOB_SIZE):
            yield names, members[start : start + JOB_SIZE]


def _job(
    photographs: tuple[TestPhotograph, ...],
    estimators: dict[str, Path | None],
    test_set: TestSet,
    exposures: Float64Array,
    constants: dict[str, ResponseCurve],
    bank: ResponseBank | None,
    seed: int,
) -> Job:
    """Return the job of some photographs, with the responses that they need."""
    curves = sorted({photograph.curve for photograph in photographs})
    return Job(
        photographs=photographs,
        scenes=test_set.scenes,
        curves={k: test_set.curves[k] for k in curves},
        exposures={k: float(exposures[k]) for k in curves},
        estimators=estimators,
        constants=constants,
        bank=bank,
        seed=seed,
    )
