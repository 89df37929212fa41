# SPDX-License-Identifier: GPL-3.0-or-later
"""Which images have no file of their own, and the packed file or the code values of these."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..work.errors import AddonError

if TYPE_CHECKING:
    from crfnet_core.types import Uint8Array


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


def content_of(image: bpy.types.Image) -> bytes | Uint8Array:
    """Return the packed file, or the code values, shape (H, W, 3 or 4), of a painted image of 8 bits.

    Its pixels are code values, whatever its color space. Raise AddonError if the image has no pixels.
    """
    return codes_of_pixels(image) if is_painted(image) else image.packed_file.data


def codes_of_pixels(image: bpy.types.Image) -> Uint8Array:
    """Return the code values of an 8-bit image, shape (H, W, 3 or 4), the top row first."""
    width, height = image.size
    if not width * height or not len(image.pixels):
        raise AddonError(f"{image.name}: has no pixels; open a photograph")
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    codes = np.rint(pixels * 255).astype(np.uint8).reshape(height, width, image.channels)[::-1]
    is_opaque = image.channels == 4 and bool((codes[..., 3] == 255).all())
    return np.ascontiguousarray(codes[..., :3] if is_opaque else codes)
