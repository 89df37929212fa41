# SPDX-License-Identifier: GPL-3.0-or-later
"""The code values of an image as an editor shows it, and the linear plate that a response makes of them."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

from crfnet_core import ResponseCurve
from crfnet_core.image_io import read_photo
from crfnet_core.types import Float32Array

from ..work.errors import AddonError

#: The largest code value of the look-up table: a multiple of 255, so it is exact on 8 and on 16 bits.
_LARGEST = 65535

#: Rows that are converted at a time: few enough to stay in the processor's cache.
_ROWS = 16


def code_values(image: bpy.types.Image, user: bpy.types.ImageUser) -> Float32Array:
    """Return the code values of an image, those of the frame that an editor shows.

    Returns
    -------
    ndarray, float32, shape (H, W, 3 or 4)
        In [0, 1], the bottom row first, colours not multiplied by alpha.

    Raises
    ------
    AddonError
        If Blender cannot read the image.
    PhotoError
        If its file cannot be read.
    """
    width, height = image.size
    if not width * height:
        raise AddonError(f"{image.name}: cannot be read; find its file with File, External Data")
    if image.is_float and not image.packed_file:  # its pixels are linear light by the color space, not code values
        return read_photo(Path(image.filepath_from_user(image_user=user))).pixels[::-1]
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, image.channels)
    return pixels if image.channels >= 3 else pixels[..., :1].repeat(3, axis=2)


def linear_pixels(codes: Float32Array, curve: ResponseCurve, stops: float) -> Float32Array:
    """Return the linear plate of code values.

    Parameters
    ----------
    codes : ndarray, float32, shape (H, W, 3 or 4)
        Code values, as `code_values` returns them.
    curve : ResponseCurve
        The plate's response.
    stops : float
        Stops added after the inverse response.

    Returns
    -------
    ndarray, float32, shape (H, W, 4)
        In linear Rec.709, multiplied by alpha.
    """
    table = (curve.inverse(np.arange(_LARGEST + 1) / _LARGEST) * 2**stops).astype(np.float32)
    linear = np.empty((*codes.shape[:2], 4), np.float32)
    for start in range(0, len(codes), _ROWS):
        rows = slice(start, start + _ROWS)
        index = (codes[rows] * _LARGEST + 0.5).astype(np.uint16)  # with alpha, too: one run of memory is faster
        linear[rows, :, :3] = np.take(table, index)[..., :3]
        linear[rows, :, 3:] = codes[rows, :, 3:] if codes.shape[2] == 4 else 1
        if linear[rows, :, 3].min() < 1:
            linear[rows, :, :3] *= linear[rows, :, 3:]
    return linear
