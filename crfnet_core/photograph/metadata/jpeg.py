"""The metadata in the segments of a JPEG file, and the quantization tables of the IJG library (libjpeg)."""

import io
import struct
import warnings

from PIL.JpegImagePlugin import JpegImageFile

from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.metadata.file_metadata import FileMetadata, Table
from crfnet_core.photograph.metadata.icc import DAMAGED
from crfnet_core.photograph.metadata.tiff_tags import exif_software, interop_index

#: The tables of ITU-T T.81, Annex K, which the IJG library scales by a quality. The rest of the second is 99.
ANNEX_K_LUMA: Table = (
    *(16, 11, 10, 16, 24, 40, 51, 61, 12, 12, 14, 19, 26, 58, 60, 55, 14, 13, 16, 24, 40, 57, 69, 56, 14, 17, 22, 29),
    *(51, 87, 80, 62, 18, 22, 37, 56, 68, 109, 103, 77, 24, 35, 55, 64, 81, 104, 113, 92, 49, 64, 78, 87, 103, 121),
    *(120, 101, 72, 92, 95, 98, 112, 100, 103, 99),
)
ANNEX_K_CHROMA: Table = (
    *(17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99, 24, 26, 56, 99, 99, 99, 99, 99, 47, 66),
    *(99,) * 38,
)

#: The beginning of a segment with a part of an ICC profile; OpenImageIO reads none of which a part is absent.
_PROFILE = b"ICC_PROFILE\0"

_GAIN_MAPS = (b"http://ns.adobe.com/hdr-gain-map/", b"urn:iso:std:iso:ts:21496:-1")

#: Exceptions of Pillow for damaged files.
DAMAGE = (IndexError, KeyError, OSError, SyntaxError, TypeError, ValueError, ZeroDivisionError, struct.error)


def read_jpeg_header(content: bytes) -> FileMetadata:
    """Return the metadata in the segments up to the first scan that OpenImageIO leaves out; empty if damaged."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of damaged EXIF
            image = JpegImageFile(io.BytesIO(content))  # not Image.open, which refuses 200 megapixels
    except DAMAGE:
        return FileMetadata()
    tables = [tuple(image.quantization.get(table, ())) for _, _, _, table in image.layer]
    segments = [(name, bytes(payload)) for name, payload in image.applist]
    exif = io.BytesIO(image.info.get("exif", b"")[6:])
    return FileMetadata(
        luma_table=tables[0] if tables else (),
        chroma_table=tables[1] if len(tables) > 1 else (),
        has_jfif=any(name == "APP0" and payload.startswith(b"JFIF\0") for name, payload in segments),
        has_adobe=any(name == "APP14" and payload.startswith(b"Adobe") for name, payload in segments),
        software=exif_software(exif),
        interop_index=interop_index(exif),
        color=ColorTags(source=DAMAGED if any(payload.startswith(_PROFILE) for _, payload in segments) else ""),
        has_gain_map=any(mark in payload for name, payload in segments for mark in _GAIN_MAPS),
    )


def ijg_quality(luma: Table, chroma: Table = ()) -> int | None:
    """Return the quality, 1 to 100, at which the IJG library writes just these tables; None if it never does."""
    quality = _QUALITIES.get(luma)
    if quality is None or (chroma and chroma != scaled_table(ANNEX_K_CHROMA, quality)):
        return None
    return quality


def scaled_table(table: Table, quality: int) -> Table:
    """Return a table scaled as the IJG library (jcparam.c) does: divisors of 1 to 255 for a quality of 1 to 100."""
    percent = 5000 // quality if quality < 50 else 200 - 2 * quality
    return tuple(min(max((divisor * percent + 50) // 100, 1), 255) for divisor in table)


_QUALITIES = {scaled_table(ANNEX_K_LUMA, quality): quality for quality in range(1, 101)}  # table of luma -> quality
