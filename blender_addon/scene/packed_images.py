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


#: Suffixes of encoded images that Blender reads and the estimator does not: BMP, Targa, JPEG 2000.
DECODED_SUFFIXES = (".bmp", ".dib", ".tga", ".icb", ".vda", ".vst", ".jp2", ".j2c", ".j2k")


def name_and_content(image: bpy.types.Image) -> tuple[Path, bytes | Uint8Array]:
    """Return a file name for a packed or painted image, and what the file has to hold.

    Returns
    -------
    name : Path
        The name of the packed file, or that of the image with the suffix .png.
    content : bytes or ndarray, uint8, shape (H, W, 3 or 4)
        The packed file byte for byte, or the code values of an 8-bit image, the top row first: these are its pixels,
        whatever its colour space. A packed file that the estimator does not read is given as code values, too.

    Raises
    ------
    AddonError
        If the image has no pixels, or they are no code values.
    """
    name = Path(f"{Path(bpy.path.clean_name(image.name)).stem}.png")
    if image.packed_file:
        name = Path(Path(image.filepath.replace("\\", "/")).name or name)
        if name.suffix.lower() not in DECODED_SUFFIXES:
            return name, image.packed_file.data
    if image.is_float:
        raise AddonError(f"{image.name}: more than 8 bits are not read from a packed file of this format: unpack it")
    return name.with_suffix(".png"), _code_values(image)


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
