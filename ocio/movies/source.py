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
    """Return the frames of a movie, or what `find_frames` returns for any other name; raises as these do."""
    path = Path(pattern)
    return MovieFrames.find(path, frames) if is_movie(path) else find_frames(pattern, frames)


def file_source(path: Path, frames: str | Iterable[int] | None = None) -> PlateSource:
    """Return the frames of a movie, or any other file by itself, which `frames` does not concern."""
    return MovieFrames.find(path, frames) if is_movie(path) else FrameSequence((path,))


def movie_of(source: PlateSource) -> MovieStream | None:
    """Return the movie whose frames these are; None if they are image files."""
    return source.movie if isinstance(source, MovieFrames) else None


def photographs_of(source: PlateSource) -> Iterator[tuple[PlateSource, Photo]]:
    """Yield up to `FRAMES_ANALYZED` photographs, spread over a source, each behind a source of it alone.

    One is in memory at a time. Raise a PhotoError if one cannot be read.
    """
    if isinstance(source, MovieFrames):
        return ((source.only(number), photo) for number, photo in chosen_photos(source))
    return ((FrameSequence((path,)), read_photo(path)) for path in sample_frames(source))
