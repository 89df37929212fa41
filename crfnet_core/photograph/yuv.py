"""YUV to RGB (ITU-T H.273, 8.3) for movies and AVIF: exact to half a code, chroma interpolated linearly at its place.

FFmpeg's scaler is up to 3.5 codes off at 10 bits, garbles 4:2:0 of odd width, leaves gray in limited range, and places
chroma of 4:2:2 between the luma samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crfnet_core.photograph.photo import CodeArray
from crfnet_core.types import Float32Array

if TYPE_CHECKING:
    from av import VideoFrame

#: H.273 MatrixCoefficients -> name, and the weights of red and blue in luma.
MATRICES = {
    1: ("BT.709", 0.2126, 0.0722),
    4: ("FCC", 0.30, 0.11),
    5: ("BT.601", 0.299, 0.114),
    6: ("BT.601", 0.299, 0.114),
    7: ("SMPTE 240M", 0.212, 0.087),
    9: ("BT.2020", 0.2627, 0.0593),
}

#: MatrixCoefficients of RGB, and of a stream that does not say; AVColorRange of full range.
_RGB, _UNSPECIFIED, _FULL_RANGE = 0, 2, 2

HD_LINES = 720  # lines from which an untagged video is taken to have the matrix of BT.709, below it BT.601
_ROWS = 64  # rows converted at a time, which keeps the memory for intermediate values small

#: Chroma subsampling, horizontal and vertical -> FFmpeg's name.
_SUBSAMPLING = {(1, 1): "444", (2, 1): "422", (2, 2): "420", (4, 1): "411", (1, 2): "440"}


@dataclass(frozen=True)
class Coding:
    """How a frame codes RGB."""

    matrix: str  # its name; "RGB" if the frame holds RGB or gray
    red: float  # the weights of red and blue in luma (K_R and K_B of H.273, 8.3)
    blue: float
    is_full_range: bool  # whether black is code 0 and white the largest; else 16 and 235, times 2 ** (bits - 8)
    is_centered: bool  # whether chroma lies between luma samples horizontally, as in still pictures, or on them
    assumptions: tuple[str, ...] = ()  # properties that the frame does not state, and the values taken, in words

    def __str__(self) -> str:
        """Return matrix and range in words."""
        return f"{self.matrix}, {'full' if self.is_full_range else 'limited'} range"

    @classmethod
    def from_frame(cls, frame: VideoFrame, *, is_still: bool, codes: Sequence[int] = ()) -> Coding | None:
        """Return the coding of a decoded frame, by `codes` of its container first; None if its samples are not read."""
        form, bits, lines = frame.format, bit_depth(frame), frame.height
        is_other = form.name.startswith(("xyz", "bayer")) or form.name.endswith(("f16le", "f32le"))
        if is_other or form.is_bit_stream or not 8 <= bits <= 16:
            return None
        matrix, color_range = codes or (int(frame.colorspace), int(frame.color_range))
        is_rgb, is_gray = form.is_rgb or form.has_palette, len(form.components) < 3
        is_full, assumptions = color_range == _FULL_RANGE, []
        if is_rgb or is_gray:
            weights: tuple[str, float, float] | None = ("RGB", 0.0, 0.0)
        else:
            if matrix in (_UNSPECIFIED, _RGB):
                matrix = 5 if is_still or lines < HD_LINES else 1
                assumptions.append(f"does not say its matrix: {MATRICES[matrix][0]} taken, as it has {lines} lines")
            weights = MATRICES.get(matrix)
        if color_range == 0:  # gray is full range, as FFmpeg takes it
            is_full = is_still or is_gray or is_rgb
            taken = "full taken, as it is gray" if is_gray else "limited taken"
            assumptions += [] if is_rgb else [f"does not say its range: {taken}"]
        if len(form.components) in (2, 4):
            assumptions.append("does not say how its alpha is meant: colors not multiplied by it taken")
        centered = is_still and not (is_rgb or is_gray)
        return weights and cls(*weights, is_full, centered, () if is_still else tuple(assumptions))


def bit_depth(frame: VideoFrame) -> int:
    """Return the bits per sample."""
    return max(component.bits for component in frame.format.components)


def rgb_codes(frame: VideoFrame, coding: Coding, largest: int) -> CodeArray:
    """Return the RGB codes of a frame as stored, 0 to `largest` (255 to 65535), rounded, uint8 or uint16, (H, W, 3)."""
    planes = _planes(frame)
    height, width = planes[0].shape
    codes = np.empty((height, width, 3), np.uint8 if largest <= 255 else np.uint16)
    for top in range(0, height, _ROWS):
        rows = np.arange(top, min(top + _ROWS, height))
        rgb = _rgb(planes, rows, coding, bit_depth(frame))
        codes[rows[0] : rows[-1] + 1] = np.clip(np.rint(rgb * np.float32(largest)), 0, largest)
    return codes


def alpha_of(frame: VideoFrame) -> Float32Array | None:
    """Return the alpha channel in [0, 1], shape (H, W); None if there is none."""
    planes = _planes(frame)
    largest = np.float32(2 ** bit_depth(frame) - 1)
    return np.asarray(np.divide(planes[-1], largest, dtype=np.float32)) if len(planes) in (2, 4) else None


def _planes(frame: VideoFrame) -> list[NDArray[Any]]:
    """Return the samples of each component: Y, Cb, Cr or R, G, B, and alpha, or gray alone; chroma as stored."""
    components = frame.format.components
    is_packed = len({component.plane for component in components}) < len(components)
    if is_packed and len(components) == 2:  # gray and alpha by turns, which FFmpeg's scaler would convert
        return [_plane(frame, 0, components[0].bits, first=first, step=2) for first in range(2)]
    if is_packed or frame.format.has_palette:
        frame = _separated(frame)
        components = frame.format.components
    return [_plane(frame, component.plane, component.bits) for component in components]


def _plane(frame: VideoFrame, index: int, bits: int, *, first: int = 0, step: int = 1) -> NDArray[Any]:
    """Return every `step`-th sample of a plane's lines, without the padding at their ends."""
    plane: Any = frame.planes[index]
    sample = np.dtype(np.uint8 if bits == 8 else ">u2" if frame.format.is_big_endian else "<u2")
    lines: NDArray[Any] = np.frombuffer(plane, sample).reshape(plane.height, plane.line_size // sample.itemsize)
    return lines[:, first : step * plane.width : step]


def _separated(frame: VideoFrame) -> VideoFrame:
    """Return a frame with a plane for each component, its codes unchanged."""
    form, bits = frame.format, bit_depth(frame)
    has_alpha, suffix = len(form.components) == 4, "" if bits == 8 else f"{bits}le"
    if form.is_rgb or form.has_palette:
        name = f"gbr{'a' if has_alpha or form.has_palette else ''}p{suffix}"
    else:
        ratios = -(-frame.width // form.chroma_width(frame.width)), -(-frame.height // form.chroma_height(frame.height))
        name = f"yuv{'a' if has_alpha else ''}{_SUBSAMPLING[ratios]}p{suffix}"
    return frame.reformat(format=name, src_color_range=1, dst_color_range=1)


def _rgb(planes: Sequence[NDArray[Any]], rows: NDArray[np.intp], coding: Coding, bits: int) -> Float32Array:
    """Return some rows of RGB, white at 1, shape (rows, W, 3)."""
    white, scale = np.float32(2**bits - 1), np.float32(2 ** (bits - 8))
    black, luma_range, chroma_range = (
        (0, white, white) if coding.is_full_range else (16 * scale, 219 * scale, 224 * scale)
    )
    shape = planes[0].shape
    if coding.matrix == "RGB" and len(planes) > 2:
        stored: Float32Array = np.stack([plane[rows] for plane in planes[:3]], axis=2).astype(np.float32)
        return (stored - black) / luma_range
    luma = (planes[0][rows].astype(np.float32) - black) / luma_range
    if len(planes) < 3:
        return np.repeat(luma[..., None], 3, axis=2)
    blue, red = (_full_size(plane, rows, shape, coding) for plane in planes[1:3])
    blue, red = ((chroma - 128 * scale) / chroma_range for chroma in (blue, red))
    k_red, k_blue = np.float32(coding.red), np.float32(coding.blue)
    rgb = np.empty((*luma.shape, 3), np.float32)
    rgb[..., 0] = luma + 2 * (1 - k_red) * red
    rgb[..., 2] = luma + 2 * (1 - k_blue) * blue
    rgb[..., 1] = (luma - k_red * rgb[..., 0] - k_blue * rgb[..., 2]) / (1 - k_red - k_blue)
    return rgb


def _full_size(plane: NDArray[Any], rows: NDArray[np.intp], shape: tuple[int, ...], coding: Coding) -> Float32Array:
    """Return some rows of a chroma plane at the size of luma; vertically, its samples lie between those of luma."""
    ratios = [-(-luma // chroma) for luma, chroma in zip(shape, plane.shape, strict=True)]
    first, second, weight = _neighbors(rows, ratios[0], plane.shape[0], is_centered=True)
    lines = _blend(plane[first], plane[second], weight[:, None])
    first, second, weight = _neighbors(np.arange(shape[1]), ratios[1], plane.shape[1], is_centered=coding.is_centered)
    return _blend(lines[:, first], lines[:, second], weight)


def _neighbors(
    positions: NDArray[np.intp], ratio: int, count: int, *, is_centered: bool
) -> tuple[NDArray[np.intp], NDArray[np.intp], Float32Array]:
    """Return, for positions of luma, its two neighboring chroma samples and the weight of the second."""
    offset = (ratio - 1) / 2 if is_centered else 0.0
    places = np.clip((positions - offset) / ratio, 0, count - 1)
    first = places.astype(np.intp)
    return first, np.minimum(first + 1, count - 1), (places - first).astype(np.float32)


def _blend(first: NDArray[Any], second: NDArray[Any], weight: Float32Array) -> Float32Array:
    """Return first + weight * (second - first) as float32."""
    start = first.astype(np.float32)
    return start if not weight.any() else start + weight * (second.astype(np.float32) - start)
