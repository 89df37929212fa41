"""The one reader of image files: a photograph's code values, before any colour management.

reading          any file that is read, to a `Photo` or to `CodeValues`
file_kinds       which format a file has, told from its first bytes; what is refused for it
camera_raw       camera raw, told from its first bytes and from the directory of a TIFF file
header_checks    what a header must say: size, depth, colour
jpeg_files       JPEG: checks before decoding, and the standard image of one with a gain map
png_files        PNG: what its chunks say of colours
heif             HEIC and AVIF, which OpenImageIO's wheel cannot read
problems         the errors of files that cannot be decoded
"""

from crfnet_core.photograph.image_io.camera_raw import RAW_SUFFIXES
from crfnet_core.photograph.image_io.file_kinds import HEIF_SUFFIXES, LINEAR_SIGNATURES, PHOTOGRAPH_SUFFIXES, SIGNATURES
from crfnet_core.photograph.image_io.header_checks import MAX_PIXELS
from crfnet_core.photograph.image_io.problems import first_line, oiio_message
from crfnet_core.photograph.image_io.reading import read_codes, read_metadata, read_photo

__all__ = [
    "HEIF_SUFFIXES",
    "LINEAR_SIGNATURES",
    "MAX_PIXELS",
    "PHOTOGRAPH_SUFFIXES",
    "RAW_SUFFIXES",
    "SIGNATURES",
    "first_line",
    "oiio_message",
    "read_codes",
    "read_metadata",
    "read_photo",
]
