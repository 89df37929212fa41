"""Fit the model of the uncertainty, from the error that the network expects to an E_est and a band."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from scipy.optimize import nnls
from tqdm import tqdm

from crfnet_core.estimate import estimate_response
from crfnet_core.metrics import estimation_error
from crfnet_core.network import ResponseNetwork, UncertaintyModel
from crfnet_core.response import SAMPLES, ResponseCurve
from crfnet_core.types import Float64Array
from training.network.shards import photograph_source
from training.synthesis.camera import Capture, automatic_exposure, render_photo, sensor_light

#: Photographs of each validation scene that the model is fitted to.
PHOTOGRAPHS = 50

#: Fraction of the residuals that the band holds at every irradiance.
BAND = 0.9

#: Knots of the band's profile over irradiance, at even distances from 0 to 1.
BAND_KNOTS = 33

#: Stands in a model folder until the model is fitted: the uncertainty is the error that the network expects.
NOT_FITTED = UncertaintyModel(base=0.0, of_predicted=1.0, of_spread=0.0, band_profile=(0.0,) * BAND_KNOTS)


def fit_uncertainty_model(data: Path, folder: Path, *, workers: int) -> UncertaintyModel:
    """Return the uncertainty model of the network in `folder`, fitted on photographs of the validation scenes.

    The uncertainty is a non-negative least-squares fit of E_est to 1, the expected error and the spread of the windows'
    estimates. The half-width of the band is the 90 % quantile of the residual, in units of the uncertainty, at every
    irradiance.

    Parameters
    ----------
    data : Path
        Folder with dorf, camera_curves and linear.
    folder : Path
        A model folder whose uncertainty model is `NOT_FITTED`.
    workers : int
        Processes.
    """
    scenes = range(len(photograph_source(data, "validation").scenes))
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(scene_errors, data, folder, number) for number in scenes]
        rows = np.concatenate([job.result() for job in tqdm(jobs, desc="uncertainty", unit="scene")])
    return fit(error=rows[:, 0], expected=rows[:, 1], spread=rows[:, 2], residuals=rows[:, 3:])


def fit(
    *, error: Float64Array, expected: Float64Array, spread: Float64Array, residuals: Float64Array
) -> UncertaintyModel:
    """Return the uncertainty model of N photographs.

    Parameters
    ----------
    error, expected, spread : ndarray, shape (N,)
        E_est, the error that the network expects, and the RMS distance of the windows' estimates from their mean.
    residuals : ndarray, shape (N, 1024)
        Absolute difference between the true and the estimated response.
    """
    features = np.column_stack([np.ones(len(error)), expected, spread])
    parts, _ = nnls(features, error)
    quantiles = np.quantile(residuals / (features @ parts)[:, None], BAND, axis=0)
    knots = np.interp(np.linspace(0, 1, BAND_KNOTS), np.linspace(0, 1, SAMPLES), quantiles)
    base, of_predicted, of_spread = (round(float(part), 4) for part in parts)
    return UncertaintyModel(base, of_predicted, of_spread, tuple(round(float(knot), 5) for knot in knots))


def scene_errors(data: Path, folder: Path, number: int) -> Float64Array:
    """Return E_est, expected error, spread and residuals, (PHOTOGRAPHS, 1027), of one validation scene."""
    source, network = photograph_source(data, "validation"), ResponseNetwork.load(folder, threads=1)
    scene, rng, rows = source.scenes[number], np.random.default_rng([7, number]), []
    for _ in range(PHOTOGRAPHS):
        curve, _ = source.draw_curve(rng)
        exposure = automatic_exposure(curve, source.luminance) * rng.uniform(0.5, 1.6)
        capture = Capture.draw(rng)
        photo = render_photo(sensor_light(scene, rng), curve, exposure, rng, name=scene.name, capture=capture)
        estimate = estimate_response(photo, network=network)
        true = ResponseCurve.from_samples(curve)
        residual = np.abs(true.brightness - estimate.curve.brightness)
        rows.append([estimation_error(true, estimate.curve), estimate.uncertainty, estimate.spread, *residual])
    return np.array(rows)
