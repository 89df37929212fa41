# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the code values of an image that has no file of its own, packed or generated, to a temporary file."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio

from crfnet_core.types import Uint8Array

from ..work.errors import AddonError


def write_temporary_file(image: bpy.types.Image) -> Path:
    """Write the code values of a packed or generated image to a file in Blender's temporary folder; return its path.

    A packed file is written byte for byte. A generated 8-bit image becomes a PNG file: its pixels are code values,
    whatever its colour space.

    Raises
    ------
    AddonError
        If the image has no pixels, or the file cannot be written.
    """
    folder = Path(tempfile.mkdtemp(prefix="crf_", dir=bpy.app.tempdir or None))
    try:
        if image.packed_file:
            path = folder / (Path(image.filepath.replace("\\", "/")).name or f"{Path(image.name).stem}.png")
            path.write_bytes(image.packed_file.data)
            return path
        path = folder / f"{Path(bpy.path.clean_name(image.name)).stem}.png"
        _write_png(path, _code_values(image))
    except OSError as problem:
        raise AddonError(
            f"{image.name}: no temporary file can be written ({problem.strerror}); free some space"
        ) from None
    return path


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


def _write_png(path: Path, codes: Uint8Array) -> None:
    """Write code values unchanged: colours are not multiplied by alpha."""
    header = oiio.ImageSpec(codes.shape[1], codes.shape[0], codes.shape[2], oiio.UINT8)
    header.attribute("oiio:UnassociatedAlpha", 1)
    header.attribute("png:compressionLevel", 1)  # the fastest: the file is read once
    output = oiio.ImageOutput.create(str(path))
    if output is None:
        raise AddonError(f"{path}: cannot be written ({oiio.geterror()}); install Blender again")
    if not (output.open(str(path), header) and output.write_image(codes) and output.close()):
        raise AddonError(f"{path}: cannot be written ({output.geterror()}); free some space")
