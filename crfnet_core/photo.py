"""A photograph: the code values that the camera or the developer wrote, before any colour management."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crfnet_core.metadata.file_metadata import FileMetadata
from crfnet_core.types import Float32Array

CodeArray = NDArray[np.uint8] | NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class Photo:
    """A photograph in the encoding of its file.

    Parameters
    ----------
    pixels : ndarray, float32, shape (H, W, 3)
        Code values divided by the largest code, in [0, 1]; rows and columns as stored, whatever the EXIF orientation.
    bit_depth : int
        Bits per sample of the file: 8, 10, 12 or 16.
    is_gray : bool
        Whether the three channels are equal everywhere.
    path : Path
        The file.
    metadata : FileMetadata, optional
        What the file says beside the pixels; None for photographs that were not read from a file of their own.
    """

    pixels: Float32Array
    bit_depth: int
    is_gray: bool
    path: Path
    metadata: FileMetadata | None = None


@dataclass(frozen=True, eq=False)
class CodeValues:
    """The integer samples of an encoded image, and its header.

    Parameters
    ----------
    codes : ndarray, uint8 or uint16, shape (H, W, 3)
        Code values, 0 to 2 ** bit_depth - 1.
    alpha : ndarray of the same type, shape (H, W), or None
        Coverage, on the same scale.
    bit_depth : int
        Bits per sample of the file: 8, 10, 12 or 16.
    is_associated : bool
        Whether the file stores its code values multiplied by alpha.
    header : OpenImageIO.ImageSpec
        The header, with all that OpenImageIO read.
    metadata : FileMetadata
        What the file says beside the pixels.
    """

    codes: CodeArray
    alpha: CodeArray | None
    bit_depth: int
    is_associated: bool
    header: Any
    metadata: FileMetadata

    @property
    def largest(self) -> int:
        """The largest code: 255 for 8 bits, 1023 for 10, 4095 for 12, 65535 for 16."""
        return int(2**self.bit_depth - 1)

    @property
    def is_gray(self) -> bool:
        """Whether the three channels are equal everywhere."""
        red, *others = (self.codes[..., channel] for channel in range(3))
        sparse = np.s_[::16, ::16]
        return all(bool((red[part] == other[part]).all()) for part in (sparse, np.s_[:]) for other in others)

    def pixels(self) -> Float32Array:
        """Return code / largest in [0, 1], rounded to float32, shape (H, W, 3); divided by alpha if associated."""
        if self.alpha is None or not self.is_associated:
            return np.divide(self.codes, np.float32(self.largest), dtype=np.float32)
        alpha = self.alpha[..., None]
        pixels = np.zeros(self.codes.shape, np.float32)
        np.divide(self.codes, alpha, out=pixels, where=alpha > 0, dtype=np.float32)
        return np.minimum(pixels, 1, out=pixels)
