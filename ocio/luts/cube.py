"""The .cube format with a 1D table, as Adobe, Resolve and OpenColorIO read it.

Source: Adobe, "Cube LUT Specification 1.0", 2013; OpenColorIO, `FileFormatIridasCube.cpp`, `FileFormatResolveCube.cpp`.
"""

from __future__ import annotations

from pathlib import Path

from crfnet_core.files import atomic_write_text

from ..errors import LutError
from .rgb_lut import AnyLut
from .text import LutText, table_rows


def write_cube(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> None:
    """Write a LUT as a 1D .cube of three columns, with its comments as `#` lines at the top.

    A domain other than [0, 1] is written as DOMAIN_MIN and DOMAIN_MAX. The same LUT gives the same bytes.

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
    lines = [f"# {comment}" for comment in lut.comments] + [f"LUT_1D_SIZE {len(lut.values)}"]
    if lut.domain != (0.0, 1.0):
        lines += [f"DOMAIN_MIN {low:.9g} {low:.9g} {low:.9g}", f"DOMAIN_MAX {high:.9g} {high:.9g} {high:.9g}"]
    lines += table_rows(lut, columns=3)
    atomic_write_text(path, "\n".join([*lines, ""]), overwrite=overwrite, error=LutError)


def read_cube(path: str | Path) -> AnyLut:
    """Return the LUT in a 1D .cube file; its TITLE, if any, and its `#` lines become the comments.

    Parameters
    ----------
    path : str or Path
        A file with LUT_1D_SIZE; its domain is in DOMAIN_MIN and DOMAIN_MAX, or in LUT_1D_INPUT_RANGE.

    Raises
    ------
    LutError
        If the file is absent, incomplete, a 3D LUT or of another format, has another domain for each channel, or does
        not increase strictly.
    """
    source = LutText.read(path)
    comments: list[str] = []
    header: dict[str, tuple[int, str]] = {}
    rows: list[tuple[int, str]] = []
    for line, raw in enumerate(source.lines, 1):
        text = raw.strip()
        if text.startswith("#"):
            comments.append(text[1:])
        elif text.upper().startswith(("TITLE", "LUT_", "DOMAIN_")):
            key, *value = text.split(maxsplit=1)
            header[key.upper()] = (line, "".join(value))
        elif text:
            rows.append((line, text))
    length = _length(source, header)
    if "TITLE" in header:
        comments.insert(0, header["TITLE"][1].strip().strip('"'))
    return source.lut(rows, length=length, channels=3, domain=_domain(source, header), comments=comments)


def _length(source: LutText, header: dict[str, tuple[int, str]]) -> float:
    """Return the number of entries that the header announces."""
    if "LUT_3D_SIZE" in header:
        message = "is a 3D LUT, which mixes the channels; give a 1D LUT of the camera's response"
        raise source.error(message, line=header["LUT_3D_SIZE"][0])
    if "LUT_1D_SIZE" not in header:
        raise source.error("has no line LUT_1D_SIZE; the file is cut or no 1D .cube LUT")
    line, text = header["LUT_1D_SIZE"]
    return source.numbers(text, line, count=1)[0]


def _domain(source: LutText, header: dict[str, tuple[int, str]]) -> tuple[float, float]:
    """Return the first and the last input: 0 and 1 unless the header says otherwise."""
    low, high = 0.0, 1.0
    if "LUT_1D_INPUT_RANGE" in header:
        line, text = header["LUT_1D_INPUT_RANGE"]
        low, high = source.numbers(text, line, count=2)
    if "DOMAIN_MIN" in header:
        low = _equal_channels(source, *header["DOMAIN_MIN"])
    if "DOMAIN_MAX" in header:
        high = _equal_channels(source, *header["DOMAIN_MAX"])
    return low, high


def _equal_channels(source: LutText, line: int, text: str) -> float:
    """Return the number that a line holds three times."""
    numbers = source.numbers(text, line, count=3)
    if len(set(numbers)) > 1:
        raise source.error("the domains of R, G and B differ; give a LUT with one domain", line=line)
    return numbers[0]
