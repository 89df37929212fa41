"""The times of all frames of a movie, without decoding: which frame has which number, and where decoding begins."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from ..errors import PlateError

if TYPE_CHECKING:
    from av.container import InputContainer
    from av.video.stream import VideoStream


@dataclass(frozen=True)
class FrameIndex:
    """When the frames are shown; the first has number 1.

    Parameters
    ----------
    times : tuple of int
        The presentation times of all frames, ascending, in the time base of the stream.
    key_times : tuple of int
        Those of the frames at which decoding can begin, ascending.
    """

    times: tuple[int, ...]
    key_times: tuple[int, ...]

    @cached_property
    def numbers(self) -> dict[int, int]:
        """Presentation time -> number of the frame."""
        return {time: number for number, time in enumerate(self.times, 1)}

    @cached_property
    def key_numbers(self) -> tuple[int, ...]:
        """Numbers of the frames at which decoding can begin, ascending."""
        return tuple(self.numbers[time] for time in self.key_times)

    def key_before(self, number: int) -> int:
        """Return the number of the last key frame that is not after a frame; of the first frame if there is none."""
        position = bisect_right(self.key_numbers, number)
        return self.key_numbers[position - 1] if position else 1


def read_index(container: InputContainer, stream: VideoStream) -> FrameIndex:
    """Return the index of a movie.

    QuickTime and MP4 files of which every frame is a key frame (ProRes, DNxHD) list them in their header. Other files
    are read to their end once, without decoding.

    Raises
    ------
    PlateError
        If frames have no time, or there is none.
    """
    entries = _listed(stream) or _read(container, stream)
    if any(time is None for time, _ in entries) or not entries:
        raise PlateError("its frames have no times" if entries else "it holds no frame")
    times = tuple(sorted({time for time, _ in entries if time is not None}))
    return FrameIndex(times, tuple(sorted({time for time, is_key in entries if is_key and time is not None})))


def _listed(stream: VideoStream) -> list[tuple[int | None, bool]]:
    """Return the time of each frame, and that it is a key frame; nothing unless the header lists them all so."""
    entries = list(stream.index_entries)
    if not entries or len(entries) != stream.frames or not all(entry.is_keyframe for entry in entries):
        return []
    shown: list[tuple[int | None, bool]] = [(entry.timestamp, True) for entry in entries if not entry.is_discard]
    return shown if shown and shown[0][0] == stream.start_time else []


def _read(container: InputContainer, stream: VideoStream) -> list[tuple[int | None, bool]]:
    """Return the time of each frame, and whether it is a key frame, from all packets of the stream."""
    packets = (packet for packet in container.demux(stream) if packet.size and not packet.is_discard)
    return [(packet.pts, packet.is_keyframe) for packet in packets]
