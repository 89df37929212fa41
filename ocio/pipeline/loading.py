"""The network, the prior and the stored camera that the options name."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.library import Camera, camera_estimate, find_camera
from crfnet_core.network import ModelConfig, ResponseNetwork, model_folder
from crfnet_core.posterior import Prior

from ..options import EstimateOptions


def load_network(options: EstimateOptions) -> ResponseNetwork:
    """Return the network that the options name; the last one stays loaded.

    Raises
    ------
    ModelError
        If the model folder is absent, incomplete or altered.
    """
    return _network(options.model, options.threads)


def load_prior(options: EstimateOptions) -> Prior:
    """Return the prior that the options name, whose file may change while a process lives.

    Raises
    ------
    PriorError
        If there is no such prior, or the file holds none.
    """
    return Prior.load(options.prior)


def load_camera(options: EstimateOptions) -> Camera | None:
    """Return the stored camera that the options name; None if they name none.

    Raises
    ------
    CameraError
        If there is no such camera, or its file is damaged.
    """
    return None if options.camera is None else find_camera(options.camera)


def load_camera_response(options: EstimateOptions) -> ResponseEstimate | None:
    """Return the response of the stored camera that the options name, for photographs that nobody looks at.

    Raises
    ------
    CameraError
        If there is no such camera, or it has no evidence of the model.
    PriorError, ModelError
        If there is no such prior or model.
    """
    camera = load_camera(options)
    if camera is None:
        return None
    return camera_estimate(camera, model=model_label(options.model), prior=load_prior(options))


def model_label(model: Path | None) -> str:
    """Return the label of a model without loading its network; None stands for the default.

    Raises
    ------
    ModelError
        If the model folder is absent, incomplete or altered.
    """
    return ModelConfig.read(model_folder(model) / "model.json").label


@lru_cache(maxsize=1)
def _network(model: Path | None, threads: int) -> ResponseNetwork:
    """Return a network."""
    return ResponseNetwork.load(model, threads=threads)
