"""A photograph in the encoding of its file, the integer samples of an encoded image, and the turns of pictures."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError, check_kinds
from crfnet_core.photograph.arrays import ColorOrder, check_range, has_equal_channels, pixels_from_array
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.types import Float32Array

CodeArray = NDArray[np.uint8] | NDArray[np.uint16]

#: a, b, c, d, each -1, 0 or 1: a stored pixel (x, y) belongs at x' = a x + c y, y' = b x + d y, with y downwards.
Turn: TypeAlias = tuple[int, int, int, int]

UPRIGHT: Turn = (1, 0, 0, 1)

#: EXIF's Orientation -> turn (JEITA CP-3451, 4.6.4).
EXIF_TURNS: dict[int, Turn] = {
    **{1: UPRIGHT, 2: (-1, 0, 0, 1), 3: (-1, 0, 0, -1), 4: (1, 0, 0, -1)},
    **{5: (0, 1, 1, 0), 6: (0, 1, -1, 0), 7: (0, -1, -1, 0), 8: (0, -1, 1, 0)},
}


class Photo:
    """A photograph in the encoding of its file.

    `crfnet_core.read_photo` reads one, and `from_array` takes an array; the constructor only checks. Photographs
    compare by identity. One that was read from a file holds its codes, which need a quarter of the memory:
    `photo[::8, ::8]` computes `photo.pixels[::8, ::8]` and no more. The first use of `pixels` computes and keeps all.

    `pixels` are float32 (H, W, 3), upright code values divided by the largest code, or the `CodeValues` of a file.
    `bit_depth` counts the bits per sample; of floating-point numbers, of their type. `is_gray` says whether the three
    channels are equal everywhere. `path` is the file, or the name of an array. `metadata` is None without a file. Raise
    PhotoError if the pixels are of another type or shape, or not all in [0, 1].
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
            kind, shape = getattr(pixels, "dtype", type(pixels).__name__), np.shape(pixels)
            if kind != np.float32 or shape[2:] != (3,) or not pixels.size:
                raise PhotoError("photo_pixels", path=path, kind=kind, shape=shape)
            check_range(pixels, str(path))
            pixels = _read_only(pixels)
        self._samples = pixels

    @classmethod
    def from_codes(cls, values: CodeValues, path: Path) -> Photo:
        """Return the photograph with the samples of a file."""
        samples = replace(values, header=None)  # a header cannot go to another process
        return cls(samples, values.bit_depth, values.is_gray, path, values.metadata)

    @classmethod
    def from_array(
        cls,
        array: Any,
        *,
        color_order: ColorOrder | None = None,
        bit_depth: int | None = None,
        name: str = "array",
        metadata: FileMetadata | None = None,
    ) -> Photo:
        """Return the photograph in an array of NumPy, OpenCV, or whatever NumPy makes an array of, or a Pillow image.

        The array holds the codes that the camera wrote: neither linearized nor converted to another color space, and
        at its full size. It is copied. A Pillow image is turned upright, as its EXIF asks.

        Parameters
        ----------
        array : array_like, shape (H, W) or (H, W, C), C from 1 to 4; or a Pillow image of mode L, LA, RGB, RGBA or I;16
            uint8 from 0 to 255; uint16 from 0 to 2 ** bit_depth - 1; or floating point in [0, 1].
        color_order : "RGB", "BGR", "RGBA", "BGRA", "L" or "LA", optional
            The channels; needed for arrays with more than one. OpenCV reads and writes BGR. Alpha is dropped.
        bit_depth : int, optional
            Bits per sample, 8 to 16; needed for uint16.
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
        check_kinds(name=(name, str | Path), metadata=(metadata, FileMetadata | None))
        pixels, bits = pixels_from_array(array, color_order=color_order, bit_depth=bit_depth, name=name)
        return cls(pixels, bits, has_equal_channels(pixels), name, metadata)

    def with_metadata(self, metadata: FileMetadata | None) -> Photo:
        """Return the same photograph with other metadata; the samples are shared."""
        other = copy(self)
        other.metadata = metadata
        return other

    @cached_property
    def pixels(self) -> Float32Array:
        """The pixels, float32, shape (H, W, 3), in [0, 1]; read-only."""
        return _read_only(self[()])

    def __getitem__(self, index: Any) -> Float32Array:
        """Return some of the pixels: `pixels[index]`, for an index of rows and columns."""
        return self._samples.pixels(index) if isinstance(self._samples, CodeValues) else self._samples[index]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of `pixels`, (H, W, 3)."""
        return (self._samples.codes if isinstance(self._samples, CodeValues) else self._samples).shape


@dataclass(frozen=True, eq=False)
class CodeValues:
    """The integer samples of an encoded image, and its header."""

    codes: CodeArray  # shape (H, W, 3), 0 to 2 ** bit_depth - 1
    alpha: CodeArray | None  # coverage, shape (H, W), on the same scale
    bit_depth: int  # bits per sample of the file: 8, 10, 12, 14 or 16
    is_associated: bool  # whether the file stores its codes multiplied by alpha
    header: Any  # an OpenImageIO.ImageSpec, with all that OpenImageIO read
    metadata: FileMetadata

    @classmethod
    def from_samples(cls, samples: NDArray[Any], bit_depth: int, header: Any, metadata: FileMetadata) -> CodeValues:
        """Return decoded samples, shape (H, W, C), as three channels and the alpha that `header` names."""
        channels, alpha = samples.shape[2], header.alpha_channel
        has_alpha = 0 < alpha < channels
        is_gray = channels < 3 or header.get_int_attribute("tiff:PhotometricInterpretation", 2) in (0, 1)
        return cls(
            codes=samples[..., :3] if not is_gray else np.repeat(samples[..., :1], 3, axis=2),
            alpha=samples[..., alpha] if has_alpha else None,
            bit_depth=bit_depth,
            is_associated=has_alpha and not header.get_int_attribute("oiio:UnassociatedAlpha"),
            header=header,
            metadata=metadata,
        )

    @property
    def largest(self) -> int:
        """The largest code, such as 255 for 8 bits."""
        return int(2**self.bit_depth - 1)

    @property
    def is_gray(self) -> bool:
        """Whether the three channels are equal everywhere."""
        return has_equal_channels(self.codes)

    def pixels(self, index: Any = ()) -> Float32Array:
        """Return code / largest in [0, 1], float32 (H, W, 3), of some rows and columns; associated alpha is undone."""
        codes = self.codes[index]
        if self.alpha is None or not self.is_associated:
            return np.asarray(np.divide(codes, np.float32(self.largest), dtype=np.float32))
        alpha = self.alpha[index][..., None]
        pixels = np.zeros(codes.shape, np.float32)
        np.divide(codes, alpha, out=pixels, where=alpha > 0, dtype=np.float32)
        return np.asarray(np.minimum(pixels, 1, out=pixels))


def _read_only(pixels: Float32Array) -> Float32Array:
    """Return a view of pixels that does not let them be changed, as nobody would check them again."""
    view = pixels.view()
    view.flags.writeable = False
    return view


def upright(pixels: NDArray[Any], turn: Turn) -> NDArray[Any]:
    """Return pixels, shape (H, W, ...), turned and mirrored by quarter turns."""
    a, b, c, d = turn
    if a == 0:
        pixels = pixels.swapaxes(0, 1)
    columns, rows = (c, b) if a == 0 else (a, d)
    return np.ascontiguousarray(pixels[:: rows or 1, :: columns or 1])
