# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame of a movie that an editor shows, as the code values in Blender's own buffer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..work.errors import AddonError
from .packed_images import codes_of_pixels

if TYPE_CHECKING:
    from crfnet_core.types import Uint8Array

#: The attribute of an editor that holds the number of the frame it shows.
_USERS = {"IMAGE_EDITOR": "image_user", "CLIP_EDITOR": "clip_user"}


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
