"""Read or write a LUT file; its suffix names the format."""

import html
from collections.abc import Callable, Mapping
from pathlib import Path

from crfnet_core.errors import check_kinds
from crfnet_core.files import atomic_write_text
from crfnet_core.types import checked_option

from ..errors import LutError
from .opencolorio import read_lut
from .rgb_lut import AnyLut, lut_identity, table_rows

__all__ = ["WRITERS", "read_lut", "write_lut"]


def _spi1d_text(lut: AnyLut) -> str:
    """Return a LUT as the text of a .spi1d file, with its comments at the top (OpenColorIO, `FileFormatSpi1D.cpp`)."""
    (low, high), columns = lut.domain, len(lut.channels)
    lines = [f"# {comment}" for comment in lut.comments]
    lines += ["Version 1", f"From {low:.9g} {high:.9g}", f"Length {len(lut.values)}", f"Components {columns}"]
    lines += ["{", *(f"  {row}" for row in table_rows(lut, columns=columns)), "}", ""]
    return "\n".join(lines)


def _cube_text(lut: AnyLut) -> str:
    """Return a LUT as the text of a 1D .cube file of three columns, with its comments at the top.

    Source: Adobe, "Cube LUT Specification 1.0", 2013; OpenColorIO, `FileFormatIridasCube.cpp`.
    """
    low, high = lut.domain
    lines = [f"# {comment}" for comment in lut.comments] + [f"LUT_1D_SIZE {len(lut.values)}"]
    if lut.domain != (0.0, 1.0):
        lines += [f"DOMAIN_MIN {low:.9g} {low:.9g} {low:.9g}", f"DOMAIN_MAX {high:.9g} {high:.9g} {high:.9g}"]
    return "\n".join([*lines, *table_rows(lut, columns=3), ""])


def _clf_text(lut: AnyLut) -> str:
    """Return a LUT as the text of a CLF 3.0 file: one LUT1D, after a Range if its domain is not [0, 1].

    OpenColorIO's `GroupTransform.write` keeps only eight digits, so neighboring float32 values may become equal.
    Source: Academy S-2014-006, "Common LUT Format (CLF)", version 3.0; SMPTE ST 2136-1.
    """
    depth = 'inBitDepth="32f" outBitDepth="32f"'
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines.append(f'<ProcessList xmlns="urn:AMPAS:CLF:v3.0" id="{lut_identity(lut)}" compCLFversion="3.0">')
    lines += [f"    <Description>{html.escape(comment, quote=False)}</Description>" for comment in lut.comments]
    if lut.domain != (0.0, 1.0):
        ends = zip(("minInValue", "maxInValue", "minOutValue", "maxOutValue"), (*lut.domain, 0, 1), strict=True)
        lines += [f"    <Range {depth}>", *(f"        <{key}>{end:.9g}</{key}>" for key, end in ends), "    </Range>"]
    size, columns = len(lut.values), len(lut.channels)
    lines += [f'    <LUT1D {depth} interpolation="linear">', f'        <Array dim="{size} {columns}">']
    lines += [*table_rows(lut, columns=columns), "        </Array>", "    </LUT1D>", "</ProcessList>", ""]
    return "\n".join(lines)


#: Suffix of each format that is written -> the text of a LUT in it. Each estimate writes all; configs name the first.
WRITERS: Mapping[str, Callable[[AnyLut], str]] = {".spi1d": _spi1d_text, ".cube": _cube_text, ".clf": _clf_text}


def write_lut(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> None:
    """Write a LUT in one of the formats of `WRITERS`.

    Parameters
    ----------
    path : str or Path
        The file to be written; its suffix, in lower or upper case, names the format.
    lut : Lut1D or RgbLut1D
        The table; nine digits keep its float32 values bit for bit.
    overwrite : bool
        Whether an existing file may be replaced.

    Raises
    ------
    LutError
        If no format has the suffix, the file exists and may not be replaced, or it cannot be written.
    """
    check_kinds(path=(path, str | Path), lut=(lut, AnyLut))
    overwrite = checked_option("overwrite", overwrite, bool)
    path = Path(path)
    if path.suffix.lower() not in WRITERS:
        raise LutError("lut_suffix", path=path, suffixes=", ".join(WRITERS))
    atomic_write_text(path, WRITERS[path.suffix.lower()](lut), overwrite=overwrite, error=LutError)
