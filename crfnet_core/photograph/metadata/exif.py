"""The one field of EXIF that OpenImageIO does not read: the interoperability index, which tells Adobe RGB from sRGB.

Source: EXIF 2.32 (CIPA DC-008-2019), 4.6.3 and 4.6.7; DCF 2.0 (CIPA DC-009-2010).
"""

from __future__ import annotations

import struct

#: Tags that point to the EXIF directory and from there to the interoperability one, and the index in that.
EXIF_DIRECTORY, INTEROP_DIRECTORY, INTEROP_INDEX = 0x8769, 0xA005, 0x0001

_BYTE_ORDERS = {b"II*\0": "<", b"MM\0*": ">"}


def interoperability_index(exif: bytes) -> str:
    """Return the InteroperabilityIndex, such as "R98" or "R03", of EXIF data that begins with its TIFF header.

    Empty if there is none, or if the data are damaged.
    """
    order = _BYTE_ORDERS.get(exif[:4], "")
    try:
        (first,) = struct.unpack_from(f"{order}I", exif, 4) if order else (0,)
        details = struct.unpack(f"{order}I", _value(exif, first, EXIF_DIRECTORY, order))
        interop = struct.unpack(f"{order}I", _value(exif, details[0], INTEROP_DIRECTORY, order))
        return _value(exif, interop[0], INTEROP_INDEX, order).rstrip(b"\0").decode("ascii")
    except (struct.error, UnicodeDecodeError):
        return ""


def _value(exif: bytes, directory: int, tag: int, order: str) -> bytes:
    """Return the four bytes of a tag's value in a directory; empty if it is absent."""
    (count,) = struct.unpack_from(f"{order}H", exif, directory) if directory else (0,)
    for position in range(directory + 2, directory + 2 + 12 * count, 12):
        found, _, _, value = struct.unpack_from(f"{order}HHI4s", exif, position)
        if found == tag:
            return bytes(value)
    return b""
