import numpy as np
import pytest
from PIL import Image

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_metadata, read_photo
from tests.helpers.colored_ramp import colored_ramp
from tests.helpers.crafted_files import jpeg, tiff, with_jpeg_segment


def code_of(path, read=read_photo):
    with pytest.raises(PhotoError) as caught:
        read(path)
    return caught.value.code


@pytest.mark.parametrize("name", ["a.gif", "a.png", "a.tif", "a.bmp"])
def test_palettes_are_refused_alike(tmp_path, name):
    Image.fromarray(colored_ramp(8).astype(np.uint8)).quantize(16).save(tmp_path / name)
    assert code_of(tmp_path / name) == code_of(tmp_path / name, read_metadata) == "palette"


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp"])
def test_gray_is_no_palette(tmp_path, name):
    """Although a BMP file of 8 bits always has one."""
    gray = colored_ramp(8).astype(np.uint8)[..., 0]
    Image.fromarray(gray).save(tmp_path / name)
    np.testing.assert_array_equal(read_codes(tmp_path / name).codes[..., 0], gray)


@pytest.mark.parametrize("extra", [((254, 4, 0), (330, 4, 8)), ((254, 4, 2),), ()])
def test_other_tiff_files_are_no_raw(tmp_path, extra):
    (tmp_path / "a.tif").write_bytes(tiff(2, 2, extra=extra, content=bytes(range(12))))
    assert read_codes(tmp_path / "a.tif").codes.ravel().tolist() == list(range(12))


@pytest.mark.parametrize(
    ("marker", "payload"),
    [
        (0xE1, b"http://ns.adobe.com/xap/1.0/\0<x xmlns:hdrgm='http://ns.adobe.com/hdr-gain-map/1.0/'/>"),
        (0xE2, b"urn:iso:std:iso:ts:21496:-1\0" + bytes(4)),
    ],
)
def test_the_gain_map_of_a_jpeg_is_said(tmp_path, marker, payload):
    path = tmp_path / "a.jpg"
    content = jpeg(path)
    assert not read_photo(path).metadata.has_gain_map
    path.write_bytes(with_jpeg_segment(content, marker, payload))
    assert read_photo(path).metadata.has_gain_map
