import io
import struct

import numpy as np
import pytest
from PIL import Image

from crfnet_core.colorimetry import DISPLAY_P3, REC2020
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_metadata
from tests.helpers.color_profiles import matrix_profile
from tests.helpers.colored_ramp import colored_ramp
from tests.helpers.crafted_files import box
from tests.helpers.folders import written
from tests.helpers.images import write_image
from tests.helpers.refusals import refusal_of

ALPHA = np.full((48, 64, 1), 128, np.uint8)


#: A palette of black alone, and the three channels that it makes of the first component.
PALETTE = box(b"pclr", struct.pack(">HB3B", 256, 3, 7, 7, 7) + bytes(768))
PALETTE += box(b"cmap", b"".join(struct.pack(">HBB", 0, 1, column) for column in range(3)))


def jp2(path, codes, boxes=b"", color=b"\1\0\0\0\0\0\x10", components=None):
    """Write JPEG 2000 with more boxes in its header, another color box and other components in its marker SIZ."""
    file = io.BytesIO()
    Image.fromarray(codes).save(file, "JPEG2000", no_jp2=True)
    stream = bytearray(file.getvalue())
    for at, values in enumerate(components or ()):
        stream[42 + 3 * at : 45 + 3 * at] = bytes(values)
    height, width, channels = codes.shape
    header = box(b"ihdr", struct.pack(">IIH4B", height, width, channels, 7, 7, 0, 0))
    header += box(b"colr", color) + boxes
    start = box(b"jP  ", b"\r\n\x87\n") + box(b"ftyp", b"jp2 \0\0\0\0jp2 ")
    return written(path, start + box(b"jp2h", header) + box(b"jp2c", bytes(stream)))


def channels(*entries):
    return box(b"cdef", struct.pack(">H", len(entries)) + b"".join(struct.pack(">3H", *each) for each in entries))


@pytest.mark.parametrize(("kind", "is_associated"), [(1, False), (2, True)])
def test_alpha_is_associated_if_the_file_says_so(tmp_path, kind, is_associated):
    codes = colored_ramp(8) // 2
    definition = channels((0, 0, 1), (1, 0, 2), (2, 0, 3), (3, kind, 0))
    values = read_codes(jp2(tmp_path / "a.jp2", np.dstack([codes, ALPHA]), definition))
    assert values.is_associated == is_associated
    np.testing.assert_allclose(values.pixels(), codes / (128 if is_associated else 255), atol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        *(({"color": b"\1\0\0" + struct.pack(">I", space)}, "other_colors") for space in (12, 14)),
        ({"boxes": PALETTE}, "palette"),
        ({"codes": colored_ramp(8)[:47, :, :2]}, "coding_not_read"),
        *(({"components": each}, "coding_not_read") for each in ([(0x87, 1, 1)], [(7, 1, 1), (7, 2, 2), (7, 2, 2)])),
    ],
)
def test_what_openimageio_returns_as_other_pixels_is_refused(tmp_path, arguments, code):
    path = jp2(tmp_path / "a.jp2", **{"codes": colored_ramp(8)[:47], **arguments})
    for read in (read_codes, read_metadata):
        assert refusal_of(PhotoError, read, path).code == code


@pytest.mark.parametrize(
    ("color", "expected"),
    [
        *((head + matrix_profile(DISPLAY_P3), (DISPLAY_P3, "", "ICC profile")) for head in (b"\2\0\0", b"\3\0\0")),
        (b"\5\0\0" + struct.pack(">3HB", 9, 16, 0, 128), (REC2020, "PQ", "CICP")),
    ],
)
def test_the_color_box_is_read(tmp_path, color, expected):
    found = read_metadata(jp2(tmp_path / "a.jp2", colored_ramp(8), color=color)).color
    assert (found.primaries, found.transfer, found.source) == expected


@pytest.mark.parametrize("alpha", [255, 128])
def test_jpeg_xl_whose_colors_may_be_multiplied_by_alpha_is_refused(tmp_path, alpha):
    """OpenImageIO drops the bit that says so, but no such color is above alpha."""
    codes = np.dstack([colored_ramp(8) // 2, np.full_like(ALPHA, alpha)])
    path = write_image(tmp_path / "a.jxl", codes, compression="jpegxl:100")
    if alpha == 255:
        assert not read_codes(path).is_associated
        return
    assert refusal_of(PhotoError, read_codes, path).code == "coding_not_read"
