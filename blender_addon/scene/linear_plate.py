# SPDX-License-Identifier: GPL-3.0-or-later
"""A baked linear plate as an image or clip, beside the plate that it was made from."""

from __future__ import annotations

import bpy

from ..work.writers import Baked
from . import stored_estimate
from .node_group import linear_rec709
from .plates import Datablock


def linear_image(plate: bpy.types.Image, baked: Baked) -> bpy.types.Image:
    """Return the linear plate as an image in linear Rec.709; one that is loaded already is read again."""
    image = bpy.data.images.load(str(baked.files[0]), check_existing=True)
    image.source = "SEQUENCE" if baked.is_sequence else "FILE"
    image.filepath = _path_like(plate, image.filepath)
    image.reload()
    image.colorspace_settings.name = linear_rec709()
    return image


def linear_clip(plate: bpy.types.MovieClip, baked: Baked) -> bpy.types.MovieClip:
    """Return the linear plate as a clip in linear Rec.709, with the plate's timing, tracks and camera.

    A clip of these files that is loaded already keeps its own tracks and camera.
    """
    first = str(baked.files[0])
    clip = next((clip for clip in bpy.data.movieclips if bpy.path.abspath(clip.filepath) == first), None)
    if clip is None:
        clip = plate.copy()
        clip.name = baked.files[0].name
        clip.pop(stored_estimate.KEY, None)
        clip.property_unset("camera_response_settings")
        clip.use_proxy = False  # its proxies show the plate
        clip.filepath = _path_like(plate, first)
    clip.frame_start, clip.frame_offset = plate.frame_start, plate.frame_offset
    clip.colorspace_settings.name = linear_rec709()
    return clip


def _path_like(plate: Datablock, path: str) -> str:
    """Return a path relative to the .blend file if that of the plate is, else as it is."""
    return bpy.path.relpath(path) if plate.filepath.startswith("//") and bpy.data.filepath else path
