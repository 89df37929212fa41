"""The network, the prior and the stored camera that the options name; CRFNetError if absent or damaged."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.library import Camera, camera_estimate, find_camera
from crfnet_core.network import ResponseNetwork
from crfnet_core.posterior import Prior

from ..options import EstimateOptions


def load_network(options: EstimateOptions) -> ResponseNetwork:
    """Return the network that the options name; the last one stays loaded."""
    return _network(options.model, options.threads)


def load_prior(options: EstimateOptions) -> Prior:
    """Return the prior that the options name, whose file may change while a process lives."""
    return Prior.load(options.prior)


def load_camera(options: EstimateOptions) -> Camera | None:
    """Return the stored camera that the options name; None if they name none."""
    return None if options.camera is None else find_camera(options.camera)


def load_camera_response(options: EstimateOptions) -> ResponseEstimate | None:
    """Return the response of that camera, for photographs that nobody looks at; None without one."""
    camera = load_camera(options)
    return None if camera is None else camera_estimate(camera)


@lru_cache(maxsize=1)
def _network(model: Path | None, threads: int) -> ResponseNetwork:
    """Return a network."""
    return ResponseNetwork.load(model, threads=threads)
