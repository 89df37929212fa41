"""Cameras of the library that a photograph's metadata fit: offered, never used unasked."""

from __future__ import annotations

import math
from collections.abc import Collection
from contextlib import suppress

from crfnet_core.errors import CameraError
from crfnet_core.estimate.result import CameraAnswer, ResponseEstimate
from crfnet_core.library.answer import compared
from crfnet_core.library.camera import Camera, CameraSettings
from crfnet_core.library.library import known_cameras
from crfnet_core.posterior import Prior


def matching_cameras(settings: CameraSettings) -> list[Camera]:
    """Return the cameras of a make and model: the user's own first, then by sensitivity, the nearest first.

    Parameters
    ----------
    settings : CameraSettings
        Of a photograph; if it names no camera, nothing fits.
    """
    if not settings.camera:
        return []

    def nearest(camera: Camera) -> float:
        return _stops_away(camera, settings)

    model = settings.camera.casefold()
    return [
        camera
        for cameras in known_cameras()
        for camera in sorted(cameras, key=nearest)
        if camera.settings.camera.casefold() == model
    ]


def listed_cameras(text: str = "", models: Collection[str] = ()) -> list[tuple[str, str]]:
    """Return the names of all cameras that hold a text, each with what its response rests on, to choose from.

    Parameters
    ----------
    text : str
        What has been typed so far, in upper or lower case.
    models : collection of str
        Make and model of a plate's camera, as `FileOrigin.camera` has them: such cameras come first, then the user's
        own, then those that come with this project.
    """
    wanted = {model.casefold() for model in models}
    cameras = [camera for known in known_cameras() for camera in known if text.casefold() in camera.name.casefold()]
    ordered = sorted(cameras, key=lambda camera: camera.settings.camera.casefold() not in wanted)
    return [(camera.name, camera.basis) for camera in ordered]


def offered_cameras(
    own: ResponseEstimate, settings: CameraSettings, *, prior: Prior | None = None
) -> list[CameraAnswer]:
    """Return the cameras that fit a photograph, with how far its own estimate is from their responses.

    None fits one that a program developed from a raw file, because its response is not the camera's.

    Parameters
    ----------
    own : ResponseEstimate
        What is estimated from the photograph.
    settings : CameraSettings
        What its file says.
    prior : Prior, optional
        As of `crfnet_core.estimate_response`.
    """
    if any(origin.is_developed for origin in own.origins):
        return []
    offers = []
    for camera in matching_cameras(settings):
        with suppress(CameraError):  # evidence of another network alone
            offers.append(compared(own, camera, prior=prior))
    return offers


def _stops_away(camera: Camera, settings: CameraSettings) -> float:
    """Return how many stops a photograph's sensitivity is from the nearest of a camera's; infinite if unknown."""
    pairs = ((own, other) for own in camera.settings.iso for other in settings.iso)
    return min((abs(math.log2(own / other)) for own, other in pairs), default=math.inf)
