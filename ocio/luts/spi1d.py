"""The .spi1d format: Sony Imageworks' 1D LUT, the simplest that OpenColorIO reads.

Source: OpenColorIO, `FileFormatSpi1D.cpp`.
"""

from __future__ import annotations

from pathlib import Path

from crfnet_core.files import atomic_write_text

from ..errors import LutError
from .rgb_lut import AnyLut
from .text import LutText, table_rows


def write_spi1d(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> None:
    """Write a LUT as .spi1d, with its comments as `#` lines at the top; the same LUT gives the same bytes.

    Parameters
    ----------
    path : str or Path
        The file to be written.
    lut : Lut1D or RgbLut1D
        The table; nine digits keep its float32 values bit for bit.
    overwrite : bool
        Whether an existing file may be replaced.

    Raises
    ------
    LutError
        If the file exists and may not be replaced, or cannot be written.
    """
    low, high = lut.domain
    head = [f"# {comment}" for comment in lut.comments]
    head += [
        "Version 1",
        f"From {low:.9g} {high:.9g}",
        f"Length {len(lut.values)}",
        f"Components {len(lut.channels)}",
        "{",
    ]
    lines = [*head, *(f"  {row}" for row in table_rows(lut)), "}", ""]
    atomic_write_text(path, "\n".join(lines), overwrite=overwrite, error=LutError)


def read_spi1d(path: str | Path) -> AnyLut:
    """Return the LUT in a .spi1d file, with its `#` lines as comments.

    Parameters
    ----------
    path : str or Path
        A file with one component, or with three.

    Raises
    ------
    LutError
        If the file is absent, incomplete or of another format, or does not increase strictly.
    """
    source = LutText.read(path)
    comments: list[str] = []
    header: dict[str, tuple[int, str]] = {}
    rows: list[tuple[int, str]] = []
    state = "header"
    for line, raw in enumerate(source.lines, 1):
        text = raw.strip()
        if text.startswith("#"):
            comments.append(text[1:])
        elif not text or state == "end":
            continue
        elif text in ("{", "}"):
            state = "rows" if text == "{" else "end"
        elif state == "rows":
            rows.append((line, text))
        else:
            key, *value = text.split(maxsplit=1)
            header[key.lower()] = (line, "".join(value))
    if state != "end":
        raise source.error("has no complete block of values in { }; the file is cut or no .spi1d LUT")
    low, high = _header_numbers(source, header, "from", 2)
    (length,) = _header_numbers(source, header, "length", 1)
    (components,) = _header_numbers(source, header, "components", 1)
    return source.lut(rows, length=length, channels=components, domain=(low, high), comments=comments)


def _header_numbers(source: LutText, header: dict[str, tuple[int, str]], key: str, count: int) -> list[float]:
    """Return the numbers that follow a keyword of the header."""
    if key not in header:
        raise source.error(f"has no line '{key.capitalize()}'; the file is cut or no .spi1d LUT")
    line, text = header[key]
    return source.numbers(text, line, count=count)
