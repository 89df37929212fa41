"""What a movie says of its pictures, read once: size, coding, times, timecode and tags."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crfnet_core.photograph.image_io import MAX_PIXELS
from crfnet_core.photograph.metadata.color_tags import ColorTags, cicp_tags

from ..errors import PlateError
from .color import Coding
from .conversion import bit_depth
from .index import FrameIndex, read_index
from .library import ffmpeg_line, opened, undecodable
from .log_tags import log_curve
from .timecode import Timecode

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: Codecs whose pictures are JPEG: their chroma lies between the luma samples, and their range is full.
JPEG_CODECS = ("mjpeg", "mjpegb")

#: Codecs as people know them; others by FFmpeg's name.
CODEC_NAMES = {"h264": "H.264", "hevc": "HEVC", "prores": "ProRes", "vp9": "VP9", "av1": "AV1", "libdav1d": "AV1"}


@dataclass(frozen=True)
class MovieStream:
    """What a movie says of its pictures.

    Parameters
    ----------
    path : Path
        The movie.
    codec : str
        Name of the codec.
    width, height : int
        The picture in pixels, upright.
    bit_depth : int
        Bits per sample.
    coding : Coding
        How it codes RGB.
    turn : tuple of int
        How a stored picture becomes upright: see `upright`.
    pixel_aspect : Fraction
        Width of a pixel divided by its height, upright.
    rate : Fraction
        Frames per second, on average; 0 if unknown.
    timecode : Timecode or None
        Of the first frame.
    is_interlaced : bool
        Whether the frames hold two fields.
    color : ColorTags
        Primaries and transfer function as tagged.
    metadata : mapping of str to str
        Of the file and of its video, by FFmpeg's names in lower case.
    index : FrameIndex
        The times of the frames.
    """

    path: Path
    codec: str
    width: int
    height: int
    bit_depth: int
    coding: Coding
    turn: tuple[int, int, int, int]
    pixel_aspect: Fraction
    rate: Fraction
    timecode: Timecode | None
    is_interlaced: bool
    color: ColorTags
    metadata: Mapping[str, str]
    index: FrameIndex

    def __str__(self) -> str:
        """Return one line for people: what the movie is, and what it does not say."""
        count, rate = len(self.index.times), f" at {float(self.rate):.6g} per second" if self.rate else ""
        parts = [
            f"{self.codec}, {self.width} x {self.height}, {self.bit_depth} bits, {count} frames{rate}",
            f"{self.coding.matrix}, {'full' if self.coding.is_full_range else 'limited'} range",
            f"tagged {self.color.transfer}" if self.color.transfer else "",
            f"timecode {self.timecode}" if self.timecode else "",
            *(f"the stream {assumption}" for assumption in self.coding.assumptions),
            "interlaced: its frames mix two moments, so deinterlace it for linear plates" if self.is_interlaced else "",
        ]
        return f"{self.path.name}: {'; '.join(filter(None, parts))}"


def check_progressive(movie: MovieStream) -> None:
    """Refuse a movie whose frames hold two fields: how they become one picture is the user's to choose.

    Raises
    ------
    PlateError
        If it is interlaced, with the line by which FFmpeg deinterlaces it.
    """
    if movie.is_interlaced:
        raise PlateError(
            f"{movie.path}: is interlaced, each frame mixes two moments; deinterlace it and linearize the frames:"
            f" {ffmpeg_line(movie.path, filters='bwdif=send_frame')} (without -vf, if both fields show the same moment)"
        )


def read_stream(path: Path) -> MovieStream:
    """Return what a movie says of its pictures; decodes the first frame only.

    Raises
    ------
    PlateError
        If PyAV is absent, or the movie is damaged, too large, or codes its pictures in a way that is not read.
    """
    with opened(path) as (container, stream):
        metadata = _metadata(container, stream)
        frame = _first_frame(path, container, stream)
        container.seek(0)
        try:
            index = read_index(container, stream)
        except PlateError as problem:
            raise undecodable(path, str(problem)) from None
        return _described(path, stream, frame, metadata, index)


def _described(
    path: Path, stream: VideoStream, frame: VideoFrame, metadata: Mapping[str, str], index: FrameIndex
) -> MovieStream:
    """Return what a stream and its first frame say."""
    turn, aspect = _turn(frame), stream.sample_aspect_ratio or Fraction(1)
    is_turned = turn[0] == 0
    name = stream.codec_context.codec.canonical_name
    rate = Fraction(stream.average_rate or 0)
    return MovieStream(
        path=path,
        codec=CODEC_NAMES.get(name, name),
        width=frame.height if is_turned else frame.width,
        height=frame.width if is_turned else frame.height,
        bit_depth=bit_depth(frame),
        coding=_coding(path, frame, name),
        turn=turn,
        pixel_aspect=1 / aspect if is_turned else aspect,
        rate=rate,
        timecode=Timecode.parse(metadata.get("timecode", ""), rate),
        is_interlaced=frame.interlaced_frame,
        color=_color(path, frame, metadata),
        metadata=metadata,
        index=index,
    )


def _first_frame(path: Path, container: InputContainer, stream: VideoStream) -> VideoFrame:
    """Return the first frame, after checking its size."""
    if stream.codec_context.width * stream.codec_context.height > MAX_PIXELS:
        raise PlateError(f"{path}: claims {stream.codec_context.width} x {stream.codec_context.height} pixels; crop it")
    frame = next(container.decode(stream), None)
    if frame is None:
        raise undecodable(path, "it holds no frame")
    return frame


def _coding(path: Path, frame: VideoFrame, codec: str) -> Coding:
    """Return how a frame codes RGB, or refuse what is not read."""
    form = frame.format
    is_rgb = form.is_rgb or form.has_palette
    coding = Coding.of(
        matrix=frame.colorspace,
        color_range=frame.color_range,
        is_rgb=is_rgb,
        is_gray=not is_rgb and len(form.components) < 3,
        is_jpeg=codec in JPEG_CODECS,
        lines=frame.height,
    )
    bits = bit_depth(frame)
    if coding is None or form.is_bit_stream or not 8 <= bits <= 16 or form.name.endswith(("f16le", "f32le")):
        raise undecodable(path, f"pixels of {form.name}, matrix {frame.colorspace} of H.273")
    return coding


def _color(path: Path, frame: VideoFrame, metadata: Mapping[str, str]) -> ColorTags:
    """Return primaries and transfer function as the stream tags them, or else the log curve that its maker names."""
    tags = cicp_tags((frame.color_primaries, frame.color_trc))
    if tags.transfer or not (curve := log_curve(path, metadata)):
        return tags
    return ColorTags(tags.primaries, curve, " and ".join(filter(None, (tags.source, "the maker's entry"))))


def _turn(frame: VideoFrame) -> tuple[int, int, int, int]:
    """Return a, b, c, d of the display matrix as -1, 0 or 1; as stored for other angles than quarter turns."""
    matrix: Any = frame.side_data.get("DISPLAYMATRIX")
    if matrix is None:
        return 1, 0, 0, 1
    values = np.frombuffer(matrix, np.int32)[[0, 1, 3, 4]] / 65536
    a, b, c, d = (round(float(value)) for value in values)
    is_quarter = bool(np.allclose(values, (a, b, c, d), atol=0.01)) and abs(a * d - b * c) == 1
    return (a, b, c, d) if is_quarter else (1, 0, 0, 1)


def _metadata(container: InputContainer, stream: VideoStream) -> dict[str, str]:
    """Return the metadata of all streams, of the file, and of the video, the last of one name winning."""
    parts = [*(other.metadata for other in container.streams), container.metadata, stream.metadata]
    return {key.lower(): value for part in parts for key, value in part.items()}
