"""The text of a LUT file. Every fault is an error that names the file, the line and the remedy."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crfnet_core.files import read_bytes

from ..errors import LutError
from .lut1d import first_fault, single_precision
from .rgb_lut import AnyLut, lut_of_columns

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
            content = read_bytes(path, most=MAX_FILE_SIZE)
        except OSError as problem:
            raise LutError(f"{path}: cannot be read ({problem.strerror}); check the name of the LUT") from problem
        text = content.decode("utf-8-sig", errors="replace")
        if "\0" in text:
            raise LutError(f"{path}: is no text file; give a .spi1d, .cube or .clf LUT")
        if not text.strip():
            raise LutError(f"{path}: is empty; write the LUT again")
        return cls(path, tuple(text.replace("\r\n", "\n").removesuffix("\n").split("\n")))

    def error(self, problem: str, *, line: int | None = None) -> LutError:
        """Return the error that names the file, the line and the problem."""
        return LutError(f"{self.path}: {problem}" if line is None else f"{self.path}, line {line}: {problem}")

    def numbers(self, text: str, line: int | None, *, count: int) -> list[float]:
        """Return the numbers in `text`; raise a LutError unless they are `count` finite ones."""
        numbers = []
        for token in text.split():
            try:
                number = float(token.replace("_", " ") if token.isascii() else "")  # Python alone reads 1_0
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
        scale: int = 1,
    ) -> AnyLut:
        """Return the LUT of a table, for each channel if its columns differ.

        Parameters
        ----------
        rows : iterable of (int, str)
            Line number and text of each entry: one value, or three.
        length, channels : float
            The number of entries, and of values per entry, that the file announces.
        domain : tuple of float
            The first and the last input.
        comments : sequence of str
            Provenance.
        scale : int
            What stands for 1 in the file.

        Raises
        ------
        LutError
            If the table is incomplete or does not increase strictly.
        """
        if channels not in (1, 3):
            raise self.error(f"has {channels:g} channels; a LUT of a camera's response has 1 or 3")
        lines: list[int] = []
        entries: list[list[float]] = []
        for line, text in rows:
            entries.append(self.numbers(text, line, count=int(channels)))
            lines.append(line)
        if len(entries) != length:
            raise self.error(f"holds {len(entries)} entries and announces {length:g}; the file is cut or altered")
        table = np.reshape(entries, (-1, int(channels)))
        for column in table.T:
            fault = first_fault(single_precision(column / scale))
            if fault is not None:
                message = f"{column[fault]:.9g} is not above the value before it; a LUT that can be inverted increases"
                raise self.error(message, line=lines[fault])
        try:
            return lut_of_columns(table / scale, domain=domain, comments=comments)
        except LutError as problem:
            raise self.error(str(problem)) from problem


def table_rows(lut: AnyLut, *, columns: int = 0) -> list[str]:
    """Return the rows of a table with nine digits, which keep float32 values bit for bit.

    Parameters
    ----------
    lut : Lut1D or RgbLut1D
        The LUT.
    columns : int
        Values in each row; by default as many as the LUT has channels. A single one is repeated.
    """
    table = np.stack([channel.values for channel in lut.channels], axis=1)  # (N, 1) or (N, 3)
    if columns > 1:
        table = np.broadcast_to(table, (len(table), columns))
    return [" ".join(f"{value:.9g}" for value in row) for row in table.tolist()]
