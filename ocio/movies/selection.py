"""The frames of a movie from which a response is estimated: spread over it, and neither black, white nor alike."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from crfnet_core.photograph.photo import Photo
from crfnet_core.types import Float32Array

from ..defaults import FRAMES_ANALYZED
from .frames import MovieFrames
from .library import undecodable

#: Where in each part of the movie a frame is looked for, in turn.
PLACES = (0.5, 0.7, 0.9)

#: Brightness in [0, 1] between which a frame shows something, and the least fraction of its samples there.
DARK, LIGHT, FRACTION = 0.08, 0.98, 0.1

#: Least mean difference in brightness between two frames; two that differ less show the same picture.
DIFFERENCE = 0.01

#: Samples along the longer side of a frame by which it is judged.
SAMPLES = 96


def chosen_photos(frames: MovieFrames, count: int = FRAMES_ANALYZED) -> Iterator[tuple[int, Photo]]:
    """Yield up to `count` frames for an estimate, one at a time, ascending, each with its number.

    They are key frames if there are enough, which are decoded alone and have the best quality. They are cut into
    `count` parts; of each, the first of the frames at `PLACES` is taken that is not nearly black or white and does not
    show the same as one before. If no frame of the movie passes, the middle ones are taken as they are. Raise a
    PlateError if none of these can be decoded.
    """
    keys = sorted(set(frames.numbers) & set(frames.movie.key_numbers))
    parts = [part.tolist() for part in np.array_split(keys if len(keys) >= count else frames.numbers, count)]
    candidates = {part[int(place * len(part))]: index for index, part in enumerate(parts) if part for place in PLACES}
    seen: dict[int, Float32Array] = {}
    for number, photo in frames.photos(candidates):
        glimpse, part = _glimpse(photo), candidates[number]
        is_new = all(np.abs(glimpse - other).mean() >= DIFFERENCE for other in seen.values())
        if part not in seen and is_new and ((glimpse > DARK) & (glimpse < LIGHT)).mean() >= FRACTION:
            seen[part] = glimpse
            yield number, photo
    if not seen:
        yield from _middle_photos(frames, parts)


def _middle_photos(frames: MovieFrames, parts: Sequence[Sequence[int]]) -> Iterator[tuple[int, Photo]]:
    """Yield the frame in the middle of each part, whatever it shows."""
    is_empty = True
    for number, photo in frames.photos(part[len(part) // 2] for part in parts if part):
        is_empty = False
        yield number, photo
    if is_empty:
        raise undecodable(frames.movie.path, "none of its frames")


def _glimpse(photo: Photo) -> Float32Array:
    """Return a coarse pick of a frame's brightness, the mean of the channels, shape (h, w)."""
    step = max(1, max(photo.shape[:2]) // SAMPLES)
    glimpse: Float32Array = photo[::step, ::step].mean(axis=2)
    return glimpse
