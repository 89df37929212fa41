"""Pixels from arrays: their type, shape and range are checked, and codes become encoded brightness in [0, 1]."""

from contextlib import suppress
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFile, ImageOps

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.jpeg import DAMAGE
from crfnet_core.types import Float32Array, is_number

#: The channels of an array, in their order; "A" is alpha. OpenCV's order is BGR, nearly all others use RGB.
ColorOrder = Literal["L", "LA", "RGB", "RGBA", "BGR", "BGRA"]

LEAST_BITS = 8  # least bits per sample: fewer show no response

#: Modes of Pillow's images whose arrays hold code values as they are, and the order of their channels.
PILLOW_MODES: dict[str, ColorOrder] = {
    **{"L": "L", "LA": "LA", "RGB": "RGB", "RGBA": "RGBA"},
    **dict.fromkeys(("I;16", "I;16L", "I;16B", "I;16N"), "L"),
}


def pixels_from_array(
    array: Any, *, color_order: ColorOrder | None, bit_depth: int | None, name: str
) -> tuple[Float32Array, int]:
    """Return new pixels in R, G, B, float32 (H, W, 3) in [0, 1], and the bits per sample; see `Photo.from_array`."""
    order = _stated_order(array, color_order, name)
    if isinstance(array, Image.Image):
        array = _upright(array, name)
    values = _samples(array, name)
    order = _checked_order(values, order, name)
    bits = _checked_bits(values, bit_depth, name)
    planes = np.atleast_3d(values)[..., [order.index(letter) for letter in ("RGB" if "R" in order else "LLL")]]
    if values.dtype.kind == "f":
        check_range(planes, name)
        return np.ascontiguousarray(planes, np.float32), bits
    largest, highest = 2**bits - 1, int(planes.max())
    if highest > largest:
        raise PhotoError("array_above_bit_depth", path=name, code=highest, bit_depth=bits, largest=largest)
    return np.ascontiguousarray(np.divide(planes, np.float32(largest), dtype=np.float32)), bits


def check_range(pixels: NDArray[np.floating], name: str) -> None:
    """Refuse floating-point pixels that are not encoded brightness in [0, 1]."""
    low, high = float(pixels.min()), float(pixels.max())
    if np.isnan(low):
        raise PhotoError("array_holds_nan", path=name)
    if low < 0 or high > 1:
        raise PhotoError("array_out_of_range", path=name, low=low, high=high)


def has_equal_channels(pixels: NDArray[Any]) -> bool:
    """Return whether the three channels of pixels, shape (H, W, 3), are equal everywhere."""
    red, *others = (pixels[..., channel] for channel in range(3))
    sparse = np.s_[::16, ::16]
    return all(bool((red[part] == other[part]).all()) for part in (sparse, np.s_[:]) for other in others)


def _stated_order(array: object, color_order: ColorOrder | None, name: str) -> ColorOrder | None:
    """Return the stated order, or the order of a Pillow image; refuse an image of another mode."""
    orders = get_args(ColorOrder)
    if color_order is not None and not (isinstance(color_order, str) and color_order in orders):
        raise PhotoError("array_unknown_order", path=name, order=repr(color_order), orders=", ".join(orders))
    if not isinstance(array, Image.Image):
        return color_order
    order = PILLOW_MODES.get(array.mode)
    if order is None:
        raise PhotoError("pillow_mode", path=name, mode=array.mode)
    if color_order not in (None, order):
        raise PhotoError("pillow_order_stated", path=name, mode=array.mode, order=color_order)
    return order


def _upright(image: Image.Image, name: str) -> Image.Image:
    """Return an image of Pillow, loaded and turned as its EXIF asks; damaged EXIF turns nothing."""
    file = image if isinstance(image, ImageFile.ImageFile) else None
    if file:
        path, file.filename = file.filename, ""  # else Pillow 13 maps a turned TIFF with its sides exchanged
    try:
        image.load()
    except (AssertionError, *DAMAGE) as problem:
        if isinstance(problem, AssertionError) or "closed" in str(problem):
            raise PhotoError("pillow_closed", path=name) from None
        raise PhotoError("damaged", path=name, kind=image.format, problem=problem) from None
    finally:
        if file:
            file.filename = path
    with suppress(*DAMAGE):
        image = ImageOps.exif_transpose(image)
    return image


def _samples(array: Any, name: str) -> NDArray[Any]:
    """Return an array of 8- or 16-bit codes or of floating-point numbers; refuse any other."""
    if array is None:
        raise PhotoError("array_is_none", path=name)
    try:
        values = np.asarray(array)
    except (RuntimeError, TypeError, ValueError):  # tensors of PyTorch with a gradient, or on another device
        raise PhotoError("array_sample_type", path=name, kind=f"a {type(array).__name__}") from None
    if np.ma.is_masked(array):
        raise PhotoError("array_sample_type", path=name, kind="masked values")
    if values.dtype.kind == "f" or (values.dtype.kind == "u" and values.dtype.itemsize <= 2):
        return values
    raise PhotoError("array_sample_type", path=name, kind=values.dtype)


def _checked_order(values: NDArray[Any], order: ColorOrder | None, name: str) -> ColorOrder:
    """Return the order of the channels, which must fit the shape; one channel needs no order."""
    shape = values.shape
    if values.ndim not in (2, 3) or not values.size or not 1 <= np.atleast_3d(values).shape[2] <= 4:
        are_first = values.ndim == 3 and shape[0] in (1, 3, 4)
        raise PhotoError("array_channels_first" if are_first else "array_shape", path=name, shape=shape)
    channels = 1 if values.ndim == 2 else shape[2]
    if order is None and channels > 1:
        raise PhotoError("array_without_order", path=name, channels=channels)
    order = order or "L"
    if len(order) != channels:
        raise PhotoError("array_other_order", path=name, channels=channels, order=order)
    return order


def _checked_bits(values: NDArray[Any], bit_depth: int | None, name: str) -> int:
    """Return the bits per sample: as stated, else as the type has; uint16 needs a statement."""
    bits = 8 * values.dtype.itemsize
    if bit_depth is None and values.dtype.kind == "u" and bits == 16:
        raise PhotoError("array_without_bit_depth", path=name)
    bit_depth = bits if bit_depth is None else bit_depth
    if not is_number(bit_depth, int, least=LEAST_BITS, most=bits):
        raise PhotoError("array_bit_depth", path=name, kind=values.dtype, bit_depth=repr(bit_depth), most=bits)
    return int(bit_depth)  # an np.uint8 cannot hold 2 ** 16
