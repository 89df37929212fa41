"""The .spi1d format: Sony Imageworks' 1D LUT, the simplest that OpenColorIO reads.

Source: OpenColorIO, `FileFormatSpi1D.cpp`.
"""

from __future__ import annotations

from .rgb_lut import AnyLut, table_rows


def spi1d_text(lut: AnyLut) -> str:
    """Return a LUT as the text of a .spi1d file, with its comments as `#` lines at the top."""
    low, high = lut.domain
    lines = [f"# {comment}" for comment in lut.comments]
    lines += ["Version 1", f"From {low:.9g} {high:.9g}", f"Length {len(lut.values)}", f"Components {len(lut.channels)}"]
    lines += ["{", *(f"  {row}" for row in table_rows(lut)), "}", ""]
    return "\n".join(lines)
