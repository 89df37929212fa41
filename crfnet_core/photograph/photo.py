"""A photograph in the encoding of its file, and the integer samples of an encoded image."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.arrays import (
    ColorOrder,
    HasArrayInterface,
    check_range,
    has_equal_channels,
    pixels_from_array,
)
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.types import Float32Array

CodeArray = NDArray[np.uint8] | NDArray[np.uint16]


class Photo:
    """A photograph in the encoding of its file.

    `crfnet_core.read_photo` reads one, and `from_array` takes an array; the constructor only checks. Photographs
    compare by identity. One that was read from a file holds its codes, which need a quarter of the memory:
    `photo[::8, ::8]` computes `photo.pixels[::8, ::8]` and no more. The first use of `pixels` computes and keeps all.

    Parameters
    ----------
    pixels : ndarray, float32, shape (H, W, 3), or CodeValues
        Code values divided by the largest code, in [0, 1]; upright, as EXIF asks. Or the codes of a file.
    bit_depth : int
        Bits per sample of the file: 8, 10, 12 or 16; of floating-point numbers, the bits of their type.
    is_gray : bool
        Whether the three channels are equal everywhere.
    path : Path
        The file; of an array its name.
    metadata : FileMetadata, optional
        The metadata of the file; None for photographs that were not read from a file of their own.

    Raises
    ------
    PhotoError
        If the pixels are of another type or shape, or not all in [0, 1].
    """

    def __init__(
        self,
        pixels: Float32Array | CodeValues,
        bit_depth: int,
        is_gray: bool,
        path: str | Path,
        metadata: FileMetadata | None = None,
    ) -> None:
        self.bit_depth, self.is_gray, self.path, self.metadata = bit_depth, is_gray, Path(path), metadata
        if not isinstance(pixels, CodeValues):
            _check_pixels(pixels, self.path)
        self._samples = pixels

    @classmethod
    def from_codes(cls, values: CodeValues, path: Path) -> Photo:
        """Return the photograph with the samples of a file."""
        samples = replace(values, header=None)  # a header cannot go to another process
        return cls(samples, values.bit_depth, values.is_gray, path, values.metadata)

    @classmethod
    def from_array(
        cls,
        array: ArrayLike | HasArrayInterface,
        *,
        color_order: ColorOrder | None = None,
        bit_depth: int | None = None,
        is_associated: bool = False,
        name: str = "array",
        metadata: FileMetadata | None = None,
    ) -> Photo:
        """Return the photograph in an array of NumPy, OpenCV, or whatever NumPy makes an array of, or a Pillow image.

        The array holds the codes that the camera wrote: neither linearized nor converted to another color space, and
        at its full size. It is copied.

        Parameters
        ----------
        array : array_like, shape (H, W) or (H, W, C), C from 1 to 4; or a Pillow image of mode L, LA, RGB, RGBA or I;16
            uint8 from 0 to 255; uint16 from 0 to 2 ** bit_depth - 1; or floating point in [0, 1].
        color_order : "RGB", "BGR", "RGBA", "BGRA", "L" or "LA", optional
            The channels; needed for arrays with more than one. OpenCV reads and writes BGR. Alpha is dropped.
        bit_depth : int, optional
            Bits per sample, 8 to 16; needed for uint16.
        is_associated : bool
            Whether the color was multiplied by alpha, so that it must be divided by it.
        name : str
            The name of the photograph in reports and errors.
        metadata : FileMetadata, optional
            The camera and the programs that changed the photograph, if known; an array has no metadata by itself.

        Raises
        ------
        PhotoError
            If the array is of another type or shape, its values are out of range, or the order of its channels or the
            bit depth is not known.
        """
        pixels, bits = pixels_from_array(
            array, color_order=color_order, bit_depth=bit_depth, is_associated=is_associated, name=name
        )
        return cls(pixels, bits, has_equal_channels(pixels), name, metadata)

    def with_metadata(self, metadata: FileMetadata | None) -> Photo:
        """Return the same photograph with other metadata; the samples are shared."""
        other = copy(self)
        other.metadata = metadata
        return other

    @cached_property
    def pixels(self) -> Float32Array:
        """The pixels, float32, shape (H, W, 3), in [0, 1]."""
        return self[()]

    def __getitem__(self, index: Any) -> Float32Array:
        """Return some of the pixels: `pixels[index]`, for an index of rows and columns."""
        return self._samples.pixels(index) if isinstance(self._samples, CodeValues) else self._samples[index]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of `pixels`, (H, W, 3)."""
        return (self._samples.codes if isinstance(self._samples, CodeValues) else self._samples).shape

    def __repr__(self) -> str:
        """Return the facts of the photograph, without its pixels."""
        return f"Photo({str(self.path)!r}, shape={self.shape}, bit_depth={self.bit_depth}, is_gray={self.is_gray})"


def _check_pixels(pixels: object, path: Path) -> None:
    """Refuse pixels that are not float32 of shape (H, W, 3) in [0, 1]."""
    is_sound = isinstance(pixels, np.ndarray) and pixels.dtype == np.float32 and pixels.shape[2:] == (3,)
    if not isinstance(pixels, np.ndarray) or not is_sound or not pixels.size:
        shape = np.shape(pixels) if isinstance(pixels, np.ndarray) else ()
        kind = f"{type(pixels).__name__} {getattr(pixels, 'dtype', '')}"
        raise PhotoError("photo_pixels", path=path, kind=kind, shape=shape)
    check_range(pixels, str(path))


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
        The metadata of the file.
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
        return has_equal_channels(self.codes)

    def pixels(self, index: Any = ()) -> Float32Array:
        """Return code / largest in [0, 1], rounded to float32, shape (H, W, 3); divided by alpha if associated.

        Parameters
        ----------
        index : index of rows and columns
            Which pixels; by default all.
        """
        codes = self.codes[index]
        if self.alpha is None or not self.is_associated:
            return np.asarray(np.divide(codes, np.float32(self.largest), dtype=np.float32))
        alpha = self.alpha[index][..., None]
        pixels = np.zeros(codes.shape, np.float32)
        np.divide(codes, alpha, out=pixels, where=alpha > 0, dtype=np.float32)
        return np.asarray(np.minimum(pixels, 1, out=pixels))
