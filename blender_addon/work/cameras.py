# SPDX-License-Identifier: GPL-3.0-or-later
"""The stored cameras that a plate's response may be taken from: those of `crfnet camera`, in the same folder."""

from __future__ import annotations

from collections.abc import Collection

from crfnet_core.cameras import CameraLibrary


def stored_cameras(text: str = "", models: Collection[str] = ()) -> list[tuple[str, str]]:
    """Return the names of stored cameras that hold a text, each with what its response rests on.

    Parameters
    ----------
    text : str
        What the user has typed so far, in upper or lower case.
    models : collection of str
        Make and model of the plate's camera, as `FileOrigin.camera` has them: such cameras come first, then the user's
        own, then those that come with the add-on.
    """
    wanted = {model.casefold() for model in models}
    cameras = {
        camera.name: camera
        for library in (CameraLibrary.of_user(), CameraLibrary.shipped())
        for camera in library.cameras()
        if text.casefold() in camera.name.casefold()
    }
    ordered = sorted(cameras.values(), key=lambda camera: camera.settings.camera.casefold() not in wanted)
    return [(camera.name, camera.basis) for camera in ordered]
