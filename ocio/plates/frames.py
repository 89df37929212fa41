"""The frames of a sequence such as `plate.%04d.png` or `plate.####.png`: find their files, choose some of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import index
from pathlib import Path

from crfnet_core.errors import PlateError
from ocio.defaults import FRAMES_ANALYZED

#: Frames that a specification, or a sequence including its gaps, may span; more is taken for a mistake.
MAX_FRAMES = 1_000_000

#: Placeholders for the frame number, the most explicit first; the first kind found in a name is the one that counts.
_PLACEHOLDERS = (re.compile(r"%(?:0([0-9]{1,2}))?d"), re.compile("#+"), re.compile("@+"))

_RANGE = re.compile(r"(-?\d{1,9})(?:-(-?\d{1,9})(?:x(\d{1,9}))?)?", re.ASCII)


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
    """

    paths: tuple[Path, ...]
    numbers: tuple[int, ...] = ()
    missing: tuple[int, ...] = ()


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
    """

    folder: Path
    prefix: str
    width: int
    suffix: str

    @classmethod
    def parse(cls, pattern: str | Path) -> FramePattern | None:
        """Return the pattern, or None for a name without a placeholder.

        `%04d` and `####` pad to four digits, `@@@` to three; `%d` does not pad. A single `#` means four digits, as in
        oiiotool and RV; several mean as many digits, as in Nuke. Placeholders in the name of the folder do not count.

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
                return cls(path.parent, path.name[:start], _width(matches[0]), path.name[end:])
        return None

    def path(self, number: int) -> Path:
        """Return the file of a frame."""
        return self.folder / f"{self.prefix}{number:0{self.width}d}{self.suffix}"

    def files(self) -> dict[int, Path]:
        """Return the existing files by frame number; raise a PlateError if the folder cannot be listed."""
        named = re.compile(f"{re.escape(self.prefix)}(-?[0-9]{{1,18}}){re.escape(self.suffix)}")
        files = {}
        try:
            for path in self.folder.iterdir():
                match = named.fullmatch(path.name)
                if match and self.path(int(match[1])).name == path.name and path.is_file():
                    files[int(match[1])] = path
        except OSError as problem:
            raise PlateError(f"{self.folder}: cannot be listed ({problem.strerror}); check the folder") from problem
        return files


def find_frames(pattern: str | Path, frames: str | Iterable[int] | None = None) -> FrameSequence:
    """Return the files that `pattern` stands for.

    Parameters
    ----------
    pattern : str or Path
        The name of one file, or of a sequence with a placeholder for the frame number (see `FramePattern.parse`).
        An existing file of exactly this name is taken first, so the name of a single file may hold `#` or `@`.
    frames : str, iterable of int, or None
        The frames to use, as in `parse_frames`; all existing ones by default.

    Raises
    ------
    PlateError
        If nothing is found, or `frames` is given for a single file or is malformed.
    """
    path = Path(pattern)
    if frames is None and _kind(path) == "file":
        return FrameSequence((path,))
    parsed = FramePattern.parse(path)
    if parsed is None:
        raise PlateError(f"{path}: {_no_sequence(path)}")
    files = parsed.files()
    wanted = _span(files, path) if frames is None else parse_frames(frames)
    numbers = tuple(number for number in wanted if number in files)
    if not numbers:
        there = f"there are {format_frames(sorted(files))}" if files else "there is no frame of this name"
        raise PlateError(f"{path}: {there}; check the name and the frames")
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
        Numbers and ranges, separated by commas: "1001-1100", "1-10x2" (every second), "1,5,9", "-3--1".

    Raises
    ------
    PlateError
        If it is malformed, a range runs backwards, a step is 0, or there are more than `MAX_FRAMES` frames.
    """
    if not isinstance(frames, str):
        return tuple(sorted({index(number) for number in frames}))
    numbers: set[int] = set()
    for part in frames.replace(" ", "").split(","):
        match = _RANGE.fullmatch(part)
        if match is None:
            raise PlateError(f"frames {frames!r}: {part!r} is no frame or range; give, say, 1001-1100, 1-9x2 or 1,5,9")
        first, last, step = int(match[1]), int(match[2] or match[1]), int(match[3] or 1)
        if last < first or step == 0:
            raise PlateError(f"frames {frames!r}: {part!r} runs backwards or stands still; give first-last or xSTEP")
        numbers.update(range(first, last + 1, step)[: MAX_FRAMES + 1])
        if len(numbers) > MAX_FRAMES:
            raise PlateError(f"frames {frames!r}: more than {MAX_FRAMES} frames; give fewer")
    return tuple(sorted(numbers))


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


def _width(match: re.Match[str]) -> int:
    """Return the number of digits to which a placeholder pads."""
    text = match[0]
    if text.startswith("%"):
        return int(match[1] or 1)
    return 4 if text == "#" else len(text)


def _kind(path: Path) -> str:
    """Return "file", "folder", or "" for a name that does not exist or that the system refuses."""
    try:
        return "file" if path.is_file() else "folder" if path.is_dir() else ""
    except OSError:
        return ""


def _no_sequence(path: Path) -> str:
    """Return why a name that is neither a pattern nor a file to be used as a whole stands for no frames."""
    sequence = "a sequence such as plate.%04d.png or plate.####.png"
    if _kind(path) == "folder":
        return f"is a folder; give a file in it, or {sequence}"
    if _kind(path) == "file":
        return "is a single file, which has no frames to choose from; leave the frames away or give a pattern"
    return f"there is no such file; check the name, or give {sequence}"


def _span(files: Iterable[int], path: Path) -> Sequence[int]:
    """Return all frame numbers from the first to the last file."""
    numbers = sorted(files)
    if not numbers:
        return ()
    if numbers[-1] - numbers[0] > MAX_FRAMES:
        raise PlateError(f"{path}: frames {numbers[0]} to {numbers[-1]} are too far apart; say which frames to use")
    return range(numbers[0], numbers[-1] + 1)
