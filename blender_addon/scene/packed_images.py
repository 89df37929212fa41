# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the code values of an image that has no file of its own to a temporary file."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy as np
import OpenImageIO as oiio

from ..work.errors import AddonError


def written_temporarily(image: bpy.types.Image) -> Path:
    """Return a file, in Blender's folder for the session, with the code values of a packed or generated image.

    A packed file is written as it is, byte by byte. An 8-bit generated image becomes a PNG: its pixels are code values
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


def _code_values(image: bpy.types.Image) -> np.ndarray:
    """Return an 8-bit image's codes, shape (H, W, 3 or 4), the top row first."""
    width, height = image.size
    if not width * height or not len(image.pixels):
        raise AddonError(f"{image.name}: has no pixels; open a photograph")
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    codes = np.rint(pixels * 255).astype(np.uint8).reshape(height, width, image.channels)[::-1]
    is_opaque = image.channels == 4 and bool((codes[..., 3] == 255).all())
    return np.ascontiguousarray(codes[..., :3] if is_opaque else codes)


def _write_png(path: Path, codes: np.ndarray) -> None:
    """Write codes as they are, alpha not multiplied in."""
    header = oiio.ImageSpec(codes.shape[1], codes.shape[0], codes.shape[2], oiio.UINT8)
    header.attribute("oiio:UnassociatedAlpha", 1)
    header.attribute("png:compressionLevel", 1)
    output = oiio.ImageOutput.create(str(path))
    if not (output and output.open(str(path), header) and output.write_image(codes) and output.close()):
        raise AddonError(f"{path}: cannot be written ({oiio.geterror() or output.geterror()}); free some space")
