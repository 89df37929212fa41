"""Take the photographs once, ask every model and baseline for the response, and keep the errors."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import groupby
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from crfnet_core.emor import EmorBasis
from crfnet_core.estimate import ResponseEstimate, estimate_response
from crfnet_core.network import ResponseNetwork
from crfnet_core.photo import Photo
from crfnet_core.response import ResponseCurve
from training.evaluation.baselines import constant_curves, oracle_curves
from training.evaluation.cases import CaseFile, Row, errors
from training.evaluation.material import Material, SceneFile
from training.evaluation.plan import PLAIN, Condition, Shot, Trial
from training.synthesis.camera import code_counts, render_photo, sensor_light

#: Photographs of a job: small enough to spread and to keep often.
JOB_SIZE = 20

#: Seconds between two writes of the case files.
SAVE_EVERY = 10.0

#: Lights in a process's memory: those of a scene, and of the scenes pooled with it. The largest take 0.3 GB.
LIGHTS_KEPT = 12

#: The party of `Job.parties` that is no model.
BASELINE_PARTY = "baselines"


@dataclass(frozen=True, eq=False)
class Job:
    """Photographs of one scene under one light, for one process.

    Parameters
    ----------
    shots : tuple of Shot
        All of one scene under one light.
    scenes : tuple of SceneFile
        All scenes, for the pooled photographs.
    curves, exposures : dict
        Response (1024,) and s_crf of the curves that `shots` name.
    parties : dict
        Name of a model -> its folder, or `BASELINE_PARTY` -> None.
    constants : dict
        The guesses that are the same for every photograph.
    seed : int
        Of dither and noise.
    """

    shots: tuple[Shot, ...]
    scenes: tuple[SceneFile, ...]
    curves: dict[int, np.ndarray]
    exposures: dict[int, float]
    parties: dict[str, Path | None]
    constants: dict[str, ResponseCurve]
    seed: int

    def photo(self, scene: int, curve: int, condition: Condition) -> Photo:
        """Return one photograph; its dither is that of the scene, its noise its own."""
        light = _light(self.scenes[scene], scene, condition.light, self.seed)
        rng = np.random.default_rng([self.seed, scene, curve])
        return render_photo(
            light,
            self.curves[curve],
            self.exposures[curve] * condition.factor,
            rng,
            name=self.scenes[scene].name,
            capture=condition.capture,
            is_gray=condition.is_gray and not condition.noise,
        )


@lru_cache(maxsize=LIGHTS_KEPT)
def _light(file: SceneFile, number: int, condition: Condition, seed: int) -> np.ndarray:
    """Return the light of a scene under the part of a condition that comes before exposure."""
    return sensor_light(
        file.read(),
        np.random.default_rng([seed, number]),
        gains=condition.gains,
        is_gray=condition.is_gray,
        blur=condition.blur,
        upsampling=condition.upsampling,
    )


@cache
def _network(folder: Path) -> ResponseNetwork:
    """Return a model, loaded once per process."""
    return ResponseNetwork.load(folder, threads=1)


def run_job(job: Job) -> list[tuple[str, str, dict[str, Row]]]:
    """Return (party, photograph, estimator -> row) of every photograph of a job."""
    found = []
    for (scene, curve, condition), shots in groupby(
        job.shots, key=lambda shot: (shot.scene, shot.curve, shot.condition)
    ):
        asked = list(shots)
        photo = job.photo(scene, curve, condition)
        counts, true = code_counts(photo), ResponseCurve.from_samples(job.curves[curve])
        for party, folder in job.parties.items():
            if folder is None:
                rows = baseline_rows(true, counts, job.constants)
                found += [(party, shot.label, rows) for shot in asked]
                continue
            answer = _answerer(job, photo, curve, folder)
            found += [(party, shot.label, {party: model_row(true, counts, *answer(shot))}) for shot in asked]
    return found


def _answerer(job: Job, photo: Photo, curve: int, folder: Path) -> Callable[[Shot], tuple[ResponseEstimate, Trial]]:
    """Return a function from a shot to the product's estimate and the shot's trial; equal questions are asked once."""
    known: dict[tuple[int | None, int | None, int], ResponseEstimate] = {}

    def answer(shot: Shot) -> tuple[ResponseEstimate, Trial]:
        trial = shot.trial
        question = (trial.windows, trial.coverage, trial.pooled)
        if question not in known:
            others = [(shot.scene + n) % len(job.scenes) for n in range(1, trial.pooled)]
            photos = [photo, *(job.photo(scene, curve, shot.condition) for scene in others)]
            known[question] = estimated(photos, trial, _network(folder))
        return known[question], trial

    return answer


def estimated(photos: Sequence[Photo], trial: Trial, network: ResponseNetwork) -> ResponseEstimate:
    """Return the product's estimate from photographs of one camera, asked as the trial says."""
    options = {"windows": trial.windows, "coverage": trial.coverage}
    return estimate_response(photos, network=network, **{k: v for k, v in options.items() if v is not None})


def averaged_curve(estimate: ResponseEstimate, trial: Trial) -> ResponseCurve:
    """Return the product's response or, where the trial asks for it, the mean of the windows' own."""
    if trial.averaged is None:
        return estimate.curve
    chosen = [part.weights for part in estimate.windows if part.kept or trial.averaged == "all"]
    return ResponseCurve.from_samples(EmorBasis.load().reconstruct(np.mean(chosen, axis=0)))


def model_row(true: ResponseCurve, counts: np.ndarray, estimate: ResponseEstimate, trial: Trial) -> Row:
    """Return the errors of an estimate, its uncertainty, and the share of the true response inside its 90 % band."""
    inside = (true.brightness >= estimate.band[0]) & (true.brightness <= estimate.band[1])
    return errors(true, averaged_curve(estimate, trial), counts) | {
        "uncertainty": round(estimate.uncertainty, 6),
        "coverage": round(float(inside.mean()), 6),
    }


def baseline_rows(true: ResponseCurve, counts: np.ndarray, constants: dict[str, ResponseCurve]) -> dict[str, Row]:
    """Return the errors of every baseline on one photograph."""
    return {name: errors(true, curve, counts) for name, curve in (constants | oracle_curves(true)).items()}


def measure(
    shots: Sequence[Shot],
    material: Material,
    models: dict[str, Path],
    files: dict[str, CaseFile],
    *,
    exposures: Callable[[], np.ndarray],
    workers: int,
    seed: int,
    title: str,
) -> None:
    """Fill the case files with what is absent, on `workers` processes.

    Parameters
    ----------
    shots : sequence of Shot
        The photographs.
    material : Material
        Scenes and responses.
    models : dict
        Name -> folder.
    files : dict
        Name of a model, or `BASELINE_PARTY` -> its cases.
    exposures : callable
        Returns s_crf of every curve; called only when a photograph has to be taken.
    workers : int
        Processes.
    seed : int
        Of dither and noise.
    title : str
        Of the progress bar.
    """
    absent = {name: _absent(shots, file, is_baseline=name == BASELINE_PARTY) for name, file in files.items()}
    if not any(absent.values()):
        return
    found = exposures()
    constants = constant_curves(material.curves)
    jobs = list(_jobs(shots, material, models, absent, found, constants, seed))
    written = time.monotonic()
    with tqdm(total=sum(len(job.shots) for job in jobs), desc=title, unit="photograph") as bar:
        try:
            for job, rows in zip(jobs, _run(jobs, workers), strict=True):
                for party, label, row in rows:
                    files[party].rows[label] = row
                bar.update(len(job.shots))
                if time.monotonic() - written > SAVE_EVERY:
                    _save(files)
                    written = time.monotonic()
        finally:
            _save(files)


def _absent(shots: Sequence[Shot], file: CaseFile, *, is_baseline: bool) -> set[str]:
    """Return the labels of the photographs that a file lacks; baselines are only measured in the plain trial."""
    wanted = (shot for shot in shots if shot.trial == PLAIN or not is_baseline)
    return {shot.label for shot in wanted if shot.label not in file.rows}


def _run(jobs: list[Job], workers: int) -> Iterator[list[tuple[str, str, dict[str, Row]]]]:
    """Yield what each job found, in their order; one worker is this process."""
    if workers == 1:
        yield from map(run_job, jobs)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            yield from pool.map(run_job, jobs)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _save(files: dict[str, CaseFile]) -> None:
    """Write all case files."""
    for file in files.values():
        file.save()


def _jobs(
    shots: Sequence[Shot],
    material: Material,
    models: dict[str, Path],
    absent: dict[str, set[str]],
    exposures: np.ndarray,
    constants: dict[str, ResponseCurve],
    seed: int,
) -> Iterator[Job]:
    """Return the jobs: shots that the same parties lack, of one scene and condition."""
    folders: dict[str, Path | None] = {BASELINE_PARTY: None, **models}

    def lacking(shot: Shot) -> tuple[str, ...]:
        return tuple(name for name in absent if shot.label in absent[name])

    def place(shot: Shot) -> tuple[Any, ...]:
        return (lacking(shot), shot.scene, repr(shot.condition.light))

    wanted = (shot for shot in shots if lacking(shot))
    ordered = sorted(wanted, key=lambda shot: (*place(shot), shot.curve, repr(shot.condition)))
    for (parties, *_), group in groupby(ordered, key=place):
        members = list(group)
        for start in range(0, len(members), JOB_SIZE):
            part = tuple(members[start : start + JOB_SIZE])
            chosen = sorted({shot.curve for shot in part})
            yield Job(
                shots=part,
                scenes=material.scenes,
                curves={k: material.curves[k] for k in chosen},
                exposures={k: float(exposures[k]) for k in chosen},
                parties={name: folders[name] for name in parties},
                constants=constants,
                seed=seed,
            )
