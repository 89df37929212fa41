"""The text of a LUT file. Every fault is an error that names the file, the line and the remedy."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crfnet_core.errors import LutError
from ocio.luts.lut1d import Lut1D, first_fault, single_precision

#: Size in bytes of the largest LUT file that is read.
MAX_FILE_SIZE = 64 * 1024 * 1024


@dataclass(frozen=True)
class LutText:
    """The lines of a LUT file, and the errors that name them (1-based)."""

    path: Path
    lines: tuple[str, ...]

    @classmethod
    def read(cls, path: str | Path) -> LutText:
        """Return the text of `path`; raise a LutError if it is absent, empty, too large or no text."""
        path = Path(path)
        try:
            size = path.stat().st_size
            content = path.read_bytes() if size <= MAX_FILE_SIZE else b""
        except OSError as problem:
            raise LutError(f"{path}: cannot be read ({problem.strerror}); check the name of the LUT") from problem
        if size > MAX_FILE_SIZE:
            raise LutError(f"{path}: has {size // 2**20} MiB, more than any 1D LUT; check the name of the LUT")
        text = content.decode("utf-8-sig", errors="replace")
        if "\0" in text:
            raise LutError(f"{path}: is no text file; give a .spi1d, .cube or .clf LUT")
        if not text.strip():
            raise LutError(f"{path}: is empty; write the LUT again")
        return cls(path, tuple(text.splitlines()))

    def error(self, problem: str, *, line: int | None = None) -> LutError:
        """Return the error that names the file, the line and the problem."""
        return LutError(f"{self.path}: {problem}" if line is None else f"{self.path}, line {line}: {problem}")

    def numbers(self, text: str, line: int | None, *, count: int) -> list[float]:
        """Return the numbers in `text`; raise a LutError unless they are `count` finite ones."""
        numbers = []
        for token in text.split():
            try:
                number = float(token)
            except ValueError:
                remedy = "decimals need a point, not a comma" if "," in token else "the file is damaged"
                raise self.error(f"{token[:24]!r} is no number; {remedy}: write the LUT again", line=line) from None
            if not abs(number) <= float(np.finfo(np.float32).max):
                raise self.error(f"{token[:24]} is not finite; write the LUT again from a sound response", line=line)
            numbers.append(number)
        if len(numbers) != count:
            raise self.error(f"found {len(numbers)} number(s), needed {count}; the file is cut or altered", line=line)
        return numbers

    def lut(
        self,
        rows: Iterable[tuple[int, str]],
        *,
        length: float,
        channels: float,
        domain: tuple[float, float],
        comments: Sequence[str],
    ) -> Lut1D:
        """Return the LUT of a table.

        Parameters
        ----------
        rows : iterable of (int, str)
            Line number and text of each entry: one value, or three equal ones.
        length, channels : float
            The number of entries, and of values per entry, that the file announces.
        domain : tuple of float
            The first and the last input.
        comments : sequence of str
            Provenance.

        Raises
        ------
        LutError
            If the table is incomplete, differs between channels, or does not increase strictly.
        """
        if channels not in (1, 3):
            raise self.error(f"has {channels:g} channels; a LUT of a camera's response has 1, or 3 equal ones")
        lines: list[int] = []
        values: list[float] = []
        for line, text in rows:
            entry = self.numbers(text, line, count=int(channels))
            if len(set(entry)) > 1:
                raise self.error("R, G and B differ; give a LUT that treats the channels alike", line=line)
            lines.append(line)
            values.append(entry[0])
        if len(values) != length:
            raise self.error(f"holds {len(values)} entries and announces {length:g}; the file is cut or altered")
        fault = first_fault(single_precision(values))
        if fault is not None:
            message = f"{values[fault]:.9g} is not above the value before it; a LUT that can be inverted increases"
            raise self.error(message, line=lines[fault])
        try:
            return Lut1D(np.array(values), domain, tuple(comments))
        except LutError as problem:
            raise self.error(str(problem)) from problem
