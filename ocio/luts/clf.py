"""The Common LUT Format: one LUT1D, after a Range if its domain is not [0, 1].

OpenColorIO's own `GroupTransform.write` is not used. It keeps only eight digits, so neighboring float32 values may
become equal, and its output depends on the version of OpenColorIO.

Source: Academy S-2014-006, "Common LUT Format (CLF)", version 3.0; SMPTE ST 2136-1.
"""

from __future__ import annotations

import html

from .rgb_lut import AnyLut, table_rows


def clf_text(lut: AnyLut) -> str:
    """Return a LUT as the text of a CLF 3.0 file, with its comments as Description elements.

    The id is a hash of the table and its domain, so equal LUTs have equal ids.
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
    return "\n".join([*lines, *table_rows(lut), "        </Array>", "    </LUT1D>", "</ProcessList>", ""])
