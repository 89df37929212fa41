# SPDX-License-Identifier: GPL-3.0-or-later
"""The packed file, or the code values, of an image that has no file of its own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..work.errors import AddonError

if TYPE_CHECKING:
    from crfnet_core.types import Uint8Array


def name_and_content(image: bpy.types.Image) -> tuple[Path, bytes | Uint8Array]:
    """Return a file name for a packed or painted image, and what the file has to hold.

    Returns
    -------
    name : Path
        The name of the packed file, or that of the image with the suffix .png.
    content : bytes or ndarray, uint8, shape (H, W, 3 or 4)
        The packed file byte for byte, or the code values of an 8-bit image, the top row first: these are its pixels,
        whatever its colour space.

    Raises
    ------
    AddonError
        If the image has no pixels.
    """
    name = Path(f"{Path(bpy.path.clean_name(image.name)).stem}.png")
    if image.packed_file:
        return Path(Path(image.filepath.replace("\\", "/")).name or name), image.packed_file.data
    return name, _code_values(image)


def _code_values(image: bpy.types.Image) -> Uint8Array:
    """Return the code values of an 8-bit image, shape (H, W, 3 or 4), the top row first."""
    width, height = image.size
    if not width * height or not len(image.pixels):
        raise AddonError(f"{image.name}: has no pixels; open a photograph")
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    codes = np.rint(pixels * 255).astype(np.uint8).reshape(height, width, image.channels)[::-1]
    is_opaque = image.channels == 4 and bool((codes[..., 3] == 255).all())
    return np.ascontiguousarray(codes[..., :3] if is_opaque else codes)
