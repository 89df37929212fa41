"""The one reader of image files: a photograph's code values, before any color management.

reading          any file that is read, to a `Photo` or to `CodeValues`
file_kinds       formats by their first bytes; refuses camera raw, linear files and palettes
header_checks    size, depth and colors in a header; texts without control characters; errors of decoders
jpeg_files       JPEG: checks before decoding, and the standard image of a file with a gain map
iso_boxes        the boxes that HEIF, JPEG 2000 and JPEG XL are made of
heif_items       HEIF: the items in these boxes, and how often they are decoded
dpx_files        DPX: codings that OpenImageIO misreads, and missing ends
jp2_files        JPEG 2000: codings that OpenImageIO misreads, associated alpha, tags of color
jxl_files        JPEG XL: animations, linear light, and metadata in boxes
png_files        PNG: the chunks of color
pillow_files     HEIC, AVIF, BMP and WebP, which OpenImageIO's wheel does not read, or not all of
"""

from crfnet_core.photograph.image_io.file_kinds import PHOTOGRAPH_SUFFIXES, RAW_SUFFIXES
from crfnet_core.photograph.image_io.header_checks import MAX_PIXELS, first_line, oiio_message
from crfnet_core.photograph.image_io.reading import read_codes, read_content, read_metadata, read_photo

__all__ = ["MAX_PIXELS", "PHOTOGRAPH_SUFFIXES", "RAW_SUFFIXES", "first_line", "oiio_message"]
__all__ += ["read_codes", "read_content", "read_metadata", "read_photo"]
