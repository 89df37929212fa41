"""A file name with a placeholder for the frame number, such as `plate.%04d.png` or `plate.####.png`.

Fileseq's own reader of file names is not used: it refuses `a@2x.%03d.png` and `shot_v2-%04d.png`, and takes the 1 in
`v1####.png` for a frame.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from ..errors import PlateError

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
                raise PlateError("several_placeholders", path=path, count=len(matches))
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
        matches = ((path, named.fullmatch(path.name)) for path in listed(self.folder))
        numbered = {
            int(match[1]): path for path, match in matches if match and self.path(int(match[1])).name == path.name
        }
        return {number: path for number, path in numbered.items() if path.is_file()}


def listed(folder: Path) -> list[Path]:
    """Return what a folder holds; raise a PlateError if it cannot be listed."""
    try:
        return list(folder.iterdir())
    except OSError as problem:
        raise PlateError("cannot_list", folder=folder, problem=problem.strerror) from problem


def _width(mark: str, frames: str) -> int:
    """Return the number of digits to which a placeholder pads; without one, to those of the first frame."""
    if not mark:
        return len(re.split(r"(?<=[0-9])\D", frames)[0])
    if mark[0] in "%$":
        return int(mark.strip("%d$F") or 1)
    return 4 if mark == "#" else len(mark)
