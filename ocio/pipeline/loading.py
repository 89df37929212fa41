"""What the options name, loaded: the network, the prior and a stored camera."""

from __future__ import annotations

from crfnet_core.estimate.estimate import ResponseEstimate
from crfnet_core.library import Camera, camera_estimate, find_camera
from crfnet_core.network import ResponseNetwork
from crfnet_core.posterior import Prior

from ..options import EstimateOptions


def load_network(options: EstimateOptions) -> ResponseNetwork:
    """Return the network that the options name; a caller with several estimates loads it once.

    Raises
    ------
    ModelError
        If the model folder is absent, incomplete or altered.
    """
    return ResponseNetwork.load(options.model, threads=options.threads)


def load_prior(options: EstimateOptions) -> Prior:
    """Return the prior that the options name; a caller with several estimates loads it once.

    Raises
    ------
    PriorError
        If there is no such prior, or the file is none.
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
        If there is no such camera, or its file is damaged.
    """
    camera = load_camera(options)
    return None if camera is None else camera_estimate(camera)
