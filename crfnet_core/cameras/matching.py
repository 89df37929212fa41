"""Cameras of the library that a photograph's metadata fit: offered, never used unasked."""

from __future__ import annotations

import math
from contextlib import suppress

from crfnet_core.cameras.answer import compared
from crfnet_core.cameras.camera import Camera, CameraSettings
from crfnet_core.cameras.library import CameraLibrary
from crfnet_core.errors import CameraError
from crfnet_core.posterior import Prior
from crfnet_core.response_estimate import CameraAnswer, ResponseEstimate


def matching_cameras(settings: CameraSettings) -> list[Camera]:
    """Return the cameras of a make and model: the user's own first, then by sensitivity, the nearest first.

    Parameters
    ----------
    settings : CameraSettings
        Of a photograph; if it names no camera, nothing fits.
    """
    if not settings.camera:
        return []
    own, shipped = (
        [camera for camera in library.cameras() if camera.settings.camera.casefold() == settings.camera.casefold()]
        for library in (CameraLibrary.of_user(), CameraLibrary.shipped())
    )
    names = {camera.name.casefold() for camera in own}
    shipped = [camera for camera in shipped if camera.name.casefold() not in names]

    def nearest(camera: Camera) -> float:
        return _stops_away(camera, settings)

    return [*sorted(own, key=nearest), *sorted(shipped, key=nearest)]


def offered_cameras(
    own: ResponseEstimate, settings: CameraSettings, *, prior: Prior | None = None
) -> list[CameraAnswer]:
    """Return the cameras that fit a photograph, with how far its own estimate is from their responses.

    Parameters
    ----------
    own : ResponseEstimate
        What is estimated from the photograph.
    settings : CameraSettings
        What its file says.
    prior : Prior, optional
        As of `crfnet_core.estimate_response`.
    """
    offers = []
    for camera in matching_cameras(settings):
        with suppress(CameraError):  # evidence of another network alone
            offers.append(compared(own, camera, prior=prior))
    return offers


def _stops_away(camera: Camera, settings: CameraSettings) -> float:
    """Return how many stops a photograph's sensitivity is from the nearest of a camera's; infinite if unknown."""
    pairs = ((own, other) for own in camera.settings.iso for other in settings.iso)
    return min((abs(math.log2(own / other)) for own, other in pairs), default=math.inf)
