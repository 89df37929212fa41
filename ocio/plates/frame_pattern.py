"""A file name with a placeholder for the frame number, such as `plate.%04d.png` or `plate.####.png`.

Fileseq refuses `a@2x.%03d.png` and `shot_v2-%04d.png`, and takes the 1 in `v1####.png` for a frame.
"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from ..errors import PlateError

#: Placeholders for the frame number, the most explicit first; the first kind in a name counts.
_PLACEHOLDERS = tuple(map(re.compile, (r"%(?:0[0-9]{1,2})?d", r"\$F[0-9]{0,2}(?![A-Z])", "#+", "@+")))


@dataclass(frozen=True)
class FramePattern:
    """A file name with a placeholder for the frame number, which is padded with zeros to `width` digits."""

    folder: Path
    prefix: str
    width: int
    suffix: str

    @classmethod
    def parse(cls, pattern: str | Path) -> Self | None:
        """Return the pattern, or None for a name without a placeholder; those in the folder's name do not count.

        `%04d`, `$F4`, `####` and, as in oiiotool and RV, `#` pad to four digits, `@@@` to three; `%d` and `$F` do not.
        Raise a PlateError if there are several placeholders of the same kind.
        """
        path = Path(pattern)
        for placeholder in _PLACEHOLDERS:
            matches = list(placeholder.finditer(path.name))
            if len(matches) > 1:
                raise PlateError("several_placeholders", path=path, count=len(matches))
            if matches:
                start, end = matches[0].span()
                return cls(path.parent, path.name[:start], _width(matches[0][0]), path.name[end:])
        return None

    @property
    def rule(self) -> str:
        """The names of the files in a file rule, where `#` is any number and `[#]` a character: see `rule_regex`."""
        return "#".join(map(literal, (self.prefix, self.suffix)))

    def path(self, number: int) -> Path:
        """Return the file of a frame."""
        return self.folder / f"{self.prefix}{number:0{self.width}d}{self.suffix}"

    def files(self) -> dict[int, Path]:
        """Return the existing files by frame number; raise a PlateError if the folder cannot be listed."""
        named = re.compile(f"{re.escape(self.prefix)}(-?[0-9]{{1,18}}){re.escape(self.suffix)}")
        numbers = {int(match[1]) for path in listed(self.folder) if (match := named.fullmatch(path.name))}
        return {number: self.path(number) for number in numbers if self.path(number).is_file()}


def listed(folder: Path) -> list[Path]:
    """Return what a folder holds; raise a PlateError if it cannot be listed."""
    try:
        return list(folder.iterdir())
    except OSError as problem:
        raise PlateError("cannot_list", folder=folder, problem=problem.strerror) from problem


def _width(mark: str) -> int:
    """Return the number of digits to which a placeholder pads."""
    if mark[0] in "%$":
        return int(mark.strip("%d$F") or 1)
    return 4 if mark == "#" else len(mark)


def literal(name: str) -> str:
    """Return a name as a part of the pattern of a file rule, in which `[#]` stands for the character `#`."""
    return name.replace("#", "[#]")
