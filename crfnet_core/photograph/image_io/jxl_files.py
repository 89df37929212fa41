"""JPEG XL: refuse animations and linear light; find EXIF, XMP, the turn and the bits, which OpenImageIO leaves out.

Source: ISO/IEC 18181-1:2024, D.2 and D.3 (the header of the codestream), and 18181-2 (boxes).
"""

import re
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crfnet_core.errors import PhotoError
from crfnet_core.files import read_bytes
from crfnet_core.photograph.image_io.header_checks import MOST_CONTENT, text_attribute, with_segments
from crfnet_core.photograph.image_io.iso_boxes import find_box

#: The profiles that libjxl makes for a lossy picture whose own profile it cannot name: it decodes that to linear light.
_LINEAR_PROFILES = ("RGB_D65_SRG_Rel_Lin", "Gra_D65_Rel_Lin")

#: The head of a box of compressed EXIF or XMP, behind its size; reading it takes a decoder of Brotli.
_COMPRESSED = re.compile(rb"brob(Exif|xml )")

#: The start of a codestream, which stands alone, in one box or in numbered ones; bytes behind it that are read.
_START, _HEAD = re.compile(rb"(\A|jxlc|jxlp.{4})\xff\x0a", re.DOTALL), 4096


@dataclass(frozen=True)
class JxlHeader:
    """The fields of a codestream's header that are used, with their defaults; and whether boxes hide metadata."""

    orientation: int = 1
    bits: int = 8  # per sample
    is_xyb: bool = True  # else the codes of the picture's own color space are stored
    has_profile: bool = True  # of ICC; else fields name the color space, of which libjxl makes a profile
    is_unread: bool = False  # whether EXIF or XMP is compressed, and so not read


def with_jxl_boxes(header: Any, path: Path, stored: JxlHeader) -> Any:
    """Return the header with EXIF and XMP, unless these are compressed; refuse what only the decoder made linear."""
    profile = text_attribute(header, "ICCProfile:profile_description")
    if stored.is_xyb and stored.has_profile and profile in _LINEAR_PROFILES:
        raise PhotoError("jxl_linear", path=path)
    segments = {}
    with suppress(ValueError):  # of boxes that are too large or too far; a codestream has none
        exif = find_box(path, b"Exif")
        segments["exif"] = exif[4 + int.from_bytes(exif[:4]) :]
        segments["xmp"] = find_box(path, b"xml ")
    header = with_segments(header, segments)
    header.attribute("Orientation", 1)  # the decoder has applied that of the codestream
    header.attribute("oiio:UnassociatedAlpha", 1)
    if not stored.is_xyb:
        header.attribute("oiio:BitsPerSample", stored.bits)
    return header


def jxl_header(path: Path) -> JxlHeader:
    """Return the header of the codestream; refuse a preview, and an animation, whose last frame OpenImageIO returns."""
    content = read_bytes(path, most=MOST_CONTENT)
    start, is_unread = _START.search(content), bool(_COMPRESSED.search(content))
    fields = _Fields(int.from_bytes(content[start.end() : start.end() + _HEAD] if start else b"", "little"))
    fields.skip_sides()
    if fields.number():  # all are the default ones
        return JxlHeader(has_profile=False, is_unread=is_unread)
    orientation = 1
    if fields.number():
        orientation += fields.number(3)
        if fields.number():  # a size for showing it
            fields.skip_sides()
        for problem in ("a preview", "an animation"):
            if fields.number():
                raise PhotoError("coding_not_read", path=path, kind="JPEG XL", problem=problem)
    bits = fields.bit_depth()
    fields.number()  # whether 16 bits are enough for decoding
    for _ in range(fields.choice((0, 0), (1, 0), (2, 4), (1, 12))):  # channels beside the colors
        if not fields.number():  # else alpha of 8 bits
            is_alpha = fields.choice((0, 0), (1, 0), (2, 4), (18, 6)) == 0
            fields.bit_depth()
            fields.choice((0, 0), (3, 0), (4, 0), (1, 3))  # fewer samples
            fields.number(8 * fields.choice((0, 0), (0, 4), (16, 5), (48, 10)))  # its name
            fields.number(is_alpha)  # whether the colors are multiplied by it
    is_xyb = bool(fields.number())
    has_profile = not fields.number() and bool(fields.number())  # the color space is not the default one
    return JxlHeader(orientation, bits, is_xyb, has_profile, is_unread)


@dataclass
class _Fields:
    """Fields of a header, the lowest bit of each byte first."""

    rest: int

    def number(self, width: int = 1) -> int:
        value = self.rest & (1 << width) - 1
        self.rest >>= width
        return value

    def choice(self, *forms: tuple[int, int]) -> int:
        """Return a number of one of four forms, or of the only one: the least value, and the bits above it."""
        least, width = forms[self.number(2) if forms[1:] else 0]
        return least + self.number(width)

    def skip_sides(self) -> None:
        """Skip the sides of a picture: the second one is left out if the ratio between them is a usual one."""
        forms = ((0, 5),) if self.number() else ((0, 9), (0, 13), (0, 18), (0, 30))
        self.choice(*forms)
        if not self.number(3):
            self.choice(*forms)

    def bit_depth(self) -> int:
        is_float = self.number()
        bits = self.choice(*(((32, 0), (16, 0), (24, 0)) if is_float else ((8, 0), (10, 0), (12, 0))), (1, 6))
        self.number(4 * is_float)  # of the exponent
        return bits
