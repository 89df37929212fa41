"""Frames by number: seek to the key frame before, and decode from there."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from .index import FrameIndex
from .library import opened
from .stream import MovieStream

if TYPE_CHECKING:
    from av import VideoFrame
    from av.container import InputContainer
    from av.video.stream import VideoStream

#: Frames up to the next key frame that are rather decoded than skipped by a seek.
NEAR = 4

#: Seconds before the first frame at which its key frame is looked for: transport streams are sought by decoding time.
EARLY = 1


def decoded(movie: MovieStream, numbers: Iterable[int]) -> Iterator[tuple[int, VideoFrame | None]]:
    """Yield frames, ascending by number, each once; None for a frame that is damaged or absent.

    Decoding begins at the key frame before, so little more is decoded than what is asked for. Only the frames that the
    decoder itself keeps are in memory.

    Parameters
    ----------
    movie : MovieStream
        See `read_stream`.
    numbers : iterable of int
        Numbers of frames, from 1.

    Raises
    ------
    PlateError
        If the movie cannot be opened any more.
    """
    pending = deque(sorted(set(numbers)))
    with opened(movie.path) as (container, stream):
        while pending:
            sought = pending[0]
            for number, frame in _from_key_before(container, stream, movie.index, sought):
                while pending and pending[0] < number:
                    yield pending.popleft(), None
                if pending and pending[0] == number:
                    yield pending.popleft(), None if frame.is_corrupt else frame
                if not pending or (number >= sought and movie.index.key_before(pending[0]) > number + NEAR):
                    break
            else:  # the movie has ended
                yield from ((number, None) for number in pending)
                return


def _from_key_before(
    container: InputContainer, stream: VideoStream, index: FrameIndex, number: int
) -> Iterator[tuple[int, VideoFrame]]:
    """Yield all frames from one that is not after `number`; a seek that ends too late is tried again further before."""
    key = index.key_before(number)
    frames = _decoded_from(container, stream, index, key)
    first = next(frames, None)
    while key > 1 and (first is None or first[0] > number):
        key = index.key_before(key - 1)
        frames = _decoded_from(container, stream, index, key)
        first = next(frames, None)
    if first is not None:
        yield first
        yield from frames


def _decoded_from(
    container: InputContainer, stream: VideoStream, index: FrameIndex, key: int
) -> Iterator[tuple[int, VideoFrame]]:
    """Yield the frames from a key frame to the end; packets that are damaged are passed over, as FFmpeg does."""
    import av

    early = round(EARLY / stream.time_base) if key == 1 and stream.time_base else 0
    container.seek(index.times[key - 1] - early, stream=stream)
    for packet in container.demux(stream):
        try:
            frames = packet.decode()
        except av.FFmpegError:
            continue
        for frame in frames:
            if frame.pts is not None and frame.pts in index.numbers:
                yield index.numbers[frame.pts], frame
