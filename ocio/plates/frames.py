"""The frames of a sequence such as `plate.%04d.png` or `plate.####.png`: find them, choose, read one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from operator import index
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import PlateError
from crfnet_core.image_io import MAX_PIXELS, first_line, read_codes

#: Frames that a specification or a sequence with its gaps may span; more is a mistake.
MAX_FRAMES = 1_000_000

#: Frame placeholders, the most explicit first: a name is split at the first kind that it holds.
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


@dataclass(frozen=True, eq=False)
class EncodedFrame:
    """The samples of a plate before its linearisation.

    Parameters
    ----------
    samples : ndarray, shape (H, W, 3)
        Code values (unsigned integers), or encoded values as float32, not multiplied by alpha.
    largest : int
        The code that stands for 1; 1 for floats.
    alpha : ndarray, float32, shape (H, W), or None
        Coverage in [0, 1].
    header : OpenImageIO.ImageSpec
        The header of the file.
    """

    samples: NDArray[Any]
    largest: int
    alpha: NDArray[np.float32] | None
    header: Any


@dataclass(frozen=True)
class FramePattern:
    """A file name with one frame placeholder.

    Parameters
    ----------
    folder : Path
        The folder of the files.
    prefix, suffix : str
        What stands before and after the frame number.
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

        `%04d` and `####` pad to four digits, `@@@` to three, `%d` to none. A single `#` means four digits, as in
        oiiotool and RV; two and more mean that many, as in Nuke. Placeholders in the folder's name are left alone.

        Raises
        ------
        PlateError
            If the name holds several placeholders of the same kind.
        """
        path = Path(pattern)
        for placeholder in _PLACEHOLDERS:
            found = list(placeholder.finditer(path.name))
            if len(found) > 1:
                raise PlateError(f"{path}: holds {len(found)} frame placeholders; leave one of them")
            if found:
                start, end = found[0].span()
                return cls(path.parent, path.name[:start], _width(found[0]), path.name[end:])
        return None

    def path(self, number: int) -> Path:
        """Return the file of a frame."""
        return self.folder / f"{self.prefix}{number:0{self.width}d}{self.suffix}"

    def files(self) -> dict[int, Path]:
        """Return the files there are, by frame number; a PlateError if the folder cannot be listed."""
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
        A file of exactly this name comes first, so a single file may have `#` or `@` in its name.
    frames : str, iterable of int, or None
        The frames to use, as `parse_frames` takes them; all that are there by default.

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


def sample_frames(sequence: FrameSequence, count: int = 8) -> tuple[Path, ...]:
    """Return up to `count` (1 or more) evenly spread files of a sequence, the first and the last among them."""
    last = len(sequence.paths) - 1
    steps = max(1, count - 1)
    places = {(2 * last * step + steps) // (2 * steps) for step in range(count)}
    return tuple(sequence.paths[place] for place in sorted(places))


def parse_frames(frames: str | Iterable[int]) -> tuple[int, ...]:
    """Return the frame numbers of a specification, ascending and each once.

    Parameters
    ----------
    frames : str or iterable of int
        Numbers and ranges, separated by commas: "1001-1100", "1-10x2" (every second), "1,5,9", "-3--1".

    Raises
    ------
    PlateError
        If it is malformed, a range runs backwards or its step is 0, or there are more than `MAX_FRAMES`.
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
    """Return ascending frame numbers as ranges, "1-3, 7, 9-12", with an ellipsis after `limit` of them."""
    ranges: list[list[int]] = []
    for number in numbers:
        if ranges and number == ranges[-1][1] + 1:
            ranges[-1][1] = number
        else:
            ranges.append([number, number])
    texts = [str(first) if first == last else f"{first}-{last}" for first, last in ranges]
    return ", ".join(texts[:limit]) + (", …" if len(texts) > limit else "")


def read_frame(path: Path) -> EncodedFrame:
    """Return the encoded samples of a file that `read_photo` reads, or of an OpenEXR file that holds encoded values.

    Raises
    ------
    PhotoError, PlateError
        If the file is damaged, too large, of another kind, or scene-linear already.
    """
    if path.suffix.lower() == ".exr":
        return _read_encoded_exr(path)
    values = read_codes(path)
    alpha = None
    if values.alpha is not None:
        alpha = np.divide(values.alpha, np.float32(values.largest), dtype=np.float32)
    samples = values.pixels() if values.is_associated else values.codes
    return EncodedFrame(samples, values.largest, alpha, values.header)


def _read_encoded_exr(path: Path) -> EncodedFrame:
    """Return the encoded values in an OpenEXR file, divided by its alpha."""
    source = oiio.ImageInput.open(str(path))
    problem = oiio.geterror()
    if source is None:
        raise PlateError(f"{path}: cannot be read ({first_line(problem)}); check the file")
    try:
        header = source.spec()
        _check_encoded_exr(path, header)
        values = source.read_image(0, 0, 0, header.nchannels, "float")
        problem = source.geterror()
    finally:
        source.close()
    if values is None or problem:
        raise PlateError(f"{path}: this EXR file is damaged or cut short ({first_line(problem)}); write it again")
    gray = next(place for place, name in enumerate(header.channelnames) if name != "A")
    places = [header.channelindex(name) for name in "RGB"]
    samples = values[..., [gray if place < 0 else place for place in places]]
    if header.alpha_channel < 0:
        return EncodedFrame(samples, 1, None, header)
    alpha = values[..., header.alpha_channel]
    covered = alpha[..., None] != 0
    return EncodedFrame(
        np.divide(samples, alpha[..., None], out=np.zeros_like(samples), where=covered), 1, alpha, header
    )


def _check_encoded_exr(path: Path, header: Any) -> None:
    """Refuse an OpenEXR file that is linear already, too large, deep, or no picture."""
    space = header.get_string_attribute("colorInteropID")
    if space.startswith("lin_"):
        raise PlateError(f"{path}: is scene-linear already ({space}); give the encoded plate")
    if header.image_pixels() > MAX_PIXELS:
        raise PlateError(f"{path}: claims {header.width} x {header.height} pixels; crop it to {MAX_PIXELS} pixels")
    names = set(header.channelnames)
    if header.deep or not (names >= set("RGB") or len(names - {"A"}) == 1):
        raise PlateError(f"{path}: needs channels R, G and B, or a gray one; found {', '.join(header.channelnames)}")


def _width(found: re.Match[str]) -> int:
    """Return the digits of a placeholder."""
    text = found[0]
    if text.startswith("%"):
        return int(found[1] or 1)
    return 4 if text == "#" else len(text)


def _kind(path: Path) -> str:
    """Return "file", "folder" or "": a name that the system refuses is nothing."""
    try:
        return "file" if path.is_file() else "folder" if path.is_dir() else ""
    except OSError:
        return ""


def _no_sequence(path: Path) -> str:
    """Return what is wrong with a name that is neither a file to be used whole nor a pattern."""
    sequence = "a sequence such as plate.%04d.png or plate.####.png"
    if _kind(path) == "folder":
        return f"is a folder; give a file in it, or {sequence}"
    if _kind(path) == "file":
        return "is a single file, which has no frames to choose from; leave the frames away or give a pattern"
    return f"there is no such file; check the name, or give {sequence}"


def _span(files: Iterable[int], path: Path) -> Sequence[int]:
    """Return the numbers from the first to the last file."""
    numbers = sorted(files)
    if not numbers:
        return ()
    if numbers[-1] - numbers[0] > MAX_FRAMES:
        raise PlateError(f"{path}: frames {numbers[0]} to {numbers[-1]} are too far apart; say which frames to use")
    return range(numbers[0], numbers[-1] + 1)
