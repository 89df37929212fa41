"""The frames of a movie as a source of plates, and as photographs: decoded in order from the start."""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.photograph.photo import UPRIGHT, Photo, upright
from crfnet_core.photograph.yuv import alpha_of, rgb_codes

from ..errors import PlateError
from ..plates.frame_files import EncodedFrame, FrameLoader
from ..plates.frame_numbers import format_frames, parse_frames
from .library import decoded_packet, ffmpeg_line, is_shown, opened, packets_of
from .stream import MovieStream, Picture, read_stream

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: The code of white in linear plates' sources: 16 bits keep what lies between the codes of the stream after YUV to RGB.
WHITE = 65535


@dataclass(frozen=True)
class MovieFrames:
    """Some frames of a movie, or all, by ascending numbers from 1: a `FrameSource`."""

    movie: MovieStream
    numbers: tuple[int, ...]
    missing: tuple[int, ...] = ()  # asked for, but the movie does not have them

    @classmethod
    def find(cls, path: Path, frames: str | Iterable[int] | None = None) -> MovieFrames:
        """Return the frames of a movie asked for, as in `parse_frames`, or all; raise a PlateError if it has none."""
        wanted = None if frames is None else parse_frames(frames)
        movie = read_stream(path)
        existing = range(1, movie.frame_count + 1)
        if wanted is None:
            return cls(movie, tuple(existing))
        numbers = tuple(number for number in wanted if number in existing)
        if not numbers:
            raise PlateError("no_such_frames", path=path, frames=format_frames(existing))
        return cls(movie, numbers, tuple(number for number in wanted if number not in existing))

    @property
    def paths(self) -> tuple[Path, ...]:
        """The files of the frames: the movie, once."""
        return (self.movie.path,)

    def only(self, *numbers: int) -> MovieFrames:
        """Return some of the frames."""
        return replace(self, numbers=numbers, missing=())

    def loaders(self, positions: Sequence[int]) -> Iterator[FrameLoader]:
        """Yield what returns each frame, or raises a PlateError: it is decoded at once, and converted when called."""
        for number, frame in decoded(self.movie, [self.numbers[position] for position in positions]):
            yield partial(_encoded, self.movie, number, frame)

    def photos(self, numbers: Iterable[int]) -> Iterator[tuple[int, Photo]]:
        """Yield frames, ascending, as photographs of the stream's own depth; damaged ones are left out."""
        wanted = set(numbers)
        for number, frame in decoded(self.movie, wanted, keys_only=wanted <= set(self.movie.key_numbers)):
            if frame is not None:
                yield number, _photo(self.movie, number, frame)


def decoded(
    movie: MovieStream, numbers: Iterable[int], *, keys_only: bool = False
) -> Iterator[tuple[int, VideoFrame | None]]:
    """Yield frames, ascending by number from 1, each once; None for a frame that is damaged or absent."""
    pending = sorted(set(numbers), reverse=True)
    if not pending:
        return
    with opened(movie.path) as (container, stream):
        if keys_only and movie.start > -inf:  # else only counting all frames gives their numbers
            stream.codec_context.skip_frame = "NONKEY"
        for number, frame in enumerate(_in_order(movie, container, stream), 1):
            if number == pending[-1]:
                yield pending.pop(), frame
            if not pending:
                return
    yield from ((number, None) for number in reversed(pending))


def _in_order(movie: MovieStream, container: InputContainer, stream: VideoStream) -> Iterator[VideoFrame | None]:
    """Yield all frames as shown; None for each that is lost, damaged, or may be predicted from a damaged one.

    The packets' times say which frames are lost. All that follow damage in the file, up to the next key frame, are
    taken for damaged, as decoders predict from what they have.
    """
    pending: list[tuple[int, int, int]] = []  # the frames to come, in the order shown: clock, time, place in the file
    clock, last = 0, None  # and the time in the file; whenever it runs back, another one begins
    frames: list[VideoFrame]
    damaged_from = inf  # the place of the first damage since the last key frame
    for place, packet in enumerate(packets_of(container, stream)):
        frames, is_damaged, time = [], True, None
        if packet is not None:
            if packet.dts is not None:
                clock, last = clock + (last is not None and packet.dts < last), packet.dts
            time = packet.pts if movie.start > -inf else None
            if time is not None and is_shown(packet) and (clock or time >= movie.start):
                insort(pending, (clock, time, place))
            frames, is_damaged = decoded_packet(stream, packet)
        if is_damaged:
            damaged_from = min(damaged_from, place)
        if is_damaged and not frames and time is None:
            if stream.codec_context.has_b_frames:
                return  # decoders leave out others, too: the later ones have no number
            yield None
        for frame in frames:
            times = [time for _, time, _ in pending]
            index = times.index(frame.pts) if frame.pts in times else -1
            origin = pending[index][2] if index >= 0 else place
            yield from [None] * index
            del pending[: index + 1]
            if frame.is_corrupt:
                damaged_from = min(damaged_from, origin)
            elif frame.key_frame and origin > damaged_from:
                damaged_from = inf
            yield None if origin >= damaged_from else frame
    yield from [None] * len(pending)


def _codes(movie: MovieStream, number: int, frame: VideoFrame, white: int) -> NDArray[Any]:
    """Return a frame's RGB, upright; refuse one of another size, coding, turn, interlacing or color than the first."""
    picture = Picture.from_frame(movie.path, frame, movie.codec, movie.container)
    if picture != movie.picture:
        raise PlateError("movie_changes", path=movie.path, frame=number, form=picture, first=movie.picture)
    return upright(rgb_codes(frame, picture.coding, white), picture.turn)


def _encoded(movie: MovieStream, number: int, frame: VideoFrame | None) -> EncodedFrame:
    """Return the encoded samples of a frame, upright."""
    if frame is None:
        raise PlateError("frame_undecodable", path=movie.path, frame=number, line=ffmpeg_line(movie.path))
    samples, alpha = _codes(movie, number, frame, WHITE), alpha_of(frame)
    alpha = None if alpha is None else upright(alpha, movie.picture.turn)
    return EncodedFrame(samples, WHITE, alpha, _frame_header(movie), movie.color)


def _frame_header(movie: MovieStream) -> Any:
    """Return OpenImageIO's header of a frame: size, pixel aspect, frame rate, maker and model."""
    header = oiio.ImageSpec(*movie.picture.size, 3, oiio.UINT16)
    header.attribute("PixelAspectRatio", float(movie.pixel_aspect))
    if movie.rate:
        header.attribute("FramesPerSecond", oiio.TypeRational, movie.rate.as_integer_ratio())
    metadata = movie.file_metadata
    for name, text in (("Make", metadata.make), ("Model", metadata.model)):
        if text:
            header.attribute(name, text)
    return header


def _photo(movie: MovieStream, number: int, frame: VideoFrame) -> Photo:
    """Return a frame as a photograph, upright."""
    codes = _codes(movie, number, frame, 2**movie.bit_depth - 1)
    name = str(movie.path.with_name(f"{movie.path.name} frame {number}"))
    metadata = replace(movie.file_metadata, is_turned=movie.picture.turn != UPRIGHT)
    return Photo.from_array(codes, color_order="RGB", bit_depth=movie.bit_depth, name=name, metadata=metadata)
