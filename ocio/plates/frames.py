"""The frames of a sequence such as `plate.%04d.png` or `plate.####.png`: find their files, choose some of them.

Fileseq reads ranges of frames and finds the sequences of a folder. It is imported only there: what the Blender add-on
calls does without it, so the add-on need not bring it. Fileseq's own reader of file names is not used: it refuses
`a@2x.%03d.png` and `shot_v2-%04d.png`, and takes the 1 in `v1####.png` for a frame.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from operator import index
from pathlib import Path
from typing import Any

from crfnet_core.errors import PlateError
from ocio.defaults import FRAMES_ANALYZED
from ocio.plates.frame_files import FrameLoader, read_frame

#: Frames that a specification, or a sequence including its gaps, may span; more is taken for a mistake.
MAX_FRAMES = 1_000_000

_END = r"--?[0-9]{1,9}(?:x[0-9]{1,9})?"

#: Frames in a name: ranges with a step or without, separated by commas; the first of them is no single frame.
_RANGES = rf"-?[0-9]{{1,9}}{_END}(?:,-?[0-9]{{1,9}}(?:{_END})?)*"

#: Placeholders for the frame number, the most explicit first; the first kind found in a name is the one that counts.
#: Before the placeholder may be the frames, as in shot.1001-1100#.png; shot.[1001-1100].png is the frames alone.
_PLACEHOLDERS = (
    *(
        re.compile(rf"(?:(?<![^._ ])(?P<frames>{_RANGES}))?(?P<mark>{mark})")
        for mark in ("%(?:0[0-9]{1,2})?d", r"\$F[0-9]{0,2}(?![A-Z])", "#+", "@+")
    ),
    re.compile(rf"\[(?P<frames>{_RANGES})\](?P<mark>)"),
)


@dataclass(frozen=True)
class FrameSequence:
    """The files that a name or a pattern stands for.

    Parameters
    ----------
    paths : tuple of Path
        The files, in the order of their frame numbers; at least one.
    numbers : tuple of int
        The frame number of each; empty for a single file, which has none.
    missing : tuple of int
        Frame numbers asked for, or between the first and the last, for which there is no file.
    is_encoded : bool
        Whether OpenEXR files that do not say how their values are encoded hold encoded values.
    """

    paths: tuple[Path, ...]
    numbers: tuple[int, ...] = ()
    missing: tuple[int, ...] = ()
    is_encoded: bool = False

    def loaders(self, positions: Sequence[int]) -> Iterator[FrameLoader]:
        """Yield what reads each frame, for positions in `paths`: see `FrameSource`."""
        return (partial(read_frame, self.paths[position], is_encoded=self.is_encoded) for position in positions)


@dataclass(frozen=True)
class FramePattern:
    """A file name with one frame placeholder.

    Parameters
    ----------
    folder : Path
        The folder of the files.
    prefix, suffix : str
        The parts of the name before and after the frame number.
    width : int
        Digits to which the number is padded with zeros.
    frames : str
        The frames that the name itself asks for, such as "1001-1100"; empty for all.
    """

    folder: Path
    prefix: str
    width: int
    suffix: str
    frames: str = ""

    @classmethod
    def parse(cls, pattern: str | Path) -> FramePattern | None:
        """Return the pattern, or None for a name without a placeholder.

        `%04d`, `$F4` and `####` pad to four digits, `@@@` to three; `%d` and `$F` do not pad. A single `#` means four
        digits, as in oiiotool and RV; several mean as many digits, as in Nuke. `shot.1001-1100#.png` and
        `shot.[1001-1100].png` ask for some of the frames; the second pads as its first number does. Placeholders in
        the name of the folder do not count.

        Raises
        ------
        PlateError
            If the name holds several placeholders of the same kind.
        """
        path = Path(pattern)
        for placeholder in _PLACEHOLDERS:
            matches = list(placeholder.finditer(path.name))
            if len(matches) > 1:
                raise PlateError(f"{path}: holds {len(matches)} frame placeholders; leave one of them")
            if matches:
                start, end = matches[0].span()
                frames = matches[0]["frames"] or ""
                return cls(path.parent, path.name[:start], _width(matches[0]["mark"], frames), path.name[end:], frames)
        return None

    def path(self, number: int) -> Path:
        """Return the file of a frame."""
        return self.folder / f"{self.prefix}{number:0{self.width}d}{self.suffix}"

    def files(self) -> dict[int, Path]:
        """Return the existing files by frame number; raise a PlateError if the folder cannot be listed."""
        named = re.compile(f"{re.escape(self.prefix)}(-?[0-9]{{1,18}}){re.escape(self.suffix)}")
        matches = ((path, named.fullmatch(path.name)) for path in _listed(self.folder))
        numbered = {
            int(match[1]): path for path, match in matches if match and self.path(int(match[1])).name == path.name
        }
        return {number: path for number, path in numbered.items() if path.is_file()}


def find_frames(pattern: str | Path, frames: str | Iterable[int] | None = None) -> FrameSequence:
    """Return the files that `pattern` stands for.

    Parameters
    ----------
    pattern : str or Path
        The name of one file, of a sequence with a placeholder for the frame number (see `FramePattern.parse`), or of a
        folder that holds one sequence. An existing file of exactly this name is taken first, so the name of a single
        file may hold `#` or `@`.
    frames : str, iterable of int, or None
        The frames to use, as in `parse_frames`; by default those that the pattern names, or all existing ones.

    Raises
    ------
    PlateError
        If nothing is found, `frames` is given for a single file or beside frames in the pattern or is malformed, or a
        folder holds several sequences or none.
    """
    path = Path(pattern)
    kind = _kind(path)
    if frames is None and kind == "file":
        return FrameSequence((path,))
    parsed = _only_sequence(path) if kind == "folder" else FramePattern.parse(path)
    if parsed is None:
        raise PlateError(f"{path}: {_no_sequence(path)}")
    if parsed.frames and frames is not None:
        raise PlateError(f"{path}: names the frames {parsed.frames} itself; give them once")
    return pattern_frames(parsed, frames if frames is not None else parsed.frames or None, name=path)


def pattern_frames(
    pattern: FramePattern, frames: str | Iterable[int] | None = None, *, name: str | Path
) -> FrameSequence:
    """Return the files of a pattern, for a caller that knows the parts of the name; see `find_frames`.

    Messages call it `name`. The frames that the pattern names itself do not count.
    """
    files = pattern.files()
    wanted = _span(files, Path(name)) if frames is None else parse_frames(frames)
    numbers = tuple(number for number in wanted if number in files)
    if not numbers:
        there = f"there are {format_frames(sorted(files))}" if files else "there is no frame of this name"
        raise PlateError(f"{name}: {there}; check the name and the frames")
    missing = tuple(number for number in wanted if number not in files)
    return FrameSequence(tuple(files[number] for number in numbers), numbers, missing)


def sample_frames(sequence: FrameSequence, count: int = FRAMES_ANALYZED) -> tuple[Path, ...]:
    """Return up to `count` (1 or more) evenly spread files of a sequence, including the first and the last."""
    last = len(sequence.paths) - 1
    steps = max(1, count - 1)
    positions = {(2 * last * step + steps) // (2 * steps) for step in range(count)}  # last * step / steps, rounded
    return tuple(sequence.paths[position] for position in sorted(positions))


def parse_frames(frames: str | Iterable[int]) -> tuple[int, ...]:
    """Return the frame numbers of a specification, ascending and each once.

    Parameters
    ----------
    frames : str or iterable of int
        Numbers and ranges, separated by commas, as Fileseq reads them: "1001-1100", "1-10x2" (every second), "1,5,9",
        "-3--1". A range may run backwards; the frames come in ascending order all the same.

    Raises
    ------
    PlateError
        If it is malformed, holds parts of frames, or there are more than `MAX_FRAMES` frames.
    """
    if not isinstance(frames, str):
        return tuple(sorted({index(number) for number in frames}))
    from fileseq.exceptions import MaxSizeException, ParseException  # only here: see the module
    from fileseq.frameset import FrameSet

    found: Collection[Any] = ()
    try:
        if frames.isascii() and all(frames.split(",")):
            found = FrameSet(frames)
    except MaxSizeException:
        found = range(MAX_FRAMES + 1)
    except ParseException:
        found = ()
    if len(found) > MAX_FRAMES:
        raise PlateError(f"frames {frames!r}: more than {MAX_FRAMES} frames; give fewer")
    if not found or any(number != int(number) for number in found):
        raise PlateError(f"frames {frames!r}: is no frame or range; give, say, 1001-1100, 1-9x2 or 1,5,9")
    return tuple(sorted(map(int, found)))


def format_frames(numbers: Sequence[int], limit: int = 5) -> str:
    """Return ascending frame numbers as ranges, for example "1-3, 7, 9-12", with an ellipsis after `limit` ranges."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    texts = [str(first) if first == last else f"{first}-{last}" for first, last in ranges]
    return ", ".join(texts[:limit]) + (", …" if len(texts) > limit else "")


def _width(mark: str, frames: str) -> int:
    """Return the number of digits to which a placeholder pads; without one, to those of the first frame."""
    if not mark:
        return len(re.split(r"(?<=[0-9])\D", frames)[0])
    if mark[0] in "%$":
        return int(mark.strip("%d$F") or 1)
    return 4 if mark == "#" else len(mark)


def _only_sequence(folder: Path) -> FramePattern:
    """Return the pattern of the one sequence in a folder: two files or more that differ in their number alone."""
    from fileseq.filesequence import FileSequence  # only here: see the module

    names = [path.name for path in _listed(folder) if not path.name.startswith(".") and path.is_file()]
    sequences = [found for found in FileSequence.findSequencesInList(sorted(names)) if len(found) > 1]
    patterns = [
        _pattern(folder, found.basename(), found.zfill(), found.extension(), found.start()) for found in sequences
    ]
    if len(patterns) == 1:
        return patterns[0]
    if not patterns:
        raise PlateError(f"{folder}: {_no_sequence(folder)}")
    named = [f"{each.prefix}%0{each.width}d{each.suffix}" for each in patterns[:5]]
    more = ", …" if patterns[5:] else ""
    raise PlateError(f"{folder}: holds {len(patterns)} sequences: {', '.join(named)}{more}; give one of them")


def _pattern(folder: Path, prefix: str, width: int, suffix: str, first: Any) -> FramePattern:
    """Return the pattern of a sequence that Fileseq found, which reads the dash of shot-0001.png as a minus."""
    if first < 0 and prefix[-1:].isalnum():
        prefix, width = prefix + "-", width - 1
    return FramePattern(folder, prefix, width, suffix)


def _listed(folder: Path) -> list[Path]:
    """Return what a folder holds; raise a PlateError if it cannot be listed."""
    try:
        return list(folder.iterdir())
    except OSError as problem:
        raise PlateError(f"{folder}: cannot be listed ({problem.strerror}); check the folder") from problem


def _kind(path: Path) -> str:
    """Return "file", "folder", or "" for a name that does not exist or that the system refuses."""
    try:
        return "file" if path.is_file() else "folder" if path.is_dir() else ""
    except OSError:
        return ""


def _no_sequence(path: Path) -> str:
    """Return why a name that is no pattern, and that is not taken as a single file, stands for no frames."""
    sequence = "a sequence such as plate.%04d.png or plate.####.png"
    return {
        "folder": f"is a folder without a sequence; give a file in it, or {sequence}",
        "file": "is a single file, which has no frames to choose from; leave the frames away or give a pattern",
        "": f"there is no such file; check the name, or give {sequence}",
    }[_kind(path)]


def _span(files: Iterable[int], path: Path) -> Sequence[int]:
    """Return all frame numbers from the first to the last file."""
    numbers = sorted(files)
    if not numbers:
        return ()
    if numbers[-1] - numbers[0] > MAX_FRAMES:
        raise PlateError(f"{path}: frames {numbers[0]} to {numbers[-1]} are too far apart; say which frames to use")
    return range(numbers[0], numbers[-1] + 1)
