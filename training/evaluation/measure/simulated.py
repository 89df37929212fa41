"""Measure simulated photographs (P0, P2, paper) with every model and baseline, on several processes."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import groupby
from multiprocessing import get_context
from typing import Any

import numpy as np
from tqdm import tqdm

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import Prior, ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Float32Array
from training.data.scenes import Scene, area_averaged
from training.evaluation.baselines import GAMMA, constant_curves, oracle_curves
from training.evaluation.measure.figures import curve_figures, estimate_figures
from training.evaluation.measure.table import Row, Table
from training.evaluation.models import Model, load_network
from training.evaluation.plan import CLEAN, SEED, Condition, TestPhotograph
from training.evaluation.test_sets import SceneFile, TestSet
from training.synthesis.camera import code_counts, render_photo, sensor_light

PRIOR = "any"  # the prior of simulated photographs, whose responses are of any kind
PAPER = "paper"  # the name, in the table, of the protocol that repeats the experiments of the CRF-net paper
JOB_SIZE = 20  # the most photographs of a job: few enough to spread over processes and to write often

#: What follows a model's name -> how it is asked: the paper's Fig. 3, on the clean photographs of `PAPER`.
WAYS = {
    ", one chosen window": AnalysisOptions(windows=1),
    ", one random window": AnalysisOptions(windows=1, coverage=0),
}


@dataclass(frozen=True, eq=False)
class Job:
    """Simulated photographs, and the estimators to measure on them."""

    protocol: str  # the protocol; in `PAPER` gamma 2.2 is the only baseline
    photographs: Sequence[TestPhotograph]
    test_set: TestSet
    models: tuple[Model, ...]
    has_baselines: bool = True  # whether to measure the baselines
    bank: ResponseBank | None = None  # the responses that estimates choose from; None for the packaged ones

    def row(self, photograph: TestPhotograph, estimator: str, model: str, figures: dict[str, Any]) -> Row:
        """Return a row of the table."""
        return {
            "protocol": self.protocol,
            "photograph": photograph.label,
            "estimator": estimator,
            "model": model,
            "scene number": photograph.scene,
            "kind": self.test_set.files[photograph.scene].kind,
            "curve": photograph.curve,
            "exposure": photograph.condition.factor,
        } | figures


def measure_simulated(whole: Job, table: Table, workers: int) -> None:
    """Add to the table what it lacks of a job, on `workers` processes; 1 measures in this one."""
    work = list(_parts(whole, table))
    if not work:
        return
    _ = whole.test_set.exposures  # computed once, for all processes
    with tqdm(total=sum(len(job.photographs) for job in work), desc=whole.protocol, unit="photograph") as bar:
        for job, rows in zip(work, _run(work, workers), strict=True):
            table.add(rows)
            bar.update(len(job.photographs))


def _parts(whole: Job, table: Table) -> Iterator[Job]:
    """Yield jobs of at most `JOB_SIZE` photographs of one scene under one light, with what the table lacks of them."""

    def lacking(photograph: TestPhotograph) -> tuple[list[Model], bool]:
        label = photograph.label
        models = [model for model in whole.models if table.lacks(whole.protocol, label, model.name, model.key)]
        return models, table.lacks(whole.protocol, label, GAMMA)

    def place(photograph: TestPhotograph) -> tuple[str, int, str]:
        return repr(lacking(photograph)), photograph.scene, repr(photograph.condition.light)

    wanted = [photograph for photograph in whole.photographs if any(lacking(photograph))]
    wanted.sort(key=lambda each: (*place(each), each.curve, repr(each.condition)))
    for _, group in groupby(wanted, key=place):
        members = list(group)
        models, has_baselines = lacking(members[0])
        for start in range(0, len(members), JOB_SIZE):
            part = members[start : start + JOB_SIZE]
            yield replace(whole, photographs=part, models=tuple(models), has_baselines=has_baselines)


def _run(work: list[Job], workers: int) -> Iterator[list[Row]]:
    """Yield the rows of each job, in their order."""
    if workers == 1:
        yield from map(run_job, work)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            yield from pool.map(run_job, work)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def run_job(job: Job) -> list[Row]:
    """Return the rows of every photograph of a job."""
    rows = []
    for photograph in job.photographs:
        photo = simulated_photo(job.test_set, photograph)
        counts, true = code_counts(photo), ResponseCurve.from_samples(job.test_set.curves[photograph.curve])
        for name, guess in _baselines(job, true).items():
            rows.append(job.row(photograph, name, "", curve_figures(true, guess, counts)))
        has_ways = job.protocol == PAPER and photograph.condition == CLEAN
        for model in job.models:
            ask = partial(estimate_response, photo, network=load_network(model, threads=1), prior=Prior.load(PRIOR))
            for way, options in ({"": AnalysisOptions()} | (WAYS if has_ways else {})).items():
                figures = estimate_figures(true, ask(bank=job.bank, options=options), counts)
                rows.append(job.row(photograph, model.name + way, model.key, figures))
    return rows


def simulated_photo(test_set: TestSet, photograph: TestPhotograph) -> Photo:
    """Return one photograph; its dither belongs to the scene, its noise to itself."""
    scene, curve, condition = photograph.scene, photograph.curve, photograph.condition
    return render_photo(
        _light(test_set.files[scene], scene, condition.light),
        test_set.curves[curve],
        float(test_set.exposures[curve]) * condition.factor,
        np.random.default_rng([SEED, scene, curve]),
        name=test_set.files[scene].name,
        capture=condition.capture,
    )


def _baselines(job: Job, true: ResponseCurve) -> dict[str, ResponseCurve]:
    """Return the guesses of the baselines of a job by name."""
    if not job.has_baselines:
        return {}
    return {GAMMA: ResponseCurve.gamma(2.2)} if job.protocol == PAPER else constant_curves() | oracle_curves(true)


@lru_cache(maxsize=1)
def _light(file: SceneFile, number: int, condition: Condition) -> Float32Array:
    """Return the light of a scene under the part of a condition that comes before exposure, shape (H, W, 3)."""
    scene = file.read()
    if condition.averaged:
        scene = Scene(scene.name, area_averaged(scene.pixels, condition.averaged), scene.is_panorama)
    return sensor_light(
        scene,
        np.random.default_rng([SEED, number]),
        gains=condition.gains,
        is_gray=condition.is_gray,
        blur=condition.blur,
    )
