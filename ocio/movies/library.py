"""PyAV, an optional dependency: the remedy where it is absent or cannot decode; and which files are movies."""

from __future__ import annotations

import logging
import re
import shlex
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from io import BytesIO
from itertools import islice
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crfnet_core.photograph.image_io.file_kinds import AVIF_BRANDS, HEIC_BRANDS

from ..errors import PlateError

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: Bytes 4 to 8 of QuickTime and MP4 files: the first box.
QUICKTIME_BOXES = (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip", b"pnot")

#: Brands of files that begin like MP4 and hold still pictures: HEIF, AVIF, Canon's camera raw.
STILL_BRANDS = (*HEIC_BRANDS, *AVIF_BRANDS, b"mif1", b"mif2", b"msf1", b"miaf", b"crx ")

#: First bytes of other movies: Matroska, MXF, Flash, Windows Media, Ogg, Y4M, IVF, NUT, DV, RealMedia, Windows TV, GXF;
#: bare AV1; and the start code of MPEG and of bare streams.
SIGNATURES = re.compile(
    rb"\x1a\x45\xdf\xa3|\x06\x0e\x2b\x34|FLV\x01|\x30\x26\xb2\x75|OggS|YUV4MPEG2 |DKIF|nut/multimedia|\x1f\x07\0|\.RMF"
    rb"|\xb7\xd8\0\x20|\0{4}\x01\xbc|\x12\0\x0a|\0{2,3}\x01[^\0]"
)

#: Distances in bytes between the sync bytes of an MPEG transport stream, and the place of the first one.
_TRANSPORT = ((188, 0), (192, 4), (204, 0))

#: The profile of Dolby Vision whose samples are IPTPQc2: neither YCbCr nor for an ordinary display. And the seconds
#: after which opening is given up: FFmpeg walks through all boxes, and 48 MB of empty ones take it ten.
IPT_PROFILE, OPENING = 5, 60

#: Packets of video that distinguish a film from a thumbnail, or the pictures of chapters, in a stream of its own.
FIRST_PACKETS = 24

#: Containers by FFmpeg's names: one whose frames have no other place than their own, and one with times in no order.
MATROSKA, AVI = "matroska,webm", "avi"

#: Words of the messages of FFmpeg's decoders about damage that they fill in from other frames, in place of an error.
DAMAGE = ("CRC mismatch", "damaged", "error while decoding")

#: Most pixels of a frame (17 520 x 8040 of the largest cinema camera fit), and words by which FFmpeg refuses more.
MOST_PIXELS, _TOO_LARGE = 150_000_000, "exceeds specified max pixel count"


def is_movie(path: Path) -> bool:
    """Return whether a file is a movie, by its first bytes; False for a pipe and for unreadable files."""
    head = b""
    with suppress(OSError, ValueError):
        if path.is_file():
            with path.open("rb") as file:
                head = file.read(600)
    if head[4:8] in QUICKTIME_BOXES:
        return not (head[4:8] == b"ftyp" and head[8:12] in STILL_BRANDS)
    if head.startswith(b"RIFF"):
        return head[8:12] == b"AVI "
    return bool(SIGNATURES.match(head)) or any(
        head[first::step].startswith(b"\x47\x47\x47") for step, first in _TRANSPORT
    )


def ffmpeg_line(path: Path, *filters: str) -> str:
    """Return the command line by which FFmpeg makes PNG files of all frames, at full depth, each frame once."""
    folder, filtered = Path(str(path.parent).replace("%", "%%")), ["-vf", ",".join(filters)] if filters else []
    names = [str(path), str(folder / (path.stem.replace("%", "_") + ".%04d.png"))]
    source, frames = (f"file:{name}" if ":" in name or name.startswith("-") else name for name in names)
    return shlex.join(["ffmpeg", "-i", source, *filtered, "-fps_mode", "passthrough", "-pix_fmt", "rgb48be", frames])


@contextmanager
def opened(path: Path) -> Iterator[tuple[InputContainer, VideoStream]]:
    """Yield a movie and its best video stream, not a cover; a PlateError if the block cannot open or decode it."""
    try:
        import av
    except ImportError:
        raise PlateError("pyav_missing", path=path, line=ffmpeg_line(path)) from None
    _capture_errors()
    bounds = {"max_pixels": str(MOST_PIXELS)}  # also of frames that are larger than their container says
    try:
        with av.logging.Capture() as messages:
            opening = av.open(f"file:{path}", options=bounds, metadata_errors="replace", timeout=(OPENING, None))
        with opening as container:
            stream = _film(path, container)
            if not isinstance(stream, av.VideoStream) or (context := stream.codec_context) is None:
                raise PlateError("no_video", path=path)
            is_refused = any(_TOO_LARGE in message for _, _, message in messages)
            if is_refused or context.width * context.height > MOST_PIXELS:
                megapixels = MOST_PIXELS // 10**6
                raise PlateError("movie_too_large", path=path, megapixels=megapixels, line=ffmpeg_line(path))
            if _dolby_vision_profile(stream) == IPT_PROFILE:
                raise PlateError("dolby_vision", path=path, profile=IPT_PROFILE)
            context.thread_count = 1  # several report errors at other frames, of H.264 hardly any
            context.flags |= av.codec.context.Flags.unaligned  # else a crop on the left is cut to 16, 32 or 64 columns
            is_hevc = context.codec.canonical_name == "hevc"  # it passes over errors within a frame
            context.options = bounds | ({"err_detect": "crccheck+explode"} if is_hevc else {})
            yield container, stream
    except (av.FFmpegError, UnicodeDecodeError) as problem:
        raise undecodable(path, getattr(problem, "strerror", "") or type(problem).__name__) from problem


def _film(path: Path, container: InputContainer) -> Any:
    """Return FFmpeg's best video stream, but neither a cover nor one of few frames next to a film; None without one."""
    import av

    cover = av.stream.Disposition.attached_pic
    films = [each for each in container.streams.video if each.codec_context and not each.disposition & cover]
    if len(films) < 2:
        return films[0] if films else None
    with av.open(f"file:{path}", metadata_errors="replace") as again:  # not every container can be wound back
        packets = islice(again.demux([again.streams[each.index] for each in films]), FIRST_PACKETS)
        counts = Counter(packet.stream.index for packet in packets if packet.size)
    best = container.streams.best("video")
    most = max(films, key=lambda each: counts[each.index])
    return best if best in films and 2 * counts[best.index] > counts[most.index] else most


def packets_of(container: InputContainer, stream: VideoStream) -> Iterator[Any]:
    """Yield the packets of a movie, the last one empty; None for each frame of an AVI's index that is not found.

    There a damaged head of a frame hides it, and the frames behind it have no time of their own.
    """
    is_avi = container.format.name == AVI
    places = [entry.pos + 8 for entry in stream.index_entries if is_avi and entry.size]  # behind the heads
    last = -inf
    for packet in container.demux(stream):
        place = inf if packet.pos is None else packet.pos
        if last < 0 and place not in places:  # this is another file's index
            places = []
        yield from [None] * (bisect_left(places, place) - bisect_right(places, last))
        last = place
        yield packet


def is_shown(packet: Any) -> bool:
    """Return whether a packet holds a frame that is shown."""
    return bool(packet.size) and not packet.is_discard


def decoded_packet(stream: VideoStream, packet: Any) -> tuple[list[VideoFrame], bool]:
    """Return the frames that a packet completes, None for the last ones, and whether it is damaged."""
    import av

    with av.logging.Capture() as messages:
        try:
            frames = list(stream.decode(packet))
        except av.FFmpegError:
            return [], True
    is_named = any(words in message for words in DAMAGE for _, _, message in messages)
    return frames, is_named or bool(packet and packet.is_corrupt)


@cache
def _capture_errors() -> None:
    """Let `av.logging.Capture` get FFmpeg's errors; others go to Python's logging, and by default nowhere."""
    import av.logging

    logging.getLogger("libav").addHandler(logging.NullHandler())
    av.logging.set_level(av.logging.ERROR)
    av.logging.set_skip_repeated(False)


def _dolby_vision_profile(stream: VideoStream) -> int:
    """Return the profile of Dolby Vision, or 0: of the box that FFmpeg would write, as PyAV does not give it."""
    import av

    if stream.codec_context.codec.canonical_name != "hevc":
        return 0
    header, options = BytesIO(), {"movflags": "empty_moov", "strict": "unofficial"}
    try:
        with av.open(header, "w", format="mp4", options=options) as container:
            container.add_stream_from_template(stream)
            container.start_encoding()
            content = header.getvalue()
    except (av.FFmpegError, ValueError):
        return 0
    at = content.find(b"dvcC")
    return content[at + 6] >> 1 if at >= 0 else 0


def undecodable(path: Path, reason: str) -> PlateError:
    """Return the error of a movie that PyAV cannot decode."""
    return PlateError("movie_undecodable", path=path, reason=reason, line=ffmpeg_line(path))
