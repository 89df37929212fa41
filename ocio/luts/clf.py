"""The Common LUT Format: one LUT1D, after a Range if its domain is not [0, 1].

OpenColorIO's own `GroupTransform.write` is not used. It keeps only eight digits, so neighbouring float32 values may
become equal, and its output depends on the version of OpenColorIO.

Source: Academy S-2014-006, "Common LUT Format (CLF)", version 3.0; SMPTE ST 2136-1.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from crfnet_core.files import atomic_write_text

from ..errors import LutError
from .rgb_lut import AnyLut
from .text import LutText, table_rows

#: The factor of the values in a file, by the bit depth that the file declares.
DEPTH_SCALES = {"8i": 255, "10i": 1023, "12i": 4095, "16i": 65535, "16f": 1, "32f": 1}


def write_clf(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> None:
    """Write a LUT as CLF 3.0, with its comments as Description elements; the same LUT gives the same bytes.

    The id is a hash of the table and its domain, so equal LUTs have equal ids.

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
    depth = 'inBitDepth="32f" outBitDepth="32f"'
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines.append(f'<ProcessList xmlns="urn:AMPAS:CLF:v3.0" id="{lut.identity}" compCLFversion="3.0">')
    lines += [f"    <Description>{html.escape(comment, quote=False)}</Description>" for comment in lut.comments]
    if lut.domain != (0.0, 1.0):
        ends = zip(("minInValue", "maxInValue", "minOutValue", "maxOutValue"), (*lut.domain, 0, 1), strict=True)
        lines += [f"    <Range {depth}>", *(f"        <{key}>{end:.9g}</{key}>" for key, end in ends), "    </Range>"]
    lines += [
        f'    <LUT1D {depth} interpolation="linear">',
        f'        <Array dim="{len(lut.values)} {len(lut.channels)}">',
    ]
    lines += table_rows(lut)
    lines += ["        </Array>", "    </LUT1D>", "</ProcessList>", ""]
    atomic_write_text(path, "\n".join(lines), overwrite=overwrite, error=LutError)


def read_clf(path: str | Path) -> AnyLut:
    """Return the LUT in a CLF file, with its Description elements as comments.

    Parameters
    ----------
    path : str or Path
        A ProcessList of one LUT1D with one column or three; a Range before it may give the domain.

    Raises
    ------
    LutError
        If the file is absent, incomplete or of another format, or does not increase strictly.
    """
    source = LutText.read(path)
    steps, comments = _steps(source)
    table = steps[-1]
    domain = _domain(source, steps[0]) if len(steps) == 2 else (0.0, 1.0)
    if table.get("halfDomain") == "true" or table.get("rawHalfs") == "true":
        raise source.error("is a LUT over half floats; give one with uniform inputs", line=_line(source, "LUT1D"))
    length, channels = source.numbers(_array(source, table).get("dim", ""), _line(source, "Array"), count=2)
    rows = _rows(source, _array(source, table), one_column=channels == 1)
    scale = _scale(source, table, "outBitDepth", "LUT1D")
    return source.lut(rows, length=length, channels=channels, domain=domain, comments=comments, scale=scale)


def _steps(source: LutText) -> tuple[list[ElementTree.Element], list[str]]:
    """Return the process nodes (a LUT1D, perhaps after a Range), without XML namespaces, and the descriptions."""
    text = "\n".join(source.lines)
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise source.error("declares XML entities, which no LUT needs; give a plain CLF file")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as problem:
        message = "is no well-formed XML; the file is cut or no CLF LUT"
        raise source.error(message, line=problem.position[0]) from problem
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    comments = [element.text or "" for element in root if element.tag == "Description"]
    ignored = ("Description", "InputDescriptor", "OutputDescriptor", "Info")
    steps = [element for element in root if element.tag not in ignored]
    kinds = [element.tag for element in steps]
    if root.tag != "ProcessList" or kinds not in (["LUT1D"], ["Range", "LUT1D"]):
        found = ", ".join(kinds[:5]) or f"<{root.tag}>"
        raise source.error(f"holds {found}; needed is a CLF of one LUT1D, with a Range before it at most")
    return steps, comments


def _domain(source: LutText, step: ElementTree.Element) -> tuple[float, float]:
    """Return the inputs that a Range converts to 0 and 1."""
    line = _line(source, "Range")
    keys = ("minInValue", "maxInValue", "minOutValue", "maxOutValue")
    numbers = [source.numbers(step.findtext(key) or "", line, count=1)[0] for key in keys]
    outputs = _scale(source, step, "outBitDepth", "Range")
    if (numbers[2] / outputs, numbers[3] / outputs) != (0.0, 1.0):
        raise source.error("the Range before the LUT1D must end in 0 to 1; give a plainer LUT", line=line)
    inputs = _scale(source, step, "inBitDepth", "Range")
    return numbers[0] / inputs, numbers[1] / inputs


def _scale(source: LutText, step: ElementTree.Element, key: str, kind: str) -> int:
    """Return the factor of a process node's values in the file."""
    depth = step.get(key, "")
    if depth not in DEPTH_SCALES:
        raise source.error(f"{key} is {depth!r}; known are {', '.join(DEPTH_SCALES)}", line=_line(source, kind))
    return DEPTH_SCALES[depth]


def _array(source: LutText, table: ElementTree.Element) -> ElementTree.Element:
    """Return the Array of the LUT1D."""
    array = table.find("Array")
    if array is None:
        raise source.error("the LUT1D has no Array; the file is cut or altered", line=_line(source, "LUT1D"))
    return array


def _line(source: LutText, tag: str) -> int | None:
    """Return the number of the line on which the first element of a kind begins."""
    opening = re.compile(rf"<(\w+:)?{tag}\b")
    return next((line for line, text in enumerate(source.lines, 1) if opening.search(text)), None)


def _rows(source: LutText, array: ElementTree.Element, *, one_column: bool) -> Iterator[tuple[int, str]]:
    """Yield line number and text of every row of the Array; a single column may have several rows on a line."""
    first = _line(source, "Array") or 1
    for line, text in enumerate((array.text or "").split("\n"), first):
        rows = text.split() if one_column else [text.strip()]
        yield from ((line, row) for row in rows if row)
