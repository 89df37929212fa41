"""What a file says of how its photograph was made: evidence beside the pixels, used where it is there.

file_metadata   what is read: names, sizes, tables, profile
transfer_tags   log, PQ and HLG, as files name them
color_tags      primaries and encodings as files tag them
header_colors   the tags in a header: ICC profile, CICP, EXIF
cicp            the code points of ITU-T H.273
icc             the primaries of an ICC profile
exif            what OpenImageIO leaves out of EXIF
jpeg            the segments of a JPEG file before its first scan; the tables of the IJG library
devices         phone, compact or camera with interchangeable lenses, by maker and model
editors         programs that edit or develop photographs, by name
encodings       what the file says of its code values
origin          what follows: device, editor, scaled or not, saved again or not, and this in words

Nothing here opens a file: `image_io` hands over the header and the segments. Damaged metadata is never an error.
"""

from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.photograph.metadata.origin import FileOrigin, as_told, file_origin

__all__ = ["Device", "FileMetadata", "FileOrigin", "as_told", "file_origin"]
