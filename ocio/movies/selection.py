"""The frames of a movie from which a response is estimated: spread over it, and chosen by what they show."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.photo import Photo
from crfnet_core.types import Float32Array

from ..defaults import FRAMES_ANALYZED
from .frames import MovieFrames

#: Where in each part of the movie a frame is looked for, in turn.
PLACES = (0.5, 0.2, 0.8)

#: Brightness in [0, 1] between which a frame shows something, and the least fraction of its samples there.
DARK, LIGHT, FRACTION = 0.08, 0.98, 0.1

#: Least mean difference in brightness between two frames; two that differ less show the same picture.
DIFFERENCE = 0.01

#: Samples along the longer side of a frame by which it is judged.
SAMPLES = 96


def chosen_photos(frames: MovieFrames, count: int = FRAMES_ANALYZED) -> Iterator[tuple[int, Photo]]:
    """Yield up to `count` frames for an estimate, one at a time, ascending, each with its number.

    The movie is cut into `count` parts. Of each part its key frame nearest to the middle is taken, since that is
    decoded alone and has the best quality, or the frame in the middle where there is none. If it is nearly black or
    white, or shows the same as one that was taken, other places in the part are tried. If no frame of the movie
    passes, the middle ones are taken as they are.

    Parameters
    ----------
    frames : MovieFrames
        The frames to choose from.
    count : int
        How many at most.

    Raises
    ------
    PhotoError
        If none of these frames can be decoded.
    """
    parts = [part.tolist() for part in np.array_split(frames.numbers, count) if len(part)]
    seen: list[Float32Array] = []
    for part in parts:
        yield from _telling_photo(frames, part, seen)
    if not seen:
        yield from _middle_photos(frames, parts)


def _telling_photo(frames: MovieFrames, part: Sequence[int], seen: list[Float32Array]) -> Iterator[tuple[int, Photo]]:
    """Yield the first frame of a part that shows something new, if there is one, and note what it shows."""
    for number in _candidates(part, frames.movie.index.key_numbers):
        for _, photo in frames.photos([number]):
            glimpse = _glimpse(photo)
            if _shows_something(glimpse) and all(np.abs(glimpse - other).mean() >= DIFFERENCE for other in seen):
                seen.append(glimpse)
                yield number, photo
                return


def _middle_photos(frames: MovieFrames, parts: Sequence[Sequence[int]]) -> Iterator[tuple[int, Photo]]:
    """Yield the frame in the middle of each part, whatever it shows."""
    is_empty = True
    for number, photo in frames.photos(part[len(part) // 2] for part in parts):
        is_empty = False
        yield number, photo
    if is_empty:
        raise PhotoError(f"{frames.movie.path}: none of its frames can be decoded; copy it again")


def _candidates(part: Sequence[int], key_numbers: Sequence[int]) -> list[int]:
    """Return the frames of a part to look at, each once: at `PLACES`, or the nearest key frames."""
    numbers = set(part)
    keys = [number for number in key_numbers if number in numbers]
    places = [part[min(len(part) - 1, int(place * len(part)))] for place in PLACES]
    return list(dict.fromkeys(min(keys, key=lambda key: abs(key - place)) if keys else place for place in places))


def _glimpse(photo: Photo) -> Float32Array:
    """Return a coarse pick of a frame's brightness, the mean of the channels, shape (h, w)."""
    step = max(1, max(photo.shape[:2]) // SAMPLES)
    glimpse: Float32Array = photo[::step, ::step].mean(axis=2)
    return glimpse


def _shows_something(glimpse: Float32Array) -> bool:
    """Return whether enough of a frame is neither black nor white."""
    return bool(((glimpse > DARK) & (glimpse < LIGHT)).mean() >= FRACTION)
