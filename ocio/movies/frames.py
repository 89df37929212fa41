"""The frames of a movie as a source of plates, and as photographs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crfnet_core.photograph.photo import Photo

from ..errors import PlateError
from ..plates.frame_files import EncodedFrame, FrameLoader
from ..plates.frame_numbers import format_frames, parse_frames
from .conversion import alpha_of, rgb_codes, upright
from .decoding import decoded
from .header import frame_header, movie_metadata
from .library import ffmpeg_line
from .stream import MovieStream, read_stream

if TYPE_CHECKING:
    from av import VideoFrame

#: The code of white in linear plates' sources: 16 bits keep what lies between the codes of the stream after YUV to RGB.
WHITE = 65535


@dataclass(frozen=True)
class MovieFrames:
    """Some frames of a movie, or all: a `FrameSource`.

    Parameters
    ----------
    movie : MovieStream
        See `read_stream`.
    numbers : tuple of int
        Numbers of the frames, ascending; the first frame of a movie has number 1.
    missing : tuple of int
        Numbers that were asked for and that the movie does not have.
    """

    movie: MovieStream
    numbers: tuple[int, ...]
    missing: tuple[int, ...] = ()

    @classmethod
    def find(cls, path: Path, frames: str | Iterable[int] | None = None) -> MovieFrames:
        """Return the frames of a movie.

        Parameters
        ----------
        path : Path
            The movie.
        frames : str, iterable of int, or None
            The frames to use, as in `parse_frames`; all by default.

        Raises
        ------
        PlateError
            If the movie cannot be read, has none of the frames, or `frames` is malformed.
        """
        wanted = None if frames is None else parse_frames(frames)
        movie = read_stream(path)
        count = len(movie.index.times)
        if wanted is None:
            return cls(movie, tuple(range(1, count + 1)))
        numbers = tuple(number for number in wanted if 1 <= number <= count)
        if not numbers:
            raise PlateError(f"{path}: there are {format_frames(range(1, count + 1))}; check the frames")
        return cls(movie, numbers, tuple(number for number in wanted if not 1 <= number <= count))

    @property
    def paths(self) -> tuple[Path, ...]:
        """The files of the frames: the movie, once."""
        return (self.movie.path,)

    def only(self, *numbers: int) -> MovieFrames:
        """Return some of the frames."""
        return replace(self, numbers=numbers, missing=())

    def loaders(self, positions: Sequence[int]) -> Iterator[FrameLoader]:
        """Yield what returns each frame, for positions that ascend: it is decoded at once, and converted when called.

        A frame that cannot be decoded raises a PlateError when called.
        """
        for number, frame in decoded(self.movie, [self.numbers[position] for position in positions]):
            yield partial(_encoded, self.movie, number, frame)

    def photos(self, numbers: Iterable[int]) -> Iterator[tuple[int, Photo]]:
        """Yield frames with their numbers, ascending, as photographs: codes of the stream's own depth.

        Damaged frames are left out.
        """
        for number, frame in decoded(self.movie, numbers):
            if frame is not None:
                yield number, _photo(self.movie, number, frame)


def frame_name(path: Path, number: int) -> str:
    """Return what the report calls a frame."""
    return f"{path.name} frame {number}"


def _encoded(movie: MovieStream, number: int, frame: VideoFrame | None) -> EncodedFrame:
    """Return the encoded samples of a frame, upright."""
    if frame is None:
        raise PlateError(
            f"{movie.path}: frame {number} cannot be decoded; copy the movie again, or extract its frames:"
            f" {ffmpeg_line(movie.path)}"
        )
    samples, alpha = upright(rgb_codes(frame, movie.coding, WHITE), movie.turn), alpha_of(frame)
    if alpha is not None:
        alpha = upright(alpha, movie.turn)
    return EncodedFrame(samples, WHITE, alpha, frame_header(movie, number), movie.color)


def _photo(movie: MovieStream, number: int, frame: VideoFrame) -> Photo:
    """Return a frame as a photograph, upright."""
    largest = 2**movie.bit_depth - 1
    codes = upright(rgb_codes(frame, movie.coding, largest), movie.turn)
    return Photo(
        pixels=np.divide(codes, np.float32(largest), dtype=np.float32),
        bit_depth=movie.bit_depth,
        is_gray=bool((codes == codes[..., :1]).all()),
        path=movie.path.with_name(frame_name(movie.path, number)),
        metadata=movie_metadata(movie),
    )
