"""A part of the simulated photographs: taken, and measured with every model and baseline, by one process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.network import ResponseNetwork, pooling
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import Prior, ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float32Array, Float64Array
from training.evaluation.measure.figures import PhotographFigures, all_baselines, model_figures
from training.evaluation.plan import Condition, Query, TestPhotograph
from training.evaluation.test_sets import SceneFile
from training.synthesis.camera import code_counts, render_photo, sensor_light

#: The prior of simulated photographs, whose responses are of any kind.
PRIOR = "any"

#: Lights in a process's memory: those of a scene, and of the scenes pooled with it. The largest take 0.3 GB.
LIGHTS_KEPT = 12


@dataclass(frozen=True)
class Measurement:
    """What was measured of one photograph for one case file: name of an estimator -> figures."""

    file: str
    label: str
    figures: dict[str, PhotographFigures]


@dataclass(frozen=True, eq=False)
class Job:
    """Photographs of one scene under one light, for one process.

    Parameters
    ----------
    photographs : tuple of TestPhotograph
        All of one scene under one light.
    scenes : tuple of SceneFile
        All scenes, for the pooled photographs.
    curves, exposures : dict
        Response (1024,) and s_crf of the numbers of responses that `photographs` name.
    estimators : dict
        Name of a case file -> the folder of its model, or None for the baselines.
    constants : dict
        The guesses that are the same for every photograph.
    bank : ResponseBank or None
        The responses that estimates choose from; None for the packaged ones.
    seed : int
        Of dither and noise.
    """

    photographs: tuple[TestPhotograph, ...]
    scenes: tuple[SceneFile, ...]
    curves: dict[int, Float64Array]
    exposures: dict[int, float]
    estimators: dict[str, Path | None]
    constants: dict[str, ResponseCurve]
    bank: ResponseBank | None
    seed: int

    def photo(self, scene: int, curve: int, condition: Condition) -> Photo:
        """Return one photograph; its dither is that of the scene, its noise its own."""
        light = _light(self.scenes[scene], scene, condition.light, self.seed)
        return render_photo(
            light,
            self.curves[curve],
            self.exposures[curve] * condition.factor,
            np.random.default_rng([self.seed, scene, curve]),
            name=self.scenes[scene].name,
            capture=condition.capture,
            is_gray=condition.is_gray and not condition.noise,
        )


@lru_cache(maxsize=LIGHTS_KEPT)
def _light(file: SceneFile, number: int, condition: Condition, seed: int) -> Float32Array:
    """Return the light of a scene under the part of a condition that comes before exposure, shape (H, W, 3)."""
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


def run_job(job: Job) -> list[Measurement]:
    """Return the figures of every photograph of a job; equal photographs are taken once for all their queries."""
    measured = []
    for (scene, curve, condition), group in groupby(
        job.photographs, key=lambda photograph: (photograph.scene, photograph.curve, photograph.condition)
    ):
        photographs = list(group)
        photo = job.photo(scene, curve, condition)
        counts, true = code_counts(photo), ResponseCurve.from_samples(job.curves[curve])
        for name, folder in job.estimators.items():
            if folder is None:
                rows = all_baselines(true, counts, job.constants)
                measured += [Measurement(name, photograph.label, rows) for photograph in photographs]
                continue
            estimate = _estimator(job, photo, folder)
            for photograph in photographs:
                answer = estimate(photograph)
                own = queried_curve(answer, photograph.query)
                figures = model_figures(true, answer, counts, curve=own)
                measured.append(Measurement(name, photograph.label, {name: figures}))
    return measured


def _estimator(job: Job, photo: Photo, folder: Path) -> Callable[[TestPhotograph], ResponseEstimate]:
    """Return a function from a test photograph to the product's estimate; equal questions are asked once."""
    known: dict[tuple[int | None, int | None, int], ResponseEstimate] = {}

    def estimate(photograph: TestPhotograph) -> ResponseEstimate:
        query, scene = photograph.query, photograph.scene
        question = (query.windows, query.coverage, query.pooled)
        if question not in known:
            others = [(scene + n) % len(job.scenes) for n in range(1, query.pooled)]
            photos = [photo, *(job.photo(other, photograph.curve, photograph.condition) for other in others)]
            known[question] = queried_estimate(photos, query, _network(folder), job.bank)
        return known[question]

    return estimate


def queried_estimate(
    photos: Sequence[Photo], query: Query, network: ResponseNetwork, bank: ResponseBank | None = None
) -> ResponseEstimate:
    """Return the product's estimate from photographs of one camera, asked as the query says."""
    asked: dict[str, Any] = {"windows": query.windows, "coverage": query.coverage}
    options = AnalysisOptions(**{name: value for name, value in asked.items() if value is not None})
    return estimate_response(photos, network=network, prior=Prior.load(PRIOR), bank=bank, options=options)


def queried_curve(estimate: ResponseEstimate, query: Query) -> ResponseCurve:
    """Return the product's response or, where the query asks for it, the mean of the windows' own."""
    if query.averaged is None:
        return estimate.curve
    weights = np.stack([part.weights for part in estimate.windows])
    chosen = weights if query.averaged == "all" else weights[pooling.inliers(weights)]
    return ResponseCurve.from_samples(EmorBasis.load().reconstruct(chosen.mean(axis=0)))
