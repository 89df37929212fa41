# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels that are not in a file of their own: packed and painted images, and the frame of a movie that is shown."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..work.errors import AddonError

if TYPE_CHECKING:
    from crfnet_core.types import Float32Array, Uint8Array

#: The attribute of an editor that holds the number of the frame it shows.
_USERS = {"IMAGE_EDITOR": "image_user", "CLIP_EDITOR": "clip_user"}


def is_painted(datablock: bpy.types.ID) -> bool:
    """Return whether an image shows what was generated or painted in Blender; a packed file does not count then."""
    return isinstance(datablock, bpy.types.Image) and datablock.source == "GENERATED"


def has_own_file(datablock: bpy.types.ID) -> bool:
    """Return whether the code values of an image or clip lie in files on disk, not in the .blend file or in memory."""
    return not isinstance(datablock, bpy.types.Image) or not (datablock.packed_file or is_painted(datablock))


def file_name(image: bpy.types.Image) -> Path:
    """Return the name of the packed file of an image; without one, the name of the image with the suffix .png."""
    packed = "" if is_painted(image) else Path(image.filepath.replace("\\", "/")).name
    return Path(packed or f"{Path(bpy.path.clean_name(image.name)).stem}.png")


def codes_of_pixels(image: bpy.types.Image) -> Uint8Array:
    """Return the code values of an 8-bit image, shape (H, W, 3 or 4), the top row first, whatever its color space.

    Raise AddonError if the image has no pixels.
    """
    width, height = image.size
    if not width * height or not len(image.pixels):
        raise AddonError(f"{image.name}: has no pixels; open a photograph")
    codes = np.rint(pixels_of(image) * 255).astype(np.uint8).reshape(height, width, image.channels)[::-1]
    is_opaque = image.channels == 4 and bool((codes[..., 3] == 255).all())
    return np.ascontiguousarray(codes[..., :3] if is_opaque else codes)


def pixels_of(image: bpy.types.Image) -> Float32Array:
    """Return the pixels that Blender has of an image, float32, shape (H * W * C,), the bottom row first."""
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels


def shown_number(movie: bpy.types.Image | bpy.types.MovieClip) -> int:
    """Return the number, from 1, of the frame that the active editor shows; outside an editor, of the scene's frame."""
    space = bpy.context.space_data
    user = getattr(space, _USERS.get(getattr(space, "type", ""), ""), None)
    number = user.frame_current if user else bpy.context.scene.frame_current
    return min(max(1, number), max(1, movie.frame_duration))


def codes_of_frame(movie: bpy.types.Image | bpy.types.MovieClip, number: int) -> Uint8Array | None:
    """Return the code values of a frame, shape (H, W, 3 or 4), the top row first; None above 8 bits.

    Blender decodes these movies to floats, which are not code values. It takes the number of a frame only where it
    scales, so a copy is scaled to its own size and discarded. Raise AddonError if Blender cannot decode the frame.
    """
    image = None
    try:
        is_image = isinstance(movie, bpy.types.Image)
        image = movie.copy() if is_image else bpy.data.images.load(bpy.path.abspath(movie.filepath))
        if image.is_float:
            return None
        image.scale(*image.size, frame=number)
        return codes_of_pixels(image)
    except RuntimeError:
        raise AddonError(
            f"{movie.name}: frame {number} cannot be read; find its file with File, External Data"
        ) from None
    finally:
        if image is not None:
            bpy.data.images.remove(image)
