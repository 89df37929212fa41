"""Image files made by hand, whose headers say what no image writer would."""

import struct
import zlib

import numpy as np

from tests.helpers.images import write_image


def tiff(width, height, *, samples=3, photometric=2, bits=8, kind=1, extra=(), content=b"", is_big=False):
    """Return an uncompressed little-endian TIFF, or BigTIFF, whose header may lie about its size.

    `kind` is SampleFormat, `extra` are further tags (tag, type, value), and `content` holds the samples.
    """
    head, count, entry = (b"II+\0\x08\0\0\0", "<Q", "<HHQQ") if is_big else (b"II*\0", "<H", "<HHII")
    place = count if is_big else "<I"
    begin = len(head) + struct.calcsize(place)
    tags = [
        *((256, 4, width), (257, 4, height), (258, 3, bits), (259, 3, 1), (262, 3, photometric), (273, 4, begin)),
        *((277, 3, samples), (278, 4, height), (279, 4, min(width * height * samples * bits // 8, 2**32 - 1))),
        *((339, 3, kind), *extra),
    ]
    directory = b"".join(struct.pack(entry, tag, form, 1, value) for tag, form, value in sorted(tags))
    start = struct.pack(place, begin + len(content))
    return head + start + content + struct.pack(count, len(tags)) + directory + bytes(begin // 2)


def png(width, height, rows=b"\0", *, chunks=b""):
    """Return an RGB PNG of 8 bits whose header may lie about its size; `rows` each begin with their filter, 0."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = (png_chunk(b"IHDR", header), chunks, png_chunk(b"IDAT", zlib.compress(rows)), png_chunk(b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def png_chunk(name, content):
    """Return a chunk of a PNG: its length, name, content and checksum."""
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def box(kind, *parts):
    """Return a box of HEIF, JPEG 2000 or JPEG XL: its length, kind and content."""
    content = b"".join(parts)
    return struct.pack(">I", 8 + len(content)) + kind + content


def bmp(width, height, content, *, bits=24, coding=0, size=40, fields=b"", palette=b""):
    """Return a BMP with a header of `size` bytes: those of every one, then `fields`, then zeros."""
    start = struct.pack("<IiiHHIIiiII", size, width, height, 1, bits, coding, len(content), 0, 0, len(palette) // 4, 0)
    head = (start + fields).ljust(size, b"\0") + palette
    return struct.pack("<2sIHHI", b"BM", 14 + len(head) + len(content), 0, 0, 14 + len(head)) + head + content


def jpeg(path, **attributes):
    """Write a JPEG of 120 x 160 pixels, smooth colour with some noise, and return its bytes; see `write_image`."""
    height, width = 120, 160
    rows, columns = np.mgrid[:height, :width]
    smooth = np.stack([columns * 255 // width, rows * 255 // height, (rows + columns) * 255 // (height + width)], -1)
    noise = np.random.default_rng(0).integers(0, 16, smooth.shape)
    return write_image(path, (smooth ^ noise).astype(np.uint8), **attributes).read_bytes()


def with_jpeg_size(content, width, height):
    """Return a JPEG whose frame header claims another size."""
    start = next(at for marker in (b"\xff\xc0", b"\xff\xc2") if (at := content.find(marker)) > 0)
    return content[: start + 5] + struct.pack(">HH", height, width) + content[start + 9 :]


def camera_jpeg(path, **attributes):
    """Write a JPEG as cameras do, EXIF first and with quantization tables of its own, and return its bytes.

    The picture of `jpeg` is written and its segments changed: no JFIF, and a luma table that the IJG library never has.
    """
    content = jpeg(path, **attributes)
    size = int.from_bytes(content[4:6], "big")
    assert content[2:4] == b"\xff\xe0"
    table = content.index(b"\xff\xdb") + 5
    content = content[:table] + bytes([3]) * 64 + content[table + 64 :]
    path.write_bytes(content[:2] + content[4 + size :])
    return path.read_bytes()


def xmp_packet(attributes):
    """Return XMP of one description with these attributes."""
    start = b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">'
    return start + b"<rdf:Description " + attributes + b"/></rdf:RDF></x:xmpmeta>"


def with_jpeg_segment(content, marker, payload):
    """Return a JPEG with one more segment, in front."""
    return content[:2] + bytes([0xFF, marker]) + struct.pack(">H", len(payload) + 2) + payload + content[2:]
