"""The segments of a JPEG file before its first scan, and the quantization tables of the IJG library (libjpeg)."""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from crfnet_core.photograph.metadata.exif import interoperability_index

#: A quantization table: 64 divisors in the order of the file, which is a zigzag from low to high frequencies.
Table = tuple[int, ...]

#: The tables of ITU-T T.81, Annex K, which the IJG library scales by a quality. The rest of the second is 99.
ANNEX_K_LUMA: Table = (
    *(16, 11, 12, 14, 12, 10, 16, 14, 13, 14, 18, 17, 16, 19, 24, 40, 26, 24, 22, 22, 24, 49, 35, 37, 29, 40, 58, 51),
    *(61, 60, 57, 51, 56, 55, 64, 72, 92, 78, 64, 68, 87, 69, 55, 56, 80, 109, 81, 87, 95, 98, 103, 104, 103, 62, 77),
    *(113, 121, 112, 100, 120, 92, 101, 103, 99),
)
ANNEX_K_CHROMA: Table = (17, 18, 18, 24, 21, 24, 47, 26, 26, 47, 99, 66, 56, 66, *(99,) * 50)

_SEGMENT = re.compile(rb"\xff+([^\xff])(..)", re.DOTALL)
_START_OF_SCAN = 0xDA
_START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
_QUANTIZATION_TABLES = 0xDB
_GAIN_MAPS = (b"http://ns.adobe.com/hdr-gain-map/", b"urn:iso:std:iso:ts:21496:-1")
_SUBSAMPLING = {(1, 1): "4:4:4", (2, 1): "4:2:2", (2, 2): "4:2:0", (1, 2): "4:4:0", (4, 1): "4:1:1"}


@dataclass(frozen=True)
class JpegHeader:
    """What stands in a JPEG file before its first scan.

    Parameters
    ----------
    scan : int
        Position of the first scan's header; 0 if the file holds no segment.
    sizes : tuple of (int, int)
        Width and height of every frame header; one, unless the file is odd.
    luma_table, chroma_table : tuple of int
        The quantization tables, 64 divisors each in the order of the file; empty where there is none.
    subsampling : str
        "4:4:4", "4:2:2", "4:2:0", "4:4:0" or "4:1:1"; empty if gray or of another kind.
    has_jfif : bool
        Whether it has a JFIF segment: libraries write one, cameras begin with EXIF instead.
    has_adobe : bool
        Whether it has an Adobe segment, which the programs of Adobe write, and other encoders for CMYK and RGB.
    interop_index : str
        EXIF InteroperabilityIndex, such as "R98"; empty if there is none.
    has_gain_map : bool
        Whether a gain map follows the picture, to make an HDR picture of both (Ultra HDR, ISO 21496-1).
    """

    scan: int = 0
    sizes: tuple[tuple[int, int], ...] = ()
    luma_table: Table = ()
    chroma_table: Table = ()
    subsampling: str = ""
    has_jfif: bool = False
    has_adobe: bool = False
    interop_index: str = ""
    has_gain_map: bool = False


def read_jpeg_header(content: mmap.mmap | bytes) -> JpegHeader:
    """Return what the segments up to the first scan say; what is damaged or absent stays empty."""
    scan, components = 0, b""
    sizes: list[tuple[int, int]] = []
    tables: dict[int, Table] = {}
    names: set[bytes] = set()
    interop_index = ""
    has_gain_map = False
    for marker, scan, end in _segments(content):
        if marker in _START_OF_FRAME:
            frame = content[scan:end].ljust(6, b"\0")
            sizes.append((int.from_bytes(frame[3:5], "big"), int.from_bytes(frame[1:3], "big")))
            components = frame[6 : 6 + 3 * frame[5]]
        elif marker == _QUANTIZATION_TABLES:
            tables.update(_tables(content[scan:end]))
        elif marker in (0xE0, 0xEE):
            names.add(content[scan : scan + 5])
        elif marker == 0xE1 and content[scan : scan + 6] == b"Exif\0\0":
            interop_index = interop_index or interoperability_index(content[scan + 6 : end])
        elif marker in (0xE1, 0xE2):
            has_gain_map |= any(mark in content[scan:end] for mark in _GAIN_MAPS)
    return JpegHeader(
        scan=scan,
        sizes=tuple(sizes),
        luma_table=tables.get(components[2], ()) if len(components) >= 3 else (),
        chroma_table=tables.get(components[5], ()) if len(components) >= 6 else (),
        subsampling=_subsampling(components),
        has_jfif=b"JFIF\0" in names,
        has_adobe=b"Adobe" in names,
        interop_index=interop_index,
        has_gain_map=has_gain_map,
    )


def ijg_quality(luma: Table, chroma: Table = ()) -> int | None:
    """Return the quality, 1 to 100, at which the IJG library writes just these tables; None if it never does.

    Camera makers have tables of their own. Those of quality 98 and more are nearly all ones and prove nothing.
    """
    quality = _ijg_qualities().get(luma)
    if quality is None or (chroma and chroma != scaled_table(ANNEX_K_CHROMA, quality)):
        return None
    return quality


def scaled_table(table: Table, quality: int) -> Table:
    """Return a table scaled as the IJG library (jcparam.c) does: divisors of 1 to 255 for a quality of 1 to 100."""
    percent = 5000 // quality if quality < 50 else 200 - 2 * quality
    return tuple(min(max((divisor * percent + 50) // 100, 1), 255) for divisor in table)


@cache
def _ijg_qualities() -> dict[Table, int]:
    """Return table of luma -> quality."""
    return {scaled_table(ANNEX_K_LUMA, quality): quality for quality in range(1, 101)}


def _segments(content: mmap.mmap | bytes) -> Iterator[tuple[int, int, int]]:
    """Yield the marker of each segment, up to the first scan, and where its payload begins and ends."""
    position = 2
    while segment := _SEGMENT.match(content, position):
        position = segment.start(2) + max(2, int.from_bytes(segment[2], "big"))
        yield segment[1][0], segment.end(), position
        if segment[1][0] == _START_OF_SCAN:
            return


def _tables(payload: bytes) -> Iterator[tuple[int, Table]]:
    """Yield number and divisors of each whole table in a segment."""
    position = 0
    while position < len(payload):
        size = 2 if payload[position] >> 4 else 1
        divisors = payload[position + 1 : position + 1 + 64 * size]
        if len(divisors) < 64 * size:
            return
        table = tuple(int.from_bytes(divisors[i : i + size], "big") for i in range(0, 64 * size, size))
        yield payload[position] & 15, table
        position += 1 + 64 * size


def _subsampling(components: bytes) -> str:
    """Return the name of the chroma subsampling from a frame's components of three bytes each."""
    factors = [divmod(components[i], 16) for i in range(1, len(components) - 1, 3)]
    if len(factors) != 3 or factors[1] != factors[2] or 0 in factors[1]:
        return ""
    (across, down), (chroma_across, chroma_down) = factors[:2]
    return _SUBSAMPLING.get((across // chroma_across, down // chroma_down), "")
