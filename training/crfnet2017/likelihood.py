"""What an estimate of the paper's network says about the response: a likelihood, fitted on simulated photographs.

The network answers with one set of EMoR weights and no uncertainty. On photographs of the validation scenes its answer
w_hat is modelled as a w + b + noise in each of the first weights w, with one covariance of the noise for all
photographs; so its answer is evidence about w, at (w_hat - b) / a.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn
from tqdm import tqdm

from crfnet_core.network import pooling
from crfnet_core.posterior import UNUSUAL, Evidence
from crfnet_core.posterior.evidence import DEGREES_OF_FREEDOM, EVIDENCE_WEIGHTS
from crfnet_core.response.emor import EmorBasis
from crfnet_core.statistics.windows import cut_windows, select_windows
from crfnet_core.types import Float64Array
from training.network.shards import STATED_FAMILIES, photograph_source
from training.synthesis.camera import Capture, automatic_exposure, render_photo, sensor_light

#: Photographs of each validation scene that the likelihood is fitted to, and windows of each.
PHOTOGRAPHS, WINDOWS = 10, 10

#: The least slope: below, an answer hardly depends on the weight and says next to nothing about it.
LEAST_SLOPE = 0.05


@dataclass(frozen=True)
class Likelihood:
    """What an answer of the network is worth.

    slopes, intercepts, (5,): a and b
    factor, (5, 5): of the precision of the weights
    log_odds: of every family in `UNUSUAL`: the mean log likelihood of ordinary responses, so that the answer says
        nothing for or against these families, which the network does not know
    """

    slopes: Float64Array
    intercepts: Float64Array
    factor: Float64Array
    log_odds: float


def fit(true: Float64Array, answers: Float64Array) -> Likelihood:
    """Return the likelihood of true weights and answers, both of shape (N, 5)."""
    centered = true - true.mean(axis=0)
    slopes = np.maximum((centered * answers).sum(axis=0) / (centered**2).sum(axis=0), LEAST_SLOPE)
    intercepts = answers.mean(axis=0) - slopes * true.mean(axis=0)
    scale = np.cov((answers - slopes * true - intercepts).T) * (DEGREES_OF_FREEDOM - 2) / DEGREES_OF_FREEDOM
    factor = slopes[:, None] * np.linalg.cholesky(np.linalg.inv(scale))
    offsets = ((answers - intercepts) / slopes)[:, None] - true[None]  # (N, N, 5)
    exponent = (DEGREES_OF_FREEDOM + EVIDENCE_WEIGHTS) / 2
    likelihoods = (1 + np.sum((offsets @ factor) ** 2, axis=2) / DEGREES_OF_FREEDOM) ** -exponent
    return Likelihood(slopes, intercepts, factor, float(np.log(likelihoods.mean(axis=1)).mean()))


def validation_answers(network: nn.Module, data: Path) -> tuple[Float64Array, Float64Array]:
    """Return the true weights and the network's, (N, 5), of photographs of the validation scenes.

    `network`: from windows, float32 (N, 227, 227, 3), to EMoR weights (N, 11). `data`: folder with dorf, camera_curves
    and linear.
    """
    source, rows = photograph_source(data, "validation"), []
    unusual = [int(curve_set) for curve_set in STATED_FAMILIES]
    for number, scene in enumerate(tqdm(source.scenes, desc="likelihood", unit="scene")):
        rng = np.random.default_rng([7, number])
        for _ in range(PHOTOGRAPHS):
            curve, curve_set = source.draw_curve(rng)
            while curve_set in unusual:
                curve, curve_set = source.draw_curve(rng)
            exposure = automatic_exposure(curve, source.luminance) * rng.uniform(0.5, 1.6)
            light = sensor_light(scene, rng)
            photo = render_photo(light, curve, exposure, rng, name=scene.name, capture=Capture.draw(rng))
            windows = cut_windows(photo.pixels, select_windows(photo.pixels, count=WINDOWS))
            with torch.inference_mode():
                answers = network(torch.from_numpy(windows)).double().numpy()[:, :EVIDENCE_WEIGHTS]
            rows.append((EmorBasis.load().project(curve)[:EVIDENCE_WEIGHTS], _pooled(answers)))
    true, found = (np.stack(part) for part in zip(*rows, strict=True))
    return true, found


def _pooled(answers: Float64Array) -> Float64Array:
    """Return the mean over the windows that agree, as the product takes it, shape (5,)."""
    nothing = np.eye(EVIDENCE_WEIGHTS), np.zeros(len(UNUSUAL))
    return pooling.robust_mean([Evidence(answer, *nothing) for answer in answers]).location
