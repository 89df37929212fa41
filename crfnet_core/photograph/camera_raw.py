"""Read camera raw with rawpy (LibRaw): the light of the sensor as it is stored, and the camera's own JPEG in it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL.TiffImagePlugin import TiffImageFile

from crfnet_core.errors import PhotoError, one_line
from crfnet_core.types import BoolArray, Float32Array, Float64Array

#: Part of the sensor's range from which a photosite is saturated, and the part of all photosites that have to share
#: the largest value for it to be the end of the range.
SATURATED, PILE = 0.985, 1e-4

#: Tag of DNG 1.2: PreviewApplicationName. And the photosites along both sides of a Bayer pattern.
_PREVIEW_PROGRAM, _BAYER = 50966, (2, 2)


@dataclass(frozen=True, eq=False)
class RawPicture:
    """The light on a sensor, one pixel for each 2 x 2 photosites, as stored: neither turned nor balanced."""

    light: Float32Array  # (H, W, 3): red, green and blue of the camera, black = 0, end of the sensor's range = 1
    is_saturated: BoolArray  # (H, W): whether some photosite of a pixel is
    balance: Float64Array  # (3,): the camera's white balance, the factors of the channels; green's is 1
    iso: int | None
    seconds: float | None  # exposure time
    preview: bytes  # the JPEG inside; empty if there is none
    program: str  # the program that made this JPEG, if it was not the camera


def read_raw(path: Path) -> RawPicture:
    """Return the light in a raw file. Raise PhotoError if rawpy is missing, or LibRaw cannot read the file."""
    try:
        import rawpy
    except ImportError:
        raise PhotoError("rawpy_missing", path=path) from None
    try:
        with rawpy.imread(str(path)) as raw:
            is_bayer = raw.raw_type == rawpy.RawType.Flat and getattr(raw.raw_pattern, "shape", None) == _BAYER
            light, is_saturated = _bayer_light(raw) if is_bayer else _developed_light(raw, rawpy)
            balance = np.array(raw.camera_whitebalance[:3], dtype=np.float64)
            return RawPicture(
                light=light,
                is_saturated=is_saturated,
                balance=balance / balance[1] if balance.min() > 0 else np.ones(3),
                iso=round(raw.other.iso_speed) or None,
                seconds=raw.other.shutter_speed or None,
                preview=_preview(raw, rawpy),
                program=_preview_program(path),
            )
    except (rawpy.LibRawError, OSError) as problem:
        raise PhotoError("raw_not_read", path=path, suffix=path.suffix, problem=libraw_message(problem)) from None


def libraw_message(problem: Exception) -> str:
    """Return the message of an error of LibRaw, which may be bytes."""
    message = problem.args[0] if problem.args else type(problem).__name__
    return message.decode(errors="replace") if isinstance(message, bytes) else str(message)


def _bayer_light(raw: Any) -> tuple[Float32Array, BoolArray]:
    """Return the means over a mosaic's 2 x 2 photosites, and which of these hold a saturated one."""
    mosaic = raw.raw_image_visible
    height, width = (side // 2 for side in mosaic.shape)
    light = np.zeros((height, width, 3), np.float32)
    is_saturated = np.zeros((height, width), bool)
    top = int(mosaic.max())
    white = top if top < raw.white_level and (mosaic == top).mean() > PILE else raw.white_level
    channels = [b"RGB".index(raw.color_desc[index]) for index in np.ravel(raw.raw_pattern)]
    for place, channel in enumerate(channels):
        sites = mosaic[place // 2 : 2 * height : 2, place % 2 : 2 * width : 2]
        black = raw.black_level_per_channel[np.ravel(raw.raw_pattern)[place]]
        values = (sites.astype(np.float32) - black) / np.float32(white - black)
        light[..., channel] += values / channels.count(channel)
        is_saturated |= values >= SATURATED
    return light, is_saturated


def _developed_light(raw: Any, rawpy: Any) -> tuple[Float32Array, BoolArray]:
    """Return LibRaw's own linear picture at half size, in the camera's colors: for all but Bayer mosaics."""
    linear = {"gamma": (1, 1), "no_auto_bright": True, "user_wb": [1, 1, 1, 1], "adjust_maximum_thr": 0}
    stored = {"output_color": rawpy.ColorSpace.raw, "highlight_mode": rawpy.HighlightMode.Clip, "user_flip": 0}
    codes = raw.postprocess(half_size=True, output_bps=16, **linear, **stored)
    light = codes[..., :3].astype(np.float32) / 65535
    return light, np.asarray((light >= SATURATED).any(axis=2))


def _preview(raw: Any, rawpy: Any) -> bytes:
    """Return the JPEG in an open raw file."""
    try:
        preview = raw.extract_thumb()
    except rawpy.LibRawError:
        return b""
    return bytes(preview.data) if preview.format == rawpy.ThumbFormat.JPEG else b""


def _preview_program(path: Path) -> str:
    """Return the program that a DNG file names as the maker of its preview, or an empty text."""
    try:
        with TiffImageFile(path) as image:
            return one_line(str(image.tag_v2.get(_PREVIEW_PROGRAM, "")).strip("\0 "))
    except (OSError, SyntaxError, ValueError):
        return ""
