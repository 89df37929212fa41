"""PNG: the chunks in front of the pixels that describe the encoding of colors, which OpenImageIO leaves out.

Pillow leaves out cICP, and does not say whether it widened samples of fewer bits. Source: Portable Network Graphics
(PNG) Specification (Third Edition), 4.3 and 11.3.2.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import OpenImageIO as oiio

#: The color type of IHDR whose pixels are the numbers of colors in a table.
_PALETTE = 3

#: Chunks that are read, of the header and of color -> the size of their content, in bytes; a profile has any.
_CHUNKS = {b"IHDR": 13, b"cICP": 4, b"iCCP": None, b"sRGB": 1, b"cHRM": 32, b"gAMA": 4}

#: Chunks that override cHRM and gAMA.
_BEFORE_CHROMATICITIES = {b"cICP", b"iCCP", b"sRGB"}

#: cHRM and gAMA hold 100 000 times their numbers.
_UNIT = 100_000


def with_color_chunks(header: Any, path: Path) -> Any:
    """Return the header of a PNG file with the attributes of color that OpenImageIO leaves out.

    They are "png:palette", "oiio:BitsPerSample" below 8, "CICP", "png:sRGB", "chromaticities" and "png:gamma"; the last
    two only where no other chunk describes the encoding.
    """
    chunks, complete = _color_chunks(path), oiio.ImageSpec(header)
    bits, color_type = chunks.get(b"IHDR", bytes(10))[8:10]
    if color_type == _PALETTE:
        complete.attribute("png:palette", 1)
    if 0 < bits < 8:  # OpenImageIO widens them to 8
        complete.attribute("oiio:BitsPerSample", bits)
    if b"cICP" in chunks:
        complete.attribute("CICP", oiio.TypeDesc("int[4]"), tuple(chunks[b"cICP"]))
    if b"sRGB" in chunks:
        complete.attribute("png:sRGB", chunks[b"sRGB"][0])
    if not _BEFORE_CHROMATICITIES & set(chunks):
        if b"cHRM" in chunks:
            white_x, white_y, *corners = (number / _UNIT for number in struct.unpack(">8I", chunks[b"cHRM"]))
            complete.attribute("chromaticities", oiio.TypeDesc("float[8]"), (*corners, white_x, white_y))
        if b"gAMA" in chunks:
            complete.attribute("png:gamma", struct.unpack(">I", chunks[b"gAMA"])[0] / _UNIT)
    return complete


def _color_chunks(path: Path) -> dict[bytes, bytes]:
    """Return name -> content of the chunks of color; a chunk of another size than its own is left out."""
    chunks = {}
    with path.open("rb") as file:
        file.seek(8)  # behind the signature
        while len(start := file.read(8)) == 8:
            size, name = struct.unpack(">I4s", start)
            if name == b"IDAT":
                break
            following = file.tell() + size + 4  # behind the checksum
            if name in _CHUNKS and len(content := file.read(size)) == (_CHUNKS[name] or size):
                chunks[name] = content
            file.seek(following)
    return chunks
