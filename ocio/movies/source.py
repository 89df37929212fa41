"""The sources of plates: the frames of a movie, or image files."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.photo import Photo

from ..plates.frames import FrameSequence, find_frames, sample_frames
from .frames import MovieFrames
from .library import is_movie
from .selection import chosen_photos
from .stream import MovieStream

#: Frames of a movie, the files of a sequence, or a single file: each a `FrameSource`.
PlateSource = FrameSequence | MovieFrames


def find_source(pattern: str | Path, frames: str | Iterable[int] | None = None) -> PlateSource:
    """Return the frames that a name stands for: those of a movie, or what `find_frames` returns.

    Parameters
    ----------
    pattern : str or Path
        The name of a movie or of another file, or of a sequence with a placeholder for the frame number.
    frames : str, iterable of int, or None
        The frames to use, as in `parse_frames`; all by default.

    Raises
    ------
    PlateError
        If nothing is found, or `frames` is malformed or given for a single file that is no movie.
    """
    path = Path(pattern)
    return MovieFrames.find(path, frames) if is_movie(path) else find_frames(pattern, frames)


def file_source(path: Path, frames: str | Iterable[int] | None = None) -> PlateSource:
    """Return the frames of a movie, or any other file by itself, which `frames` does not concern.

    Raises
    ------
    PlateError
        If it is a movie that cannot be read or has none of the frames, or `frames` is malformed.
    """
    return MovieFrames.find(path, frames) if is_movie(path) else FrameSequence((path,))


def movie_of(source: PlateSource) -> MovieStream | None:
    """Return the movie whose frames these are; None if they are image files."""
    return source.movie if isinstance(source, MovieFrames) else None


def photographs_of(source: PlateSource) -> Iterator[tuple[PlateSource, Photo]]:
    """Yield the photographs from which the response of a source is estimated, each behind the source of it alone.

    They are up to `FRAMES_ANALYZED` frames, spread over it. One is in memory at a time.

    Raises
    ------
    PhotoError
        If a frame cannot be read.
    """
    if isinstance(source, MovieFrames):
        return ((source.only(number), photo) for number, photo in chosen_photos(source))
    return ((FrameSequence((path,)), read_photo(path)) for path in sample_frames(source))
