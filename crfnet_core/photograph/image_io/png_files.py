"""PNG: the chunks in front of the pixels that say how colours are encoded, which OpenImageIO leaves out.

Source: Portable Network Graphics (PNG) Specification (Third Edition), 4.3 and 11.3.2.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import OpenImageIO as oiio

_SIGNATURE_SIZE = 8

#: The colour type of IHDR whose pixels are the numbers of colours in a table.
_PALETTE = 3

#: Bits of a sample; OpenImageIO makes as many of fewer, and does not say so.
_WHOLE_BITS = 8

#: Chunks that are read, the header and those of colour -> the size of their content, in bytes; a profile has any.
_CHUNKS = {b"IHDR": 13, b"cICP": 4, b"iCCP": None, b"sRGB": 1, b"cHRM": 32, b"gAMA": 4}

#: Chunks with which those of chromaticities and gamma do not count.
_BEFORE_CHROMATICITIES = {b"cICP", b"iCCP", b"sRGB"}

#: cHRM and gAMA hold 100 000 times their numbers.
_UNIT = 100_000


def with_color_chunks(header: Any, path: Path) -> Any:
    """Return the header of a PNG file with the attributes of colour that OpenImageIO leaves out.

    They are "png:palette", "oiio:BitsPerSample" below 8, "CICP", "png:sRGB", "chromaticities" and "png:gamma". Each is
    there where a chunk says so; the last two only where no other chunk says how colours are encoded.

    Parameters
    ----------
    header : OpenImageIO.ImageSpec
        As OpenImageIO has read it.
    path : Path
        The file.
    """
    chunks = _color_chunks(path)
    complete = oiio.ImageSpec(header)
    if b"IHDR" in chunks:
        bits, color_type = chunks[b"IHDR"][8:10]
        if color_type == _PALETTE:
            complete.attribute("png:palette", 1)
        if bits < _WHOLE_BITS:
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
    """Return name -> content of the chunks of colour; those of another size than theirs are left out."""
    found = {}
    with path.open("rb") as file:
        file.seek(_SIGNATURE_SIZE)
        while len(start := file.read(8)) == 8:
            size, name = struct.unpack(">I4s", start)
            if name == b"IDAT":
                break
            following = file.tell() + size + 4  # behind the checksum
            if name in _CHUNKS and len(content := file.read(size)) == (_CHUNKS[name] or size):
                found[name] = content
            file.seek(following)
    return found
