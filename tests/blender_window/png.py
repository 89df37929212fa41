"""Write PNG files with the standard library: lossless, with a palette where it holds all colors, deflate level 9."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

from tests.blender_window.screen import Picture

#: The largest number of colors that a palette holds.
MOST_COLORS = 256


def write_png(path: Path, picture: Picture) -> Path:
    """Write a picture and return the path; with at most `MOST_COLORS` colors it is stored with a palette.

    Interfaces have few colors and long runs of one, so most of them shrink to a few per cent.
    """
    pixels = [picture.rgb[at : at + 3] for at in range(0, len(picture.rgb), 3)]
    palette = sorted(set(pixels))
    kind, samples, length = 2, picture.rgb, 3 * picture.width
    if len(palette) <= MOST_COLORS:
        index = {color: number for number, color in enumerate(palette)}
        kind, samples, length = 3, bytes(index[color] for color in pixels), picture.width
    rows = (b"\0" + samples[at : at + length] for at in range(0, len(samples), length))
    header = struct.pack(">2I5B", picture.width, picture.height, 8, kind, 0, 0, 0)
    chunks = [(b"IHDR", header)]
    chunks += [(b"PLTE", b"".join(palette))] if kind == 3 else []
    chunks += [(b"IDAT", zlib.compress(b"".join(rows), 9)), (b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(*chunk) for chunk in chunks))
    return path


def _chunk(name: bytes, content: bytes) -> bytes:
    """Return a chunk of a PNG file with its length and checksum."""
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))
