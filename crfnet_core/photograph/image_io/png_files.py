"""PNG: the chunks of colors and EXIF behind the pixels, which OpenImageIO leaves out in part, as does Pillow.

Source: Portable Network Graphics (PNG) Specification (Third Edition), 4.3 and 11.3.2.
"""

import struct
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any

import OpenImageIO as oiio

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io.header_checks import with_segments

#: Chunks that are read -> the size of their content, in bytes; a profile and EXIF have any.
_CHUNKS = {b"IHDR": 13, b"cICP": 4, b"iCCP": None, b"sRGB": 1, b"cHRM": 32, b"gAMA": 4, b"eXIf": None}

#: The only one of them that may stand behind the pixels; the attributes of color, of which texts may have the names.
_EXIF, _COLORS = b"eXIf", ("CICP", "png:sRGB", "chromaticities", "png:gamma")

#: The color type of IHDR of a palette; bytes of the largest profile; cHRM and gAMA hold 100 000 times their numbers.
_PALETTE, _MOST_PROFILE, _UNIT = 3, 1 << 24, 100_000


def with_color_chunks(header: Any, path: Path) -> Any:
    """Return the header of a PNG file with EXIF, wherever it stands, and the attributes of color.

    They are the profile's, "png:palette", "oiio:BitsPerSample", and `_COLORS`. Raise PhotoError for limited range.
    """
    chunks, complete = _chunks(path), oiio.ImageSpec(header)
    for name in ("Orientation", *_COLORS):  # texts; EXIF has a number
        complete.erase_attribute(name, oiio.TypeString)
    profile = chunks.get(b"iCCP", b"").partition(b"\0")[2][1:]  # behind its name; a byte names the only method
    with suppress(zlib.error):
        profile = zlib.decompressobj().decompress(profile, _MOST_PROFILE)
    complete = with_segments(complete, {"exif": chunks.get(_EXIF), "icc_profile": profile})
    bits, color_type = chunks.get(b"IHDR", bytes(10))[8:10]
    complete.attribute("png:palette", int(color_type == _PALETTE))
    complete.attribute("oiio:BitsPerSample", bits)  # OpenImageIO widens fewer to 8
    if chunks.get(b"cICP", b"\1")[-1] == 0:
        raise PhotoError("coding_not_read", path=path, kind="PNG", problem="limited range")
    if b"cICP" in chunks:
        complete.attribute("CICP", oiio.TypeDesc("int[4]"), tuple(chunks[b"cICP"]))
    if b"sRGB" in chunks:
        complete.attribute("png:sRGB", chunks[b"sRGB"][0])
    if b"cHRM" in chunks:
        white_x, white_y, *corners = (number / _UNIT for number in struct.unpack(">8I", chunks[b"cHRM"]))
        complete.attribute("chromaticities", oiio.TypeDesc("float[8]"), (*corners, white_x, white_y))
    if b"gAMA" in chunks:
        complete.attribute("png:gamma", struct.unpack(">I", chunks[b"gAMA"])[0] / _UNIT)
    return complete


def _chunks(path: Path) -> dict[bytes, bytes]:
    """Return name -> content of `_CHUNKS`; one of another size than its own, or behind the pixels, is left out."""
    chunks, is_behind = {}, False
    with path.open("rb") as file:
        file.seek(8)  # behind the signature
        while len(start := file.read(8)) == 8:
            size, name = struct.unpack(">I4s", start)
            following = file.tell() + size + 4  # behind the checksum
            is_behind = is_behind or name == b"IDAT"
            is_read = name == _EXIF or (name in _CHUNKS and not is_behind)
            if is_read and len(content := file.read(size)) == (_CHUNKS[name] or size):
                chunks[name] = content
            file.seek(following)
    return chunks
