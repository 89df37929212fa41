"""What the boxes of a HEIC or AVIF file say of its main picture: colour, bits per sample, size, gain map.

Source: ISO/IEC 14496-12 (boxes, `colr`), ISO/IEC 23008-12 (items and their properties), AV1-ISOBMFF (`av1C`).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

#: Marks of a gain map: Apple's auxiliary picture, and the item and brand of ISO 21496-1.
_GAIN_MAPS = (b"urn:com:apple:photo:2020:aux:hdrgainmap", b"tmap")

#: Box -> bytes that stand in front of its children.
_CHILDREN_AT = {b"meta": 4, b"iprp": 0, b"ipco": 0}

Box = tuple[bytes, bytes]


@dataclass(frozen=True)
class HeifProperties:
    """The properties of the main picture; None or 0 where the file does not say.

    Parameters
    ----------
    width, height : int
        Its size in pixels before it is cut out and turned upright.
    bit_depth : int
        Bits per sample.
    cicp : (int, int, int, int), optional
        Colour primaries, transfer characteristics, matrix coefficients and full range flag, by ITU-T H.273.
    has_gain_map : bool
        Whether the file holds a gain map beside the picture, to make an HDR picture of both.
    has_named_items : bool
        Whether the types of all items are text; pi-heif 1.4 ends the whole process where one is not.
    """

    width: int = 0
    height: int = 0
    bit_depth: int = 0
    cicp: tuple[int, int, int, int] | None = None
    has_gain_map: bool = False
    has_named_items: bool = True


def heif_properties(content: bytes) -> HeifProperties:
    """Return what the boxes in front of a file say; what is damaged stays empty.

    Parameters
    ----------
    content : bytes
        The file, or its beginning: the boxes `ftyp` and `meta`.
    """
    top = dict(_boxes(content))
    meta = top.get(b"meta", b"")
    children = dict(_children(b"meta", meta))
    properties = list(_main_properties(children))
    width, height = next((_sizes(body) for name, body in properties if name == b"ispe"), (0, 0))
    cicp = next((_cicp(body) for name, body in properties if name == b"colr" and body.startswith(b"nclx")), None)
    return HeifProperties(
        width=width,
        height=height,
        bit_depth=max((_bits(name, body) for name, body in properties), default=0),
        cicp=cicp,
        has_named_items=all(map(_is_named, _items(content))),
        has_gain_map=any(mark in part for mark in _GAIN_MAPS for part in (meta, top.get(b"ftyp", b""))),
    )


def _boxes(content: bytes) -> Iterator[Box]:
    """Yield the name and the body of each box; stops at the first that is damaged."""
    at = 0
    while at + 8 <= len(content):
        size, name = struct.unpack_from(">I4s", content, at)
        begin = at + 8
        if size == 1 and begin + 8 <= len(content):
            size, begin = struct.unpack_from(">Q", content, begin)[0], begin + 8
        end = len(content) if size == 0 else at + size
        if end < begin:
            return
        yield name, content[begin:end]
        at = end


def _children(name: bytes, body: bytes) -> Iterator[Box]:
    """Yield the boxes inside a box."""
    return _boxes(body[_CHILDREN_AT[name] :])


def _items(content: bytes) -> Iterator[bytes]:
    """Yield the bodies of all boxes `infe`, one of each item."""
    metas = (body for name, body in _boxes(content) if name == b"meta")
    lists = (body for meta in metas for name, body in _children(b"meta", meta) if name == b"iinf")
    for body in lists:
        count_size = 4 if body[:1] > b"\0" else 2
        yield from (entry for name, entry in _boxes(body[4 + count_size :]) if name == b"infe")


def _is_named(entry: bytes) -> bool:
    """Return whether the type and the texts of an item, behind its numbers, are UTF-8."""
    try:
        entry[10 if entry[:1] > b"\2" else 8 :].decode()
    except UnicodeDecodeError:
        return False
    return True


def _main_properties(meta: dict[bytes, bytes]) -> Iterator[Box]:
    """Yield the properties of the primary item, given the boxes of `meta`."""
    parts = dict(_children(b"iprp", meta.get(b"iprp", b"")))
    shared = list(_children(b"ipco", parts.get(b"ipco", b"")))
    try:
        version, item = meta[b"pitm"][0], meta[b"pitm"][4:]
        main = struct.unpack_from(">I" if version else ">H", item)[0]
        for index in _associations(parts[b"ipma"]).get(main, ()):
            if 0 < index <= len(shared):
                yield shared[index - 1]
    except (KeyError, IndexError, struct.error):
        return


def _associations(body: bytes) -> dict[int, list[int]]:
    """Return item -> positions of its properties, from 1, of a box `ipma`."""
    version, is_wide = body[0], bool(body[3] & 1)
    item_format, index_format = (">IB" if version else ">HB"), (">H" if is_wide else ">B")
    mask = 0x7FFF if is_wide else 0x7F  # the top bit says whether a reader must know the property
    count, at = struct.unpack_from(">I", body, 4)[0], 8
    found: dict[int, list[int]] = {}
    for _ in range(min(count, len(body))):
        item, number = struct.unpack_from(item_format, body, at)
        at += struct.calcsize(item_format)
        step = struct.calcsize(index_format)
        found[item] = [struct.unpack_from(index_format, body, at + step * n)[0] & mask for n in range(number)]
        at += step * number
    return found


def _sizes(body: bytes) -> tuple[int, int]:
    """Return width and height of a box `ispe`."""
    return struct.unpack_from(">II", body, 4) if len(body) >= 12 else (0, 0)


def _bits(name: bytes, body: bytes) -> int:
    """Return the bits per sample that a box `pixi` or `av1C` states; 0 of others."""
    if name == b"pixi" and len(body) > 5:
        return max(body[5 : 5 + body[4]], default=0)
    if name == b"av1C" and len(body) > 2:
        is_high, is_twelve = body[2] & 0x40, body[2] & 0x20
        return (12 if is_twelve else 10) if is_high else 8
    return 0


def _cicp(body: bytes) -> tuple[int, int, int, int] | None:
    """Return the four numbers of a box `colr` of the type nclx."""
    if len(body) < 11:
        return None
    primaries, transfer, matrix, flags = struct.unpack_from(">HHHB", body, 4)
    return primaries, transfer, matrix, flags >> 7
