"""JPEG XL, JPEG 2000, BMP and TGA are read with all their bits; palettes and camera raw by content are refused."""

import struct

import numpy as np
import pytest
from PIL import Image

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_metadata, read_photo
from tests.helpers.colored_ramp import colored_ramp
from tests.helpers.crafted_files import jpeg, tiff, with_jpeg_segment
from tests.helpers.images import write_image


def code_of(path, read=read_photo):
    """Return the code of the error by which a file is refused."""
    with pytest.raises(PhotoError) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: ")
    return caught.value.code


def widened(codes, bits):
    """Return codes of `bits` bits as OpenImageIO takes them: on the scale of 16 bits."""
    return np.round(codes * (65535 / (2**bits - 1))).astype(np.uint16)


@pytest.mark.parametrize(
    ("name", "kind"),
    [("a.jp2", "JPEG 2000"), ("a.j2k", "JPEG 2000"), ("a.bmp", "BMP"), ("a.tga", "TGA"), ("a.jxl", "JPEG XL")],
)
def test_8_bit_codes_are_exact(tmp_path, name, kind):
    values = read_codes(write_image(tmp_path / name, colored_ramp(8), compression="jpegxl:100"))
    assert (values.bit_depth, values.metadata.file_format) == (8, kind)
    np.testing.assert_array_equal(values.codes, colored_ramp(8))


@pytest.mark.parametrize("bits", [10, 12, 16])
def test_jpeg_2000_keeps_its_bits(tmp_path, bits):
    codes = colored_ramp(bits)
    values = read_codes(write_image(tmp_path / "a.jp2", widened(codes, bits), oiio__BitsPerSample=bits))
    assert values.bit_depth == bits
    np.testing.assert_array_equal(values.codes, codes)


def test_jpeg_xl_keeps_16_bits(tmp_path):
    values = read_codes(write_image(tmp_path / "a.jxl", colored_ramp(16), compression="jpegxl:100"))
    assert values.bit_depth == 16
    np.testing.assert_array_equal(values.codes, colored_ramp(16))


def test_the_content_counts_not_the_suffix(tmp_path):
    write_image(tmp_path / "a.jp2", colored_ramp(8)).rename(tmp_path / "a.jpg")
    assert read_photo(tmp_path / "a.jpg").metadata.file_format == "JPEG 2000"


def test_tga_with_alpha_keeps_its_codes(tmp_path):
    codes = np.dstack([colored_ramp(8), np.full((48, 64), 128, np.uint8)])
    values = read_codes(write_image(tmp_path / "a.tga", codes, oiio__UnassociatedAlpha=1))
    np.testing.assert_array_equal(values.codes, codes[..., :3])
    assert (values.alpha == 128).all()


@pytest.mark.parametrize("content", [b"hello" * 20, bytes(64), b"\0\0\x02" + bytes(20)])
def test_a_tga_suffix_alone_makes_no_tga(tmp_path, content):
    (tmp_path / "a.tga").write_bytes(content)
    assert code_of(tmp_path / "a.tga") == "not_an_image_file"


@pytest.mark.parametrize("name", ["a.jxl", "a.jp2", "a.bmp", "a.tga"])
@pytest.mark.parametrize("fraction", [0.3, 0.8])
def test_cut_files_are_refused(tmp_path, name, fraction):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    whole = write_image(tmp_path / name, noise, compression="jpegxl:100").read_bytes()
    (tmp_path / name).write_bytes(whole[: int(len(whole) * fraction)])
    assert code_of(tmp_path / name) == "damaged"


def test_gif_is_refused_for_its_palette(tmp_path):
    path = write_image(tmp_path / "a.gif", colored_ramp(8))
    assert code_of(path) == "palette"


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp", "a.tga"])
@pytest.mark.parametrize("colors", [16, 256])
def test_other_palettes_are_refused_alike(tmp_path, name, colors):
    Image.fromarray(colored_ramp(8).astype(np.uint8)).quantize(colors).save(tmp_path / name)
    assert code_of(tmp_path / name) == code_of(tmp_path / name, read_metadata) == "palette"


@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_black_and_white_is_refused(tmp_path, name):
    Image.fromarray(colored_ramp(8)[..., 0] > 127).save(tmp_path / name)
    assert code_of(tmp_path / name) == "sample_type"


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.bmp", "a.tga"])
def test_gray_is_no_palette(tmp_path, name):
    """Although a BMP file of 8 bits always has one."""
    gray = colored_ramp(8).astype(np.uint8)[..., 0]
    Image.fromarray(gray).save(tmp_path / name)
    np.testing.assert_array_equal(read_codes(tmp_path / name).codes[..., 0], gray)


def canon_raw(path):
    content = bytearray(tiff(2, 2, content=bytes(12)))
    content[4:8] = struct.pack("<I", len(content))
    path.write_bytes(bytes(content[:8]) + b"CR\2\0" + bytes(40))


def digital_negative(path):
    path.write_bytes(tiff(2, 2, extra=((50706, 1, 0x0401),), content=bytes(12)))


def preview_before_raw(path):
    path.write_bytes(tiff(2, 2, extra=((254, 4, 1), (330, 4, 8)), content=bytes(12)))


def fujifilm(path):
    path.write_bytes(b"FUJIFILMCCD-RAW 0201" + bytes(80))


def canon_cr3(path):
    path.write_bytes(b"\0\0\0\x18ftypcrx \0\0\0\x01crx isom" + bytes(80))


@pytest.mark.parametrize("make", [canon_raw, digital_negative, preview_before_raw, fujifilm, canon_cr3])
def test_camera_raw_is_known_by_its_content(tmp_path, make):
    make(tmp_path / "a.tif")
    assert code_of(tmp_path / "a.tif") == "camera_raw"


@pytest.mark.parametrize("extra", [((254, 4, 0), (330, 4, 8)), ((254, 4, 2),), ()])
def test_other_tiff_files_are_no_raw(tmp_path, extra):
    (tmp_path / "a.tif").write_bytes(tiff(2, 2, extra=extra, content=bytes(range(12))))
    assert read_codes(tmp_path / "a.tif").codes.ravel().tolist() == list(range(12))


@pytest.mark.parametrize("start", [0, 10**9])
def test_a_tiff_without_a_directory_is_damaged(tmp_path, start):
    (tmp_path / "a.tif").write_bytes(b"II*\0" + struct.pack("<I", start) + bytes(8))
    assert code_of(tmp_path / "a.tif") == "damaged"


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
