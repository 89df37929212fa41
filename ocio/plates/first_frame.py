"""The first frame of a source that can be read: its tags hold for all."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from .frame_files import EncodedFrame, FrameSource


@dataclass(frozen=True, eq=False)
class FirstFrame:
    """The first frame that can be read, its position in the source and its file, so that it is not read twice."""

    position: int
    path: Path
    frame: EncodedFrame

    @property
    def size(self) -> tuple[int, int]:
        """Its width and height in pixels."""
        return self.frame.header.width, self.frame.header.height


def first_frame(sequence: FrameSource) -> FirstFrame | None:
    """Return the first frame that can be read; None if there is none, and each fails with an error of its own."""
    for position, load in enumerate(sequence.loaders(range(max(1, len(sequence.numbers))))):
        with suppress(Exception, SystemExit, GeneratorExit):  # all but an interruption
            return FirstFrame(position, frame_path(sequence, position), load())
    return None


def frame_path(sequence: FrameSource, position: int) -> Path:
    """Return the file of a frame; those of a movie have one file."""
    return sequence.paths[min(position, len(sequence.paths) - 1)]
