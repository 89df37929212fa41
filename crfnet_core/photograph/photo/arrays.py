"""Pixels from arrays: what they must hold, and how they become encoded brightness in [0, 1].

Neither Pillow nor OpenCV is imported: their images are known by NumPy's array interface, Pillow's also by `mode`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.types import Float32Array

#: The channels of an array, in their order; "A" is alpha. OpenCV's order is BGR, that of nearly all others RGB.
ColorOrder = Literal["L", "LA", "RGB", "RGBA", "BGR", "BGRA"]

#: Least bits per sample: fewer show no response.
LEAST_BITS = 8

#: Modes of Pillow's images whose arrays hold code values as they are, and the order of their channels.
PILLOW_MODES: dict[str, ColorOrder] = {
    "L": "L",
    "LA": "LA",
    "RGB": "RGB",
    "RGBA": "RGBA",
    **dict.fromkeys(("I;16", "I;16L", "I;16B", "I;16N"), "L"),
}

#: What to do about images of other modes; where nothing is said, Pillow's conversion to RGB is harmless.
_NO_RGB = "which hides the camera's response; give the RGB photograph that it came from"
_OTHER_MODES = {
    "P": "a palette, from which no response can be estimated; give the photograph that it was made from",
    "CMYK": _NO_RGB,
    "LAB": _NO_RGB,
    "RGBa": "associated alpha; give image.convert('RGBA')",
    "I": "32 bits; give numpy.asarray(image).astype('uint16') with its bit_depth",
    "F": "floating point; give numpy.asarray(image), scaled to [0, 1]",
}


class HasArrayInterface(Protocol):
    """What NumPy makes an array of, such as an image of Pillow."""

    @property
    def __array_interface__(self) -> dict[str, Any]:
        """NumPy's description of the memory."""


def pixels_of_array(
    array: ArrayLike | HasArrayInterface,
    *,
    color_order: ColorOrder | None,
    bit_depth: int | None,
    is_associated: bool,
    name: str,
) -> tuple[Float32Array, int]:
    """Return new pixels in R, G, B, float32 (H, W, 3) in [0, 1], and the bits per sample; see `Photo.from_array`.

    Raises
    ------
    PhotoError
        If the array is none of those that `Photo.from_array` takes.
    """
    order = _stated_order(array, color_order, name)
    values = _samples(array, name)
    order = _checked_order(values, order, name)
    bits = _checked_bits(values, bit_depth, name)
    planes = np.atleast_3d(values)
    if values.dtype.kind == "f":
        check_range(planes, name)
        planes = planes.astype(np.float32)
    else:
        planes = _encoded(planes, bits, name)
    color = planes[..., [order.index(letter) for letter in ("RGB" if "R" in order else "LLL")]]
    if is_associated and "A" in order:
        color = _divided(color, planes[..., order.index("A")])
    return np.ascontiguousarray(color), bits


def check_range(pixels: NDArray[np.floating], name: str) -> None:
    """Refuse floating-point pixels that are not encoded brightness in [0, 1]."""
    low, high = float(pixels.min()), float(pixels.max())
    if low >= 0 and high <= 1:
        return
    if np.isnan(low):
        raise PhotoError(f"{name}: holds NaN; replace it, or leave these rows and columns out")
    raise PhotoError(
        f"{name}: holds values from {low:g} to {high:g}; encoded brightness lies in [0, 1]: divide code values by the"
        " largest (255 of 8 bits), or clip overshoot; a scene-linear picture holds no camera response"
    )


def has_equal_channels(pixels: NDArray[Any]) -> bool:
    """Return whether the three channels of pixels, shape (H, W, 3), are equal everywhere."""
    red, *others = (pixels[..., channel] for channel in range(3))
    sparse = np.s_[::16, ::16]
    return all(bool((red[part] == other[part]).all()) for part in (sparse, np.s_[:]) for other in others)


def _stated_order(array: object, color_order: ColorOrder | None, name: str) -> ColorOrder | None:
    """Return the order that is given, or that of a Pillow image; refuse an image of another mode."""
    if color_order is not None and color_order not in get_args(ColorOrder):
        raise PhotoError(f"{name}: color_order is {color_order!r}; give one of {', '.join(get_args(ColorOrder))}")
    mode = getattr(array, "mode", None)
    if not isinstance(mode, str):
        return color_order
    order = PILLOW_MODES.get(mode)
    if order is None:
        advice = _OTHER_MODES.get(mode, "which is not taken; give image.convert('RGB')")
        raise PhotoError(f"{name}: is a Pillow image of mode {mode!r}, {advice}")
    if color_order not in (None, order):
        raise PhotoError(f"{name}: is a Pillow image of mode {mode!r}, so leave color_order={color_order!r} out")
    return order


def _samples(array: Any, name: str) -> NDArray[Any]:
    """Return an array of 8- or 16-bit codes or of floating-point numbers; refuse any other."""
    if array is None:
        raise PhotoError(f"{name}: is None, which OpenCV's imread returns for a file it cannot read; check its name")
    if isinstance(array, str | Path):
        raise PhotoError(f"{name}: {str(array)!r} is the name of a file; read_photo reads files")
    try:
        values = np.asarray(array)
    except (TypeError, ValueError) as problem:
        raise PhotoError(f"{name}: NumPy makes no array of this {type(array).__name__} ({problem})") from None
    if values.dtype.kind == "f" or (values.dtype.kind == "u" and values.dtype.itemsize <= 2):
        return values
    raise PhotoError(
        f"{name}: holds {values.dtype}; give uint8, uint16 with its bit_depth, or floating point in [0, 1]"
        " (array.astype converts)"
    )


def _checked_order(values: NDArray[Any], order: ColorOrder | None, name: str) -> ColorOrder:
    """Return the order of the channels, which the shape must have; that of one channel need not be given."""
    shape = values.shape
    if values.ndim not in (2, 3) or not values.size or not 1 <= np.atleast_3d(values).shape[2] <= 4:
        first = (
            "; of channels that come first, give array.transpose(1, 2, 0)" if shape[:1] in ((1,), (3,), (4,)) else ""
        )
        raise PhotoError(f"{name}: has shape {shape}; needs (H, W), or (H, W, C) with 1 to 4 channels{first}")
    channels = 1 if values.ndim == 2 else shape[2]
    if order is None and channels > 1:
        raise PhotoError(
            f"{name}: has {channels} channels and no color_order; give color_order='RGB', 'BGR' (OpenCV's order),"
            " 'RGBA', 'BGRA' or 'LA'"
        )
    order = order or "L"
    if len(order) != channels:
        raise PhotoError(f"{name}: has {channels} channels, but color_order={order!r}; give the order of all channels")
    return order


def _checked_bits(values: NDArray[Any], bit_depth: int | None, name: str) -> int:
    """Return the bits per sample: those stated, else those of the type, which must be stated of uint16."""
    bits = 8 * values.dtype.itemsize
    if bit_depth is None and values.dtype.kind == "u" and bits == 16:
        raise PhotoError(f"{name}: uint16 may hold 10, 12 or 16 bits; give bit_depth=16 if white is 65535")
    bit_depth = bits if bit_depth is None else bit_depth
    if not LEAST_BITS <= bit_depth <= bits:
        raise PhotoError(f"{name}: {values.dtype} cannot hold a photograph of bit_depth={bit_depth}; give 8 to {bits}")
    return bit_depth


def _encoded(codes: NDArray[Any], bits: int, name: str) -> Float32Array:
    """Return code / largest code, rounded to float32."""
    largest, found = 2**bits - 1, int(codes.max())
    if found > largest:
        raise PhotoError(f"{name}: holds code {found}, but bit_depth={bits} ends at {largest}; give its own bit_depth")
    return np.asarray(np.divide(codes, np.float32(largest), dtype=np.float32))


def _divided(color: Float32Array, alpha: Float32Array) -> Float32Array:
    """Return associated colour, shape (H, W, 3), divided by alpha, shape (H, W); 0 where nothing is covered."""
    coverage = np.where(alpha > 0, alpha, np.float32(np.inf))[..., None]
    divided: Float32Array = np.minimum(color / coverage, 1)
    return divided
