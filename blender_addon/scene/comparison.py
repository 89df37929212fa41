# SPDX-License-Identifier: GPL-3.0-or-later
"""Show the linear plate instead of the plate in an Image Editor, and go back.

The linear plate is a hidden float image in memory. The plate itself is not touched, and the float image is removed
before the file is saved, before undo, and when the last editor goes back to the plate.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from crfnet_core.types import Float32Array

#: The custom property that marks a linear plate that is only shown; its value is the plate.
PLATE = "camera_response_plate"

#: The name of these images; a leading dot hides them in menus.
_NAME = ".Camera Response Linear"


def plate_of(image: bpy.types.Image | None) -> bpy.types.Image | None:
    """Return the plate of which an image is the linear one that is only shown; None for any other image."""
    return None if image is None else image.get(PLATE)


def begin(space: bpy.types.SpaceImageEditor, pixels: Float32Array, color_space: str) -> None:
    """Show the linear plate in an editor that shows the plate.

    Parameters
    ----------
    space : SpaceImageEditor
        The editor.
    pixels : ndarray, float32, shape (H, W, 4)
        The linear plate, multiplied by alpha, the bottom row first.
    color_space : str
        The name of its colour space.
    """
    plate = space.image
    height, width = pixels.shape[:2]
    linear = bpy.data.images.new(_NAME, width, height, alpha=True, float_buffer=True)
    linear[PLATE] = plate
    linear.colorspace_settings.name = color_space  # before the pixels, which this would remove
    linear.pixels.foreach_set(pixels.ravel())
    linear.update()
    space.image = linear


def end(space: bpy.types.SpaceImageEditor) -> None:
    """Show the plate again in an editor that shows its linear one, which is removed unless another editor shows it."""
    linear, plate = space.image, plate_of(space.image)
    if linear is None or PLATE not in linear:
        return
    space.image = plate
    if all(other.image != linear for other in _image_editors()):
        bpy.data.images.remove(linear)


def end_all() -> None:
    """Show the plates again everywhere, and remove all linear plates that were only shown."""
    for space in _image_editors():
        if space.image is not None and PLATE in space.image:
            space.image = plate_of(space.image)
    for image in [image for image in bpy.data.images if PLATE in image]:
        bpy.data.images.remove(image)


def _image_editors() -> Iterator[bpy.types.SpaceImageEditor]:
    """Yield all Image Editors, those of other workspaces included."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            yield from (space for space in area.spaces if space.type == "IMAGE_EDITOR")
