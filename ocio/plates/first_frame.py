"""The first frame of a source that can be read: its tags hold for all."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.errors import CRFNetError

from .frame_files import EncodedFrame, FrameLoader, FrameSource


@dataclass(frozen=True, eq=False)
class SourceFrame:
    """A frame to be read.

    Parameters
    ----------
    position : int
        Its position in the source.
    path : Path
        Its file.
    load : callable
        What reads it.
    """

    position: int
    path: Path
    load: FrameLoader

    @classmethod
    def of(cls, sequence: FrameSource, position: int, load: FrameLoader) -> SourceFrame:
        """Return a frame of a source; those of a movie have one file."""
        return cls(position, sequence.paths[min(position, len(sequence.paths) - 1)], load)


@dataclass(frozen=True, eq=False)
class FirstFrame:
    """The first frame that can be read, so that it is not read twice."""

    source: SourceFrame
    frame: EncodedFrame

    @property
    def size(self) -> tuple[int, int]:
        """Its width and height in pixels."""
        return self.frame.header.width, self.frame.header.height


def first_frame(sequence: FrameSource) -> FirstFrame | None:
    """Return the first frame that can be read; None if there is none, and each fails with an error of its own."""
    for position, load in enumerate(sequence.loaders(range(max(1, len(sequence.numbers))))):
        with suppress(CRFNetError):
            return FirstFrame(SourceFrame.of(sequence, position, load), load())
    return None
