"""Check the header of an image file (size, depth, colors), and clean its texts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import OpenImageIO as oiio

from crfnet_core.errors import PhotoError, one_line

#: Largest photograph that is read, in pixels (200-megapixel cameras fit): at most 5 GB of memory.
MAX_PIXELS = 250_000_000

#: PhotometricInterpretation of TIFF: white or black is zero, RGB, YCbCr; the two of camera raw; a palette; LogLuv.
WHITE_IS_ZERO, READ_PHOTOMETRICS = 0, (0, 1, 2, 6)
RAW_PHOTOMETRICS, PALETTE_PHOTOMETRIC, LINEAR_PHOTOMETRICS = (32803, 34892), 3, (32844, 32845)
OTHER_PHOTOMETRICS = {4: "a mask", 5: "CMYK", 8: "CIE L*a*b*", 9: "CIE L*a*b*", 10: "CIE L*a*b*"}

#: The profile that libjxl makes for a lossy picture whose own profile it cannot name: it decodes that to linear light.
LINEAR_JXL_PROFILE = "RGB_D65_SRG_Rel_Lin"


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse a picture of more than `MAX_PIXELS`."""
    if width * height > MAX_PIXELS:
        raise PhotoError("too_many_pixels", path=path, width=width, height=height, megapixels=MAX_PIXELS // 10**6)


def checked_bit_depth(path: Path, header: Any, kind: str) -> int:
    """Return the bits per sample, 8, 10, 12 or 16, after checking that the header belongs to an encoded photograph.

    Raise PhotoError if it is too large, a volume, camera raw, of other colors than gray and RGB, of a palette, of
    floats, of less than 8 bits, or a lossy JPEG XL that libjxl decodes to linear light.
    """
    check_size(path, header.width, header.height)
    if header.depth != 1:
        raise PhotoError("volume", path=path)
    if kind == "JPEG XL" and header.get_string_attribute("ICCProfile:profile_description") == LINEAR_JXL_PROFILE:
        raise PhotoError("jxl_linear", path=path)
    _check_color(path, header)
    sample = str(header.format)
    if sample in ("half", "float", "double"):
        raise PhotoError("scene_linear_file", path=path, kind=f"a file of {sample} samples")
    stored = {"uint8": 8, "uint16": 16}.get(sample, 0)
    bits: int = header.get_int_attribute("oiio:BitsPerSample", stored)
    if not stored or bits < 8:
        raise PhotoError("sample_type", path=path, bits=bits, kind=sample)
    return bits if bits in (8, 10, 12) else 16


def attribute_value(header: Any, attribute: Any) -> Any:
    """Return the value of an attribute; its own `value` crashes Blender 4.5 if it is an empty text."""
    if not attribute.name.isprintable():  # names that are not UTF-8 cannot be asked for
        return ""
    is_text = str(attribute.type) == "string"
    return header.get_string_attribute(attribute.name) if is_text else attribute.value


def with_plain_texts(header: Any) -> Any:
    """Return a header whose texts are printable: OpenImageIO hands bytes that are not UTF-8 on as lone surrogates."""
    plain = oiio.ImageSpec(header)
    for attribute in header.extra_attribs:
        value = attribute_value(header, attribute)
        if isinstance(value, str) and not value.isprintable():
            plain.attribute(attribute.name, one_line(value))
    return plain


def _check_color(path: Path, header: Any) -> None:
    """Refuse colors other than gray and RGB once decoded without a color conversion, and palettes."""
    photometric = header.get_int_attribute("tiff:PhotometricInterpretation", 2)
    if photometric in RAW_PHOTOMETRICS:
        raise PhotoError("camera_raw", path=path)
    if photometric in LINEAR_PHOTOMETRICS:
        raise PhotoError("scene_linear_file", path=path, kind="LogLuv TIFF")
    # A BMP file with gray has a palette, but one channel.
    is_bmp = header.nchannels >= 3 and header.get_int_attribute("bmp:bitsperpixel", 24) <= 8
    tables = {"TIFF": photometric == PALETTE_PHOTOMETRIC, "PNG": header.get_int_attribute("png:palette"), "BMP": is_bmp}
    if kind := next((kind for kind, has_table in tables.items() if has_table), ""):
        raise PhotoError("palette", path=path, kind=f"a {kind} file with a palette")
    is_ink = header.get_string_attribute("jpeg:ColorSpace") in ("CMYK", "YCbCrK")
    if is_ink or photometric not in READ_PHOTOMETRICS:
        kind = "CMYK" if is_ink else OTHER_PHOTOMETRICS.get(photometric, f"TIFF photometric {photometric}")
        raise PhotoError("other_colors", path=path, kind=kind)
