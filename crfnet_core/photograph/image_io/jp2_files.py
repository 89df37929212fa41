"""JPEG 2000: refuse codings that OpenImageIO returns as other pixels, and find associated alpha and tags of color.

Source: ISO/IEC 15444-1:2019, A.5.1 (SIZ) and I.5.3 (the boxes of JP2), and 15444-2, M.11.7.3 (any ICC profile).
"""

import struct
from pathlib import Path
from typing import Any

import OpenImageIO as oiio

from crfnet_core.errors import PhotoError
from crfnet_core.files import read_bytes
from crfnet_core.photograph.image_io.header_checks import MOST_CONTENT, damaged, with_segments
from crfnet_core.photograph.image_io.iso_boxes import boxes, find_box

_SIZE_MARKER = b"\xff\x4f\xff\x51"  # start of the codestream and of its marker SIZ

#: Methods of a color box: a space by number, any ICC profile, which OpenImageIO leaves out, and CICP.
_BY_NUMBER, _ANY_PROFILE, _BY_CICP = b"\1", b"\3", b"\5"

_READ_SPACES, _CMYK = (16, 17, 18), 12  # the numbers of spaces that are read: sRGB, gray, sYCC; and of CMYK
_PREMULTIPLIED = 2  # type of a channel by which the colors are multiplied


def with_jp2_boxes(header: Any, path: Path) -> Any:
    """Return the header with its tags of color and alpha; raise PhotoError where OpenImageIO returns other pixels."""
    content = read_bytes(path, most=MOST_CONTENT)
    start = content.find(_SIZE_MARKER)
    _check_size(path, content[start + 8 : start + 8 + 36 + 3 * 16384])
    try:  # a bare codestream has no boxes; of several of one name the first counts
        headers = dict(reversed([*boxes(find_box(path, b"jp2h"))]))
    except ValueError as problem:
        raise damaged(path, "JPEG 2000", str(problem)) from None
    if b"pclr" in headers:
        raise PhotoError("palette", path=path, kind="a JPEG 2000 file with a palette")
    method, color = headers.get(b"colr", b"")[:1], headers.get(b"colr", b"")[3:]
    space = int.from_bytes(color[:4])
    if method == _BY_NUMBER and space not in _READ_SPACES:
        kind = "CMYK" if space == _CMYK else f"JPEG 2000 color space {space}"
        raise PhotoError("other_colors", path=path, kind=kind)
    complete = with_segments(header, {"icc_profile": color if method == _ANY_PROFILE else b""})
    if method == _BY_CICP and len(color) >= 4:
        complete.attribute("CICP", oiio.TypeDesc("int[4]"), (*struct.unpack(">2H", color[:4]), 0, 1))
    channels = headers.get(b"cdef", b"")[2:]
    kinds = [int.from_bytes(channels[at + 2 : at + 4]) for at in range(0, len(channels), 6)]
    complete.attribute("oiio:UnassociatedAlpha", int(_PREMULTIPLIED not in kinds))
    return complete


def _check_size(path: Path, size: bytes) -> None:
    """Refuse signed samples, and components of fewer samples that do not fill the picture, by the content of SIZ."""
    right, bottom, left, top = (int.from_bytes(size[at : at + 4]) for at in (0, 4, 8, 12))
    count = int.from_bytes(size[32:34])
    for depth, across, down in (size[at : at + 3] for at in range(34, min(34 + 3 * count, len(size) - 2), 3)):
        if depth & 0x80:
            raise PhotoError("coding_not_read", path=path, kind="JPEG 2000", problem="signed samples")
        if (right - left) % max(across, 1) or (bottom - top) % max(down, 1):
            raise PhotoError("coding_not_read", path=path, kind="JPEG 2000", problem="subsampled, and of odd size")
