"""A photograph in the encoding of its file, and the integer samples of an encoded image."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.photograph.photo.arrays import (
    ColorOrder,
    HasArrayInterface,
    check_range,
    has_equal_channels,
    pixels_of_array,
)
from crfnet_core.types import Float32Array

CodeArray = NDArray[np.uint8] | NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class Photo:
    """A photograph in the encoding of its file.

    `crfnet_core.read_photo` reads one, and `from_array` takes an array; the constructor only checks. Photographs
    compare by identity. That of a file holds its codes, which need a quarter of the memory: `photo[::8, ::8]` are
    `photo.pixels[::8, ::8]`, and no more than these are computed. The first use of `pixels` computes and keeps all.

    Parameters
    ----------
    pixels : ndarray, float32, shape (H, W, 3)
        Code values divided by the largest code, in [0, 1]; rows and columns as stored, whatever the EXIF orientation.
    bit_depth : int
        Bits per sample of the file: 8, 10, 12 or 16; of an array of floating-point numbers, those of its type.
    is_gray : bool
        Whether the three channels are equal everywhere.
    path : Path
        The file; of an array its name.
    metadata : FileMetadata, optional
        What the file says beside the pixels; None for photographs that were not read from a file of their own.

    Raises
    ------
    PhotoError
        If the pixels are of another type or shape, or not all in [0, 1].
    """

    pixels: Float32Array = field(repr=False)
    bit_depth: int
    is_gray: bool
    path: Path
    metadata: FileMetadata | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", Path(self.path))
        pixels = np.asarray(self.pixels)
        if pixels is not self.pixels or pixels.dtype != np.float32 or pixels.shape[2:] != (3,) or not pixels.size:
            raise PhotoError(
                f"{self.path}: the pixels are {type(self.pixels).__name__}, {pixels.dtype}, shape {pixels.shape}; a"
                " Photo holds float32 of shape (H, W, 3): Photo.from_array converts"
            )
        check_range(self.pixels, str(self.path))

    @classmethod
    def from_codes(cls, values: CodeValues, path: Path) -> Photo:
        """Return the photograph with the samples of a file."""
        photo = cls.__new__(cls)
        facts = {"bit_depth": values.bit_depth, "is_gray": values.is_gray, "path": path, "metadata": values.metadata}
        vars(photo).update(facts, _values=replace(values, header=None))  # a header cannot go to another process
        return photo

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

        The array holds what the camera wrote: neither linearised nor converted to another colour space, and at its
        full size. It is copied.

        Parameters
        ----------
        array : array_like, shape (H, W) or (H, W, C), C from 1 to 4; or a Pillow image of mode L, LA, RGB, RGBA or I;16
            uint8 from 0 to 255; uint16 from 0 to 2 ** bit_depth - 1; or floating point in [0, 1].
        color_order : "RGB", "BGR", "RGBA", "BGRA", "L" or "LA", optional
            The channels; must be given of arrays with more than one. OpenCV reads and writes BGR. Alpha is dropped.
        bit_depth : int, optional
            Bits per sample, 8 to 16; must be given of uint16.
        is_associated : bool
            Whether the colour was multiplied by alpha, so that it must be divided by it.
        name : str
            What reports and errors call the photograph.
        metadata : FileMetadata, optional
            What is known of the camera and of programs that changed the photograph; an array has none by itself.

        Raises
        ------
        PhotoError
            If the array is of another type or shape, its values are out of range, or the order of its channels or the
            bit depth is not known.
        """
        pixels, bits = pixels_of_array(
            array, color_order=color_order, bit_depth=bit_depth, is_associated=is_associated, name=name
        )
        return cls(pixels, bits, has_equal_channels(pixels), Path(name), metadata)

    if not TYPE_CHECKING:  # mypy knows the field

        def __getattr__(self, name: str) -> Float32Array:
            """Compute the pixels of a file when they are first asked for."""
            if name != "pixels":
                raise AttributeError(name, name=name, obj=self)
            vars(self)["pixels"] = self._values.pixels()
            return self.pixels

    def __getitem__(self, index: Any) -> Float32Array:
        """Return some of the pixels: `pixels[index]`, for an index of rows and columns."""
        values: CodeValues | None = vars(self).get("_values")
        return self.pixels[index] if values is None else values.pixels(index)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of `pixels`, (H, W, 3)."""
        values: CodeValues | None = vars(self).get("_values")
        return (self.pixels if values is None else values.codes).shape


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
