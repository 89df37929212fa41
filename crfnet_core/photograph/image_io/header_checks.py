"""What the header of an image file must say of its picture: size, depth, colour."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import problems

#: Largest photograph that is read, in pixels (200-megapixel cameras fit): at most 5 GB of memory.
MAX_PIXELS = 250_000_000

#: TIFF's PhotometricInterpretation: the two of camera raw, a palette, and what is neither gray, RGB nor YCbCr.
RAW_PHOTOMETRIC, PALETTE_PHOTOMETRIC = (32803, 34892), 3
OTHER_PHOTOMETRIC = {5: "CMYK", 8: "CIE L*a*b*", 9: "CIE L*a*b*", 10: "CIE L*a*b*"}

#: The profile that libjxl makes for pixels that it has decoded to linear light.
LINEAR_JXL_PROFILE = "RGB_D65_SRG_Rel_Lin"


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse a picture of more than `MAX_PIXELS`."""
    if width * height > MAX_PIXELS:
        raise PhotoError(
            f"{path}: claims {width} x {height} pixels; at most {MAX_PIXELS // 10**6} megapixels are read: crop it"
        )


def checked_bit_depth(path: Path, header: Any) -> int:
    """Return the bits per sample, 8, 10, 12 or 16, after checking that the header is that of an encoded photograph.

    Raises
    ------
    PhotoError
        If it is too large, a volume, camera raw, of other colours than gray and RGB, of a palette, of floats, or of
        less than 8 bits.
    """
    check_size(path, header.width, header.height)
    if header.depth != 1:
        raise PhotoError(f"{path}: holds a volume; give a flat photograph")
    _check_color(path, header)
    sample = str(header.format)
    if sample in ("half", "float", "double"):
        raise problems.linear(path, f"a file of {sample} samples")
    stored = {"uint8": 8, "uint16": 16}.get(sample, 0)
    bits: int = header.get_int_attribute("oiio:BitsPerSample", stored)
    if not stored or bits < 8:
        raise PhotoError(f"{path}: holds {bits}-bit {sample} samples; needs 8 to 16 bits, unsigned: convert it")
    return bits if bits in (8, 10, 12) else 16


def check_is_encoded(path: Path, header: Any, kind: str) -> None:
    """Refuse a lossy JPEG XL whose ICC profile libjxl cannot name: libjxl decodes it to linear light."""
    profile = header.get_string_attribute("ICCProfile:profile_description")
    if kind == "JPEG XL" and profile == LINEAR_JXL_PROFILE:
        raise PhotoError("jxl_linear", path=path)


def _check_color(path: Path, header: Any) -> None:
    """Refuse what is neither gray nor RGB once decoded without a colour conversion, and palettes."""
    photometric = header.get_int_attribute("tiff:PhotometricInterpretation", 2)
    if photometric in RAW_PHOTOMETRIC:
        raise problems.camera_raw(path)
    if photometric == PALETTE_PHOTOMETRIC:
        raise problems.paletted(path, "a TIFF file with a palette")
    if header.get_int_attribute("png:palette"):
        raise problems.paletted(path, "a PNG file with a palette")
    if header.nchannels >= 3 and header.get_int_attribute("bmp:bitsperpixel", 24) <= 8:  # gray ones have a channel
        raise problems.paletted(path, "a BMP file with a palette")
    inks = header.get_string_attribute("jpeg:ColorSpace") in ("CMYK", "YCbCrK")
    other = "CMYK" if inks else OTHER_PHOTOMETRIC.get(photometric)
    if other:
        raise PhotoError(
            f"{path}: holds {other}, which hides the camera's response; give the RGB photograph that it came from"
        )
