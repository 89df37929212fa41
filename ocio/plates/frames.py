"""The frames that a name stands for: find their files (a folder's by Fileseq), choose some of them."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from crfnet_core.files import file_sha256

from ..defaults import FRAMES_ANALYZED
from ..errors import PlateError
from .frame_files import FrameLoader, FrameSource, read_frame
from .frame_numbers import MAX_FRAMES, format_frames, parse_frames
from .frame_pattern import FramePattern, listed

#: Kind of a name that is not a pattern -> the code of the error that it stands for no frames; see `_kind`.
_NO_SEQUENCE = {"folder": "folder_without_sequence", "file": "single_file", "pipe": "not_a_file", "": "no_such_plate"}


@dataclass(frozen=True)
class FrameSequence:
    """The files that a name or a pattern stands for, in the order of their frame numbers; at least one."""

    paths: tuple[Path, ...]
    numbers: tuple[int, ...] = ()  # a single file has none
    missing: tuple[int, ...] = ()  # asked for, or between the first and the last, and without a file
    is_encoded: bool = False  # whether OpenEXR files that do not state their encoding hold encoded values
    pattern: str = ""  # the names of all frames, as in a file rule; empty for a single file

    def loaders(self, positions: Sequence[int]) -> Iterator[FrameLoader]:
        """Yield what reads each frame, for positions in `paths`: see `FrameSource`."""
        return (partial(read_frame, self.paths[position], is_encoded=self.is_encoded) for position in positions)


def find_frames(pattern: str | Path, frames: str | Iterable[int] | None = None) -> FrameSequence:
    """Return the files of a single file's name, of a `FramePattern`, or of a folder that holds one sequence."""
    path = Path(pattern)
    kind = _kind(path)
    if frames is None and kind == "file":  # before patterns, so its name may hold # or @
        return FrameSequence((path,))
    parsed = _only_sequence(path) if kind == "folder" else FramePattern.parse(path)
    if parsed is None:
        raise PlateError(_NO_SEQUENCE[kind], path=path)
    return pattern_frames(parsed, frames, name=path)


def pattern_frames(
    pattern: FramePattern, frames: str | Iterable[int] | None = None, *, name: str | Path
) -> FrameSequence:
    """Return the files of a pattern that messages call `name`; see `find_frames`."""
    files = pattern.files()
    wanted = _span(files, Path(name)) if frames is None else parse_frames(frames)
    numbers = tuple(number for number in wanted if number in files)
    if not numbers:
        raise PlateError("no_such_frames", path=name, frames=format_frames(sorted(files)) or "none")
    missing = tuple(number for number in wanted if number not in files)
    return FrameSequence(tuple(files[number] for number in numbers), numbers, missing, pattern=pattern.rule)


def sample_frames(sequence: FrameSequence, count: int = FRAMES_ANALYZED) -> tuple[Path, ...]:
    """Return up to `count` (1 or more) evenly spread files of a sequence, including the first and the last."""
    last = len(sequence.paths) - 1
    steps = max(1, count - 1)
    positions = {(2 * last * step + steps) // (2 * steps) for step in range(count)}  # last * step / steps, rounded
    return tuple(sequence.paths[position] for position in sorted(positions))


def identities(sequence: FrameSource) -> Callable[[int], str]:
    """Return the names of plates by their content: SHA-256 of the file at a position; of a movie, and the number."""
    if isinstance(sequence, FrameSequence):
        return lambda position: file_sha256(sequence.paths[position])
    movie = ThreadPoolExecutor(1).submit(file_sha256, sequence.paths[0])  # many gigabytes, read during the decoding
    return lambda position: f"{movie.result()} {sequence.numbers[position]}"


def _only_sequence(folder: Path) -> FramePattern:
    """Return the pattern of the one sequence in a folder: two files or more that differ in their number alone."""
    from fileseq.filesequence import FileSequence  # only here: see the module

    names = [path.name for path in listed(folder) if not path.name.startswith(".") and path.is_file()]
    sequences = [each for each in FileSequence.findSequencesInList(sorted(names)) if len(each) > 1]
    patterns = [_pattern(folder, each.basename(), each.zfill(), each.extension(), each.start()) for each in sequences]
    if len(patterns) == 1:
        return patterns[0]
    if not patterns:
        raise PlateError(_NO_SEQUENCE["folder"], path=folder)
    named = [f"{each.prefix}%0{each.width}d{each.suffix}" for each in patterns[:5]]
    more = ", …" if patterns[5:] else ""
    raise PlateError("several_sequences", path=folder, count=len(patterns), patterns=", ".join(named) + more)


def _pattern(folder: Path, prefix: str, width: int, suffix: str, first: Any) -> FramePattern:
    """Return the pattern of a sequence that Fileseq found, which reads the dash of shot-0001.png as a minus."""
    if first < 0 and prefix[-1:].isalnum():
        prefix, width = prefix + "-", width - 1
    return FramePattern(folder, prefix, width, suffix)


def _kind(path: Path) -> str:
    """Return "file", "folder", "pipe", also of a device, or "": absent, or refused by the system."""
    try:
        return "file" if path.is_file() else "folder" if path.is_dir() else "pipe" if path.exists() else ""
    except OSError:
        return ""


def _span(files: Iterable[int], path: Path) -> Sequence[int]:
    """Return all frame numbers from the first to the last file."""
    numbers = sorted(files)
    if not numbers:
        return ()
    if numbers[-1] - numbers[0] > MAX_FRAMES:
        raise PlateError("frames_far_apart", path=path, first=numbers[0], last=numbers[-1])
    return range(numbers[0], numbers[-1] + 1)
