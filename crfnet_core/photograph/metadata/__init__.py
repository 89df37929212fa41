"""The metadata of image files as evidence of how a photograph was made.

file_metadata   the fields that are read: names, sizes, tables, profile
color_tags      primaries, code points of ITU-T H.273, and names of encodings
header_colors   the color tags in a header: ICC profile, CICP, PNG, EXIF, OpenEXR
icc             primaries of ICC profiles, and their published curves
jpeg            the segments of a JPEG file before its first scan; the tables of the IJG library
devices         phone, compact or camera with interchangeable lenses, by maker and model
editors         programs that edit or develop photographs, by name
origin          the conclusions: device, editor, scaled or not, saved again or not, and this in words

Nothing here opens a file: `image_io` hands over the header and the segments. Damaged metadata is never an error.
"""

from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.photograph.metadata.origin import Encoding, FileOrigin, file_origin, with_stated_device

__all__ = ["Device", "Encoding", "FileMetadata", "FileOrigin", "file_origin", "with_stated_device"]
