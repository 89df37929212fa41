"""What a name on the command line stands for: the frames of a movie, of a sequence, or a single file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ocio.movies.frames import MovieFrames
from ocio.movies.library import is_movie
from ocio.plates.frames import FrameSequence, find_frames


def find_source(pattern: str | Path, frames: str | Iterable[int] | None = None) -> FrameSequence | MovieFrames:
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
