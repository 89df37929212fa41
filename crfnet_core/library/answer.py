"""A camera's response as an estimate, and the cameras of a photograph's make and model."""

from dataclasses import replace

import numpy as np

from crfnet_core.errors import Notice
from crfnet_core.estimate.estimate import input_warnings
from crfnet_core.estimate.result import CameraAnswer, ResponseEstimate
from crfnet_core.library.camera import Camera
from crfnet_core.library.library import known_cameras
from crfnet_core.posterior import Verdict
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float64Array

#: Deviations of a normal distribution within which 90 % of it lies.
BAND_DEVIATIONS = 1.645


def camera_estimate(camera: Camera) -> ResponseEstimate:
    """Return a camera's response with its errors and its band; it has no families, no prior and no windows."""
    curve = camera.curve
    deviation = brightness_per_stop(curve) * np.hypot(camera.shape_stops, camera.scale_stops)
    band = np.clip(curve.brightness + np.outer([-BAND_DEVIATIONS, BAND_DEVIATIONS], deviation), 0, 1)
    error = float(np.linalg.norm(deviation))
    return ResponseEstimate(
        curve=curve,
        weights=EmorBasis.load().project(curve.brightness),
        windows=(),
        uncertainty=error,
        shape_uncertainty=camera.shape_stops,
        band=band,
        families={},
        verdict=Verdict.from_shape_error(camera.shape_stops),
        prior="",
        origins=(),
        warnings=tuple(map(Notice.from_text, camera.warnings)),
        model="",
        photos=(),
        camera=CameraAnswer(camera.name, camera.basis),
    )


def with_camera(estimate: ResponseEstimate, camera: Camera) -> ResponseEstimate:
    """Return the answer of a stored camera for photographs, in the place of their estimate.

    The response, its errors and its band are the camera's. The photographs keep their windows, metadata and
    recognition: no stored response makes log footage a photograph.
    """
    answer, own = camera_estimate(camera), camera.settings.camera
    notices = input_warnings(estimate.recognition, estimate.origins)
    for origin in estimate.origins:
        if own and origin.camera.casefold() not in ("", own.casefold()):
            notices.append(Notice("other_camera", {"other": origin.camera, "name": camera.name, "camera": own}))
    notices += answer.warnings
    return replace(
        answer,
        windows=estimate.windows,
        verdict=Verdict.DO_NOT_TRUST if estimate.recognition else answer.verdict,
        origins=estimate.origins,
        warnings=tuple(dict.fromkeys(notices)),
        model=estimate.model,
        photos=estimate.photos,
        recognition=estimate.recognition,
    )


def offered_cameras(estimate: ResponseEstimate) -> tuple[CameraAnswer, ...]:
    """Return the cameras of the first photograph's make and model, the most exact first: offered, never used unasked.

    A photograph that a program developed from a raw file has none, because its response is not the camera's.
    """
    if not estimate.origins or any(origin.is_developed for origin in estimate.origins):
        return ()
    model = estimate.origins[0].camera.casefold()
    cameras = [camera for camera in known_cameras() if model and camera.settings.camera.casefold() == model]
    exact = sorted(cameras, key=lambda camera: camera.shape_stops)
    return tuple(CameraAnswer(camera.name, camera.basis) for camera in exact)


def brightness_per_stop(curve: ResponseCurve) -> Float64Array:
    """Return by how much brightness rises with a stop more light, at the samples of a response, shape (1024,).

    An error of some stops in the light is that many times as large in brightness. The jump of a camera that clips below
    the largest code is left out: it stays at white.
    """
    rise = np.gradient(curve.brightness, curve.irradiance)
    rise[-2:] = np.minimum(rise[-2:], rise[-3])
    return np.asarray(np.log(2) * curve.irradiance * rise)
