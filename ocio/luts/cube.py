"""The .cube format with a 1D table, as Adobe, Resolve and OpenColorIO read it.

Source: Adobe, "Cube LUT Specification 1.0", 2013; OpenColorIO, `FileFormatIridasCube.cpp`, `FileFormatResolveCube.cpp`.
"""

from __future__ import annotations

from .rgb_lut import AnyLut, table_rows


def cube_text(lut: AnyLut) -> str:
    """Return a LUT as the text of a 1D .cube file of three columns, with its comments as `#` lines at the top.

    A domain other than [0, 1] is written as DOMAIN_MIN and DOMAIN_MAX.
    """
    low, high = lut.domain
    lines = [f"# {comment}" for comment in lut.comments] + [f"LUT_1D_SIZE {len(lut.values)}"]
    if lut.domain != (0.0, 1.0):
        lines += [f"DOMAIN_MIN {low:.9g} {low:.9g} {low:.9g}", f"DOMAIN_MAX {high:.9g} {high:.9g} {high:.9g}"]
    return "\n".join([*lines, *table_rows(lut, columns=3), ""])
