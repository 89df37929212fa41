"""The description of a movie, read once: its picture, which no frame may change, its frames and its metadata."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from math import inf, isnan, nan
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from crfnet_core.errors import one_line
from crfnet_core.photograph.metadata.color_tags import ColorTags, cicp_tags
from crfnet_core.photograph.metadata.file_metadata import LONGEST_TEXT, FileMetadata
from crfnet_core.photograph.photo import UPRIGHT, Turn
from crfnet_core.photograph.yuv import Coding, bit_depth

from ..errors import PlateError
from .cut_files import is_cut_short
from .library import AVI, MATROSKA, decoded_packet, ffmpeg_line, is_shown, opened, packets_of, undecodable

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: The time of a frame in the time base of its stream, nan if unknown, and whether it is a key frame.
Entry: TypeAlias = tuple[float, bool]

#: Matrix, range, primaries and transfer: code points of ITU-T H.273, but the range is FFmpeg's; and of none.
#: And matrices that depend on the transfer function -> FFmpeg's name of the one that is taken if none is stated.
ColorCodes: TypeAlias = tuple[int, ...]
UNSPECIFIED: ColorCodes = (2, 0, 2, 2)
TRANSFERS = {10: "bt2020-10", 14: "smpte2084"}

#: PQ and HLG, which hold if the container states one, whatever the stream says.
HDR_TRANSFERS = (16, 18)

#: Words of the messages of FFmpeg's demuxers about files that are cut short.
CUT = ("partial file", "ended prematurely")

#: Codecs whose frames state whether they hold two fields; for others the container counts. And the number of frames by
#: which ascending times are found to be times of decoding: some programs copy AVI and bare streams into MP4 with these.
FIELD_CODECS = ("h264", "hevc", "mpeg1video", "mpeg2video", "mpeg4", "vc1", "prores", "dnxhd")
PROGRESSIVE, FIRST_FRAMES = 1, 32

#: Codecs whose pictures are JPEG: their chroma lies between the luma samples, and their range is full. Codecs as people
#: know them; others by FFmpeg's name.
JPEG_CODECS = ("mjpeg", "mjpegb")
CODEC_NAMES = {"h264": "H.264", "hevc": "HEVC", "prores": "ProRes", "vp9": "VP9", "av1": "AV1", "libdav1d": "AV1"}

#: FFmpeg's names, in lower case, of the camera's maker, its model and its firmware; the first one present counts.
CAMERA = (
    ("com.apple.quicktime.make", "com.android.manufacturer", "make"),
    ("com.apple.quicktime.model", "com.android.model", "model"),
    ("com.apple.quicktime.software",),
)

#: Metadata by FFmpeg's names, in lower case -> a text in it -> the log curve that it names.
LOG_TAGS = {
    "com.arri.camera.colorgammasxs": {"log-c": "ARRI LogC3"},
    "com.panasonic.semi-pro.metadata.xml": {"<capturegamma>v-log</capturegamma>": "Panasonic V-Log"},
}


@dataclass(frozen=True)
class Picture:
    """The form of a frame's samples, which all frames of a movie have in common."""

    width: int  # as stored
    height: int
    samples: str  # FFmpeg's name of the pixel format
    coding: Coding  # of RGB
    turn: Turn  # by which a stored picture becomes upright
    is_interlaced: bool
    tags: ColorTags  # primaries and transfer function

    @classmethod
    def from_frame(cls, path: Path, frame: VideoFrame, codec: str, container: ColorCodes) -> Picture:
        """Return the form of a decoded frame; raise a PlateError if its samples are not read."""
        stated = zip(_color_codes(frame), container, UNSPECIFIED, strict=True)
        codes = tuple(other if own == none else own for own, other, none in stated)  # ProRes has them in the container
        coding = Coding.from_frame(frame, is_still=codec in JPEG_CODECS, codes=codes[:2])
        if coding is None:
            form = f"pixels of {frame.format.name}, matrix {codes[0]} of H.273"
            raise PlateError("movie_form", path=path, form=form, line=ffmpeg_line(path, *_filters(frame, codes)))
        turn, tags = _turn(path, frame), cicp_tags(codes[2:])
        return cls(frame.width, frame.height, frame.format.name, coding, turn, frame.interlaced_frame, tags)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the upright picture."""
        return (self.height, self.width) if self.turn[0] == 0 else (self.width, self.height)

    def __str__(self) -> str:
        """Return the form in words."""
        fields = "interlaced" if self.is_interlaced else "progressive"
        primaries = self.tags.primaries.name if self.tags.primaries else self.tags.source
        parts = (f"{self.size[0]} x {self.size[1]}", self.samples, self.coding, fields, primaries, self.tags.transfer)
        return ", ".join(str(part) for part in parts if part)


@dataclass(frozen=True)
class MovieStream:
    """The description of a movie."""

    path: Path
    codec: str
    picture: Picture  # of the first frame
    bit_depth: int
    pixel_aspect: Fraction  # width of a pixel divided by its height, upright
    rate: Fraction  # frames per second on average; 0 if unknown
    color: ColorTags
    metadata: Mapping[str, str]  # of the file and of its video, by FFmpeg's names in lower case
    frame_count: int  # of a file that is cut short one more, which cannot be decoded
    key_numbers: tuple[int, ...]  # of the frames that are decoded alone, ascending, from 1
    container: ColorCodes  # of the container, which count where the frames do not state theirs
    start: float  # the time of the first frame, in the time base of its stream; -inf if times are unknown
    is_interlaced: bool  # by its first frame or by the container
    is_cut: bool = False

    def __str__(self) -> str:
        """Return one line for people: the movie, and the values taken for properties that it does not state."""
        (width, height), rate = self.picture.size, f" at {float(self.rate):.6g} per second" if self.rate else ""
        hides_alpha = self.metadata.get("alpha_mode") == "1" and "a" not in self.picture.samples  # of VP8 and VP9
        interlaced = "interlaced: its frames mix two moments, so deinterlace it for linear plates"
        parts = [
            f"{self.codec}, {width} x {height}, {self.bit_depth} bits, {self.frame_count} frames{rate}",
            str(self.picture.coding),
            f"timecode {self.metadata['timecode']}" if "timecode" in self.metadata else "",
            *(f"the stream {assumption}" for assumption in self.picture.coding.assumptions),
            interlaced if self.is_interlaced else "",
            "the file is cut short: copy it again" if self.is_cut else "",
            "its alpha is left out" if hides_alpha else "",
        ]
        return f"{self.path.name}: {'; '.join(filter(None, parts))}"

    @property
    def file_metadata(self) -> FileMetadata:
        """The metadata as a photograph's file has it."""
        found = (next((self.metadata[name] for name in names if name in self.metadata), "") for names in CAMERA)
        make, model, software = (one_line(text[:LONGEST_TEXT]) for text in found)
        return FileMetadata(*self.picture.size, make, model, software, file_format="movie", color=self.color)


def check_progressive(movie: MovieStream) -> None:
    """Raise a PlateError if frames hold two fields: how they become one picture is the user's to choose."""
    if movie.is_interlaced:
        matrix = "".join(filter(str.isalnum, movie.picture.coding.matrix.lower()))
        conversion = () if matrix == "rgb" else (f"scale=in_color_matrix={matrix}",)  # FFmpeg takes BT.601 by default
        line = ffmpeg_line(movie.path, "bwdif=send_frame", *conversion)
        raise PlateError("movie_interlaced", path=movie.path, line=line)


def read_stream(path: Path) -> MovieStream:
    """Return the description of a movie, read to its end, or refuse it; only the first frame is decoded."""
    with opened(path) as (container, stream):
        codes = _color_codes(stream.codec_context)  # decoding overwrites them
        packets, frame, problems = _survey(container, stream)
        is_cut = any(words in problem for words in CUT for problem in problems) or is_cut_short(path)
        if problems and not is_cut and container.format.name == MATROSKA:  # it passes over frames that it cannot find
            raise undecodable(path, problems[0])
        if frame is None:
            raise undecodable(path, "it holds no frame")
        movie = _described(path, container, stream, packets, frame, codes)
        return replace(movie, frame_count=movie.frame_count + is_cut, is_cut=is_cut)


def _color_codes(source: Any) -> ColorCodes:
    """Return the code points of a frame or of a codec's context."""
    return int(source.colorspace), int(source.color_range), int(source.color_primaries), int(source.color_trc)


def _survey(container: InputContainer, stream: VideoStream) -> tuple[list[Entry], VideoFrame | None, list[str]]:
    """Return the entries of all frames in the order of the file, the first frame, and the errors of the container."""
    import av

    packets, first, context = [], None, stream.codec_context
    times: list[float] = []  # of the first frames that are decoded
    unknown = -inf if container.format.name == MATROSKA else nan  # as it cannot hold times below zero
    with av.logging.Capture() as messages:
        for packet in packets_of(container, stream):
            if packet is None:
                packets.append((nan, False))
                continue
            is_doubtful = context.has_b_frames and len(times) < FIRST_FRAMES and _ascend(time for time, _ in packets)
            if first is None or is_doubtful:
                frames, _ = decoded_packet(stream, packet)
                first = first or next(iter(frames), None)
                times += [nan if frame.pts is None else frame.pts for frame in frames]
            if is_shown(packet):
                packets.append((unknown if packet.pts is None else packet.pts, packet.is_keyframe))
    if container.format.name == AVI or not _ascend(times):
        packets = [(nan, is_key) for _, is_key in packets]
    return packets, first, [one_line(message) for _, name, message in messages if name == container.format.name]


def _ascend(times: Iterable[float]) -> bool:
    """Return whether each time is later than the one before."""
    return all(time < later for time, later in pairwise(times))


def _start(packets: Sequence[Entry], first: VideoFrame) -> float:
    """Return the time of the first frame: pictures that refer to others before the first key frame have none."""
    if all(isnan(time) for time, _ in packets):
        return -inf
    times = [next((time for time, is_key in packets if is_key), nan), nan if first.pts is None else first.pts]
    return min((time for time in times if not isnan(time)), default=-inf)


def _key_numbers(packets: Sequence[Entry]) -> tuple[int, ...]:
    """Return the numbers of the key frames: their places in the file, behind the frames shown before them."""
    keys = [index for index, (_, is_key) in enumerate(packets) if is_key]
    return tuple(
        start + 1 + sum(time < packets[start][0] for time, _ in packets[start:end])
        for start, end in pairwise([*keys, len(packets)])
    )


def _described(
    path: Path,
    container: InputContainer,
    stream: VideoStream,
    packets: list[Entry],
    frame: VideoFrame,
    codes: ColorCodes,
) -> MovieStream:
    """Return the description of a movie by its stream, its packets, its first frame and the container's color codes."""
    codec = stream.codec_context.codec.canonical_name
    start = _start(packets, frame)
    keys = [index for index, (_, is_key) in enumerate(packets) if is_key]
    end = keys[1] if len(keys) > 1 else len(packets)  # from there on, the clock may run back
    packets = [entry for entry in packets[:end] if not entry[0] < start] + packets[end:]
    field_order: Any = stream.codec_context.field_order
    parts = [*(other.metadata for other in container.streams), container.metadata, stream.metadata]
    metadata = {key.lower(): value for part in parts for key, value in part.items()}
    picture = Picture.from_frame(path, frame, codec, codes)
    aspect = stream.sample_aspect_ratio or Fraction(1)
    return MovieStream(
        path=path,
        codec=CODEC_NAMES.get(codec, codec),
        picture=picture,
        bit_depth=bit_depth(frame),
        pixel_aspect=1 / aspect if picture.turn[0] == 0 else aspect,
        rate=Fraction(min(filter(None, (stream.average_rate, stream.base_rate)), default=0)),  # of DV, 60000 and 25
        color=_color_tags(cicp_tags(codes[2:]) if codes[3] in HDR_TRANSFERS else picture.tags, metadata),
        metadata=metadata,
        frame_count=len(packets),
        key_numbers=_key_numbers(packets),
        container=codes,
        start=start,
        is_interlaced=picture.is_interlaced or (codec not in FIELD_CODECS and field_order > PROGRESSIVE),
    )


def _color_tags(tags: ColorTags, metadata: Mapping[str, str]) -> ColorTags:
    """Return primaries and transfer function as the movie tags them, or else the log curve that metadata names."""
    texts = {name: "".join(metadata.get(name, "").lower().split()) for name in LOG_TAGS}
    curves = [curve for name, marks in LOG_TAGS.items() for mark, curve in marks.items() if mark in texts[name]]
    if tags.transfer or not curves:
        return tags
    return replace(tags, transfer=curves[0], transfer_source="the maker's entry")


def _filters(frame: VideoFrame, codes: ColorCodes) -> tuple[str, ...]:
    """Return the filters by which FFmpeg makes RGB of a form that is not read, without taking BT.601."""
    if codes[0] > UNSPECIFIED[0] and not frame.format.name.startswith("xyz"):  # which has no matrix
        transfer = TRANSFERS.get(codes[0]) if codes[3] == UNSPECIFIED[3] else None
        stated = (f"setparams=color_primaries=bt2020:color_trc={transfer}",) if transfer else ()
        return (*stated, "zscale=matrix=gbr", "format=gbrp16")
    return ("format=rgb24",) if frame.format.is_rgb and bit_depth(frame) < 8 else ()  # else white is 31/32


def _turn(path: Path, frame: VideoFrame) -> Turn:
    """Return the turn of the display matrix, upright for one that enlarges; refuse other angles than quarter turns."""
    try:
        matrix: Any = frame.side_data.get("DISPLAYMATRIX")
    except ValueError:  # of side data that PyAV does not know, such as EXIF; it still gives the angle
        if frame.rotation:
            raise undecodable(path, "its frames are turned, and PyAV does not say whether mirrored, too") from None
        matrix = None
    if matrix is None:
        return UPRIGHT
    values = np.frombuffer(matrix, np.int32)[[0, 1, 3, 4]] / 65536
    a, b, c, d = (round(float(value)) for value in values)
    is_turn = abs(a * d - b * c) == abs(a) + abs(b) == abs(c) + abs(d) == 1
    if is_turn and np.allclose(values, (a, b, c, d), atol=0.01):
        return a, b, c, d
    if np.abs(values[1:3]).max() > 0.01:
        raise undecodable(path, "its frames are turned by other angles than quarter turns")
    return UPRIGHT
