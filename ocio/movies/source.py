"""The sources of plates, the frames of a movie or image files; and the frames from which a response is estimated."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.photo import Photo
from crfnet_core.types import Float32Array

from ..defaults import FRAMES_ANALYZED
from ..plates.frames import FrameSequence, find_frames, sample_frames
from .frames import MovieFrames
from .library import is_movie, undecodable
from .stream import MovieStream

#: Frames of a movie, the files of a sequence, or a single file: each a `FrameSource`.
PlateSource = FrameSequence | MovieFrames

#: Where in each part of the movie a frame is looked for, in turn, and the samples along its longer side that count.
PLACES, SAMPLES = (0.5, 0.7, 0.9), 96

#: Brightness in [0, 1] between which a frame shows something, and the least fraction of its samples there; and the
#: least mean difference in brightness between two frames that do not show the same picture.
DARK, LIGHT, FRACTION, DIFFERENCE = 0.08, 0.98, 0.1, 0.01


def find_source(pattern: str | Path, frames: str | Iterable[int] | None = None) -> PlateSource:
    """Return the frames of a movie, or what `find_frames` returns for any other name; raises as these do."""
    path = Path(pattern)
    return MovieFrames.find(path, frames) if is_movie(path) else find_frames(pattern, frames)


def file_source(path: Path, frames: str | Iterable[int] | None = None, *, pattern: str = "") -> PlateSource:
    """Return the frames of a movie, or any other file by itself, perhaps one of a sequence with a pattern."""
    return MovieFrames.find(path, frames) if is_movie(path) else FrameSequence((path,), pattern=pattern)


def sequence_of(sources: Iterable[PlateSource]) -> str:
    """Return the pattern of the sequence from which all sources are; empty if they are from several, or from none."""
    patterns = {getattr(source, "pattern", "") for source in sources}
    return patterns.pop() if len(patterns) == 1 else ""


def movie_of(source: PlateSource) -> MovieStream | None:
    """Return the movie whose frames these are; None if they are image files."""
    return source.movie if isinstance(source, MovieFrames) else None


def photographs_of(source: PlateSource) -> Iterator[tuple[PlateSource, Photo]]:
    """Yield up to `FRAMES_ANALYZED` photographs, spread over a source, each behind a source of it alone."""
    if isinstance(source, MovieFrames):
        return ((source.only(number), photo) for number, photo in chosen_photos(source))
    return ((FrameSequence((path,)), read_photo(path)) for path in sample_frames(source))


def chosen_photos(frames: MovieFrames) -> Iterator[tuple[int, Photo]]:
    """Yield up to `FRAMES_ANALYZED` frames for an estimate, one at a time, ascending, each with its number.

    They are key frames if there are enough, which have the best quality. Of each part of the movie, the first at
    `PLACES` is taken that is not nearly black or white and shows something new; the middle ones if none does.
    """
    keys = sorted(set(frames.numbers) & set(frames.movie.key_numbers))
    among = keys if len(keys) >= FRAMES_ANALYZED else frames.numbers
    parts = [part.tolist() for part in np.array_split(among, FRAMES_ANALYZED)]
    candidates = {part[int(place * len(part))]: index for index, part in enumerate(parts) if part for place in PLACES}
    seen: dict[int, Float32Array] = {}
    for number, photo in frames.photos(candidates):
        step, part = max(1, max(photo.shape[:2]) // SAMPLES), candidates[number]
        glimpse = photo[::step, ::step].mean(axis=2)
        is_new = all(np.abs(glimpse - other).mean() >= DIFFERENCE for other in seen.values())
        if part not in seen and is_new and ((glimpse > DARK) & (glimpse < LIGHT)).mean() >= FRACTION:
            seen[part] = glimpse
            yield number, photo
    if not seen:
        yield from _middle_photos(frames, parts)


def _middle_photos(frames: MovieFrames, parts: Sequence[Sequence[int]]) -> Iterator[tuple[int, Photo]]:
    """Yield the frame in the middle of each part, whatever it shows; raise a PlateError if none can be decoded."""
    photos = frames.photos(part[len(part) // 2] for part in parts if part)
    if (first := next(photos, None)) is None:
        raise undecodable(frames.movie.path, "none of its frames")
    yield first
    yield from photos
