"""A camera's response as an estimate, so that everything that takes an estimate takes it; photographs against it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crfnet_core.errors import CameraError, Notice
from crfnet_core.estimate.estimate import editor_warnings, estimate_from_evidence
from crfnet_core.estimate.result import CameraAnswer, ResponseEstimate
from crfnet_core.library.camera import Camera, KeptPhotograph, MeasuredResponse
from crfnet_core.posterior import Prior, Verdict
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import estimation_error, shape_error
from crfnet_core.types import Float64Array

#: Deviations of a normal distribution within which 90 % of it lies.
BAND_DEVIATIONS = 1.645

#: A photograph disagrees if its own estimate is farther away than this many times the error expected of both, in shape
#: or in E_est: from a measured response, and from another estimate, which is nearer because it begins at the same
#: prior. docs/CAMERAS.md has the shares of real photographs that disagree with their own camera and with another.
MEASURED_LIMIT, ESTIMATED_LIMIT = 2.0, 0.7


def camera_estimate(camera: Camera, *, model: str, prior: Prior | None = None) -> ResponseEstimate:
    """Return a camera's response: the measured one if there is one, else that of its photographs together.

    Parameters
    ----------
    camera : Camera
        The camera.
    model : str
        The label of the network whose evidence counts; photographs that another one read are left out.
    prior : Prior, optional
        As of `crfnet_core.estimate_response`.

    Raises
    ------
    CameraError
        If there is neither a measured response nor a photograph that this network read.
    """
    if camera.measured:
        return replace(_measured_estimate(camera.measured), camera=_answer(camera))
    photographs = [photograph for photograph in camera.photographs if photograph.model == model]
    if not photographs:
        raise CameraError(
            f"{camera.name!r} has no evidence of {model}, but of {_read_by(camera)}; add its photographs again"
        )
    return replace(_estimate(photographs, model, prior), camera=_answer(camera))


def compared(own: ResponseEstimate, camera: Camera, *, prior: Prior | None = None) -> CameraAnswer:
    """Return how far photographs' own estimate is from a camera's response; parameters and errors of `with_camera`."""
    return _compared(own, camera, camera_estimate(camera, model=own.model, prior=prior))


def differences(camera: Camera, *, model: str) -> dict[str, CameraAnswer]:
    """Return how far each photograph's own estimate is from the response without it, by the photograph's SHA-256.

    Photographs that another network read are left out, and so is the only photograph of a camera.
    """
    found = {}
    for photograph in camera.photographs:
        others = replace(camera, photographs=tuple(one for one in camera.photographs if one is not photograph))
        if photograph.model != model or not (others.measured or any(one.model == model for one in others.photographs)):
            continue
        found[photograph.sha256] = compared(_estimate([photograph], model), others)
    return found


def with_camera(own: ResponseEstimate, camera: Camera, *, prior: Prior | None = None) -> ResponseEstimate:
    """Return the answer of a camera for photographs, in the place of their own estimate.

    The response, its errors and its band are the camera's. What is said of the photographs stays: windows, metadata,
    and that they are no photographs of a camera. The answer is no longer "good" if they disagree with it.

    Parameters
    ----------
    own : ResponseEstimate
        What is estimated from the photographs alone.
    camera : Camera
        The camera.
    prior : Prior, optional
        As of `camera_estimate`.

    Raises
    ------
    CameraError
        As of `camera_estimate`.
    """
    answer = camera_estimate(camera, model=own.model, prior=prior)
    found = _compared(own, camera, answer)
    warnings = [Notice("recognized", {"reason": own.recognition.reason})] if own.recognition else []
    warnings += [*editor_warnings(own.origins), *_other_cameras(camera, own), *answer.warnings]
    verdict = Verdict.DO_NOT_TRUST if own.recognition else answer.verdict
    if not found.agrees:
        stops, error = found.difference_stops, found.difference
        warnings.append(Notice("camera_disagrees", {"stops": stops, "error": error, "camera": repr(camera.name)}))
        verdict = Verdict.USABLE if verdict is Verdict.GOOD else verdict
    return replace(
        answer,
        windows=own.windows,
        verdict=verdict,
        origins=own.origins,
        warnings=tuple(dict.fromkeys(warnings)),
        model=own.model,
        photos=own.photos,
        recognition=own.recognition,
        camera=found,
    )


def _compared(own: ResponseEstimate, camera: Camera, other: ResponseEstimate) -> CameraAnswer:
    """Return how far photographs' own estimate is from a camera's response, which is given."""
    stops, error = shape_error(other.curve, own.curve), estimation_error(other.curve, own.curve)
    limit = MEASURED_LIMIT if camera.measured else ESTIMATED_LIMIT
    has_shape = stops <= limit * float(np.hypot(own.shape_uncertainty, other.shape_uncertainty))
    has_curve = error <= limit * float(np.hypot(own.uncertainty, other.uncertainty))
    return replace(_answer(camera), difference_stops=stops, difference=error, agrees=has_shape and has_curve)


def _answer(camera: Camera) -> CameraAnswer:
    """Return what is said of a camera whose response is the answer."""
    return CameraAnswer(camera.name, camera.measured is not None, camera.basis)


def _estimate(photographs: list[KeptPhotograph], model: str, prior: Prior | None = None) -> ResponseEstimate:
    """Return the estimate from kept photographs of one network."""
    return estimate_from_evidence([photograph.analyzed for photograph in photographs], model=model, prior=prior)


def _measured_estimate(measured: MeasuredResponse) -> ResponseEstimate:
    """Return a measured response with its errors and its band; it has no families, no prior and no windows."""
    curve = measured.curve
    deviation = brightness_per_stop(curve) * np.hypot(measured.shape_stops, measured.scale_stops)
    band = np.clip(curve.brightness + np.outer([-BAND_DEVIATIONS, BAND_DEVIATIONS], deviation), 0, 1)
    error = float(np.linalg.norm(deviation))
    return ResponseEstimate(
        curve=curve,
        weights=EmorBasis.load().project(curve.brightness),
        windows=(),
        uncertainty=error,
        shape_uncertainty=measured.shape_stops,
        band=band,
        families={},
        verdict=Verdict.of_errors(measured.shape_stops, error),
        prior="",
        origins=(),
        warnings=tuple(map(Notice.from_text, measured.warnings)),
        model="",
        photos=(),
    )


def brightness_per_stop(curve: ResponseCurve) -> Float64Array:
    """Return by how much brightness rises with a stop more light, at the samples of a response, shape (1024,).

    An error of some stops in the light is one of so many times this in brightness. The jump of a camera that clips
    below the largest code is none: it stays at white.
    """
    rise = np.gradient(curve.brightness, curve.irradiance)
    rise[-2:] = np.minimum(rise[-2:], rise[-3])
    return np.asarray(np.log(2) * curve.irradiance * rise)


def _other_cameras(camera: Camera, own: ResponseEstimate) -> list[Notice]:
    """Return a warning if the files say that another camera took them."""
    name = camera.settings.camera
    others = dict.fromkeys(origin.camera for origin in own.origins if origin.camera)
    return [
        Notice("other_camera", {"other": other, "name": camera.name, "camera": name})
        for other in others
        if name and other.casefold() != name.casefold()
    ]


def _read_by(camera: Camera) -> str:
    """Return the networks that read a camera's photographs, in words."""
    return ", ".join(dict.fromkeys(photograph.model for photograph in camera.photographs)) or "none"
