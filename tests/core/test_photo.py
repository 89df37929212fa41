import io
import itertools
import struct
import sys
import zipfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image, ImageOps

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_metadata, read_photo
from crfnet_core.photograph.metadata import file_origin
from tests.helpers.crafted_files import png, png_chunk
from tests.helpers.folders import written
from tests.helpers.images import read_image, write_image
from tests.helpers.memory import memory_of_reading
from tests.helpers.refusals import refusal_of, refused

CODES8 = np.array([[[0, 1, 2], [127, 128, 129]], [[253, 254, 255], [10, 20, 30]]], np.uint8)
CODES16 = np.array([[[0, 1, 2], [32767, 32768, 32769]], [[65533, 65534, 65535], [100, 200, 300]]], np.uint16)


FORMATS = {
    **{"a.png": "PNG", "a.tif": "TIFF", "a.webp": "WebP", "a.dpx": "DPX", "a.bmp": "BMP"},
    **{"a.jp2": "JPEG 2000", "a.j2k": "JPEG 2000", "a.jxl": "JPEG XL"},
}
DEEP = ("a.png", "a.tif", "a.dpx", "a.jxl", "a.jp2")


@pytest.mark.parametrize(("name", "bits"), [*((name, 8) for name in FORMATS), *((name, 16) for name in DEEP)])
def test_codes_of_8_and_16_bits_over_the_largest(tmp_path, name, bits):
    codes = np.tile(CODES8 if bits == 8 else CODES16, (16, 16, 1))  # JPEG 2000 and JPEG XL are not written any smaller
    compression = {"a.jxl": "jpegxl:100", "a.webp": "lossless"}.get(name, "none")
    photo = read_photo(write_image(tmp_path / name, codes, compression=compression))
    assert photo.pixels.dtype == np.float32
    assert photo.pixels.flags.c_contiguous
    assert (photo.bit_depth, photo.is_gray, photo.path) == (bits, False, tmp_path / name)
    assert photo.metadata.file_format == FORMATS[name]
    np.testing.assert_array_equal(photo.pixels, (codes / (2**bits - 1)).astype(np.float32))


@pytest.mark.parametrize(("name", "bits"), [*itertools.product(["a.dpx", "a.tif", "a.jp2"], [10, 12])])
def test_10_and_12_bit_codes_over_their_own_largest(tmp_path, name, bits):
    side = 2 ** (bits // 2)
    codes = np.arange(2**bits).reshape(side, side, 1).repeat(3, axis=2)
    widened = np.round(codes * (65535 / (2**bits - 1))).astype(np.uint16)  # as OpenImageIO takes them
    path = write_image(tmp_path / name, widened, oiio__BitsPerSample=bits)
    np.testing.assert_array_equal(read_codes(path).codes, codes)
    photo = read_photo(path)
    assert photo.bit_depth == bits
    np.testing.assert_array_equal(photo.pixels, (codes / (2**bits - 1)).astype(np.float32))


def test_no_profile_or_gamma_is_applied(tmp_path):
    rows = b"".join(b"\0" + bytes(row.ravel().tolist()) for row in CODES8)
    content = png(2, 2, rows, chunks=png_chunk(b"gAMA", struct.pack(">I", 100000)))
    np.testing.assert_array_equal(read_codes(written(tmp_path / "a.png", content)).codes, CODES8)


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.jpg", "a.webp", "a.avif"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_every_orientation_is_turned_upright(tmp_path, name, orientation):
    """Pillow turns the same file; EXIF may be larger than a JPEG can hold."""
    ramp = np.indices((24, 16)).transpose(1, 2, 0) * 8
    codes = np.concatenate([ramp, np.full((24, 16, 1), 9)], axis=2).astype(np.uint8)
    exif = Image.Exif()
    exif[0x010F], exif[0x0112], exif[0x8298] = "Maker", orientation, "a" * (9 if name == "a.jpg" else 70_000)
    options = {"a.tif": {"compression": "raw"}, "a.webp": {"lossless": True}}.get(name, {"quality": 95})
    Image.fromarray(codes).save(tmp_path / name, exif=exif, **options)
    with Image.open(tmp_path / name) as image:
        expected = np.asarray(ImageOps.exif_transpose(image))
    values = read_codes(tmp_path / name)
    np.testing.assert_allclose(values.codes, expected, atol=4 if name == "a.jpg" else 0)
    assert values.metadata.make == "Maker"
    assert (values.header.height, values.header.width) == values.codes.shape[:2]
    assert values.header.get_int_attribute("Orientation", 1) == 1
    metadata = read_metadata(tmp_path / name)
    assert metadata == values.metadata
    assert (metadata.height, metadata.width, metadata.is_turned) == (*values.codes.shape[:2], orientation != 1)
    assert ("turned upright, as the file asks" in file_origin(metadata).words) is (orientation != 1)


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.jpg", "a.dpx", "a.bmp"])
def test_gray_file_is_replicated(tmp_path, name):
    photo = read_photo(write_image(tmp_path / name, np.full((8, 8, 1), 51, np.uint8)))
    assert photo.is_gray
    assert photo.pixels.shape == (8, 8, 3)
    np.testing.assert_array_equal(photo.pixels, np.full((8, 8, 3), 0.2, np.float32))


@pytest.mark.parametrize("channel", [0, 1, 2])
def test_gray_means_equal_channels_everywhere(tmp_path, channel):
    codes = np.repeat(np.arange(40 * 40, dtype=np.uint8).reshape(40, 40, 1), 3, axis=2)
    assert read_photo(write_image(tmp_path / "gray.png", codes)).is_gray
    codes[33, 21, channel] += 1
    assert not read_photo(write_image(tmp_path / "colour.png", codes)).is_gray


@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_unassociated_alpha_is_dropped_and_the_codes_are_kept(tmp_path, name):
    alpha = np.array([[[0], [1]], [[128], [255]]], np.uint8)
    path = write_image(tmp_path / name, np.concatenate([CODES8, alpha], axis=2), oiio__UnassociatedAlpha=1)
    values = read_codes(path)
    np.testing.assert_array_equal(read_photo(path).pixels, (CODES8 / 255).astype(np.float32))
    np.testing.assert_array_equal(values.alpha, alpha[..., 0])
    assert not values.is_associated


def test_associated_alpha_is_divided_out(tmp_path):
    stored = np.array([[[0, 0, 0, 0], [50, 100, 25, 100], [10, 20, 30, 255], [90, 0, 0, 80]]], np.uint8)
    path = write_image(tmp_path / "a.tif", stored)
    expected = [[[0, 0, 0], [0.5, 1, 0.25], [10 / 255, 20 / 255, 30 / 255], [1, 0, 0]]]
    np.testing.assert_allclose(read_photo(path).pixels, expected, rtol=1e-7)
    assert read_codes(path).is_associated


@pytest.mark.parametrize(("content", "name"), [("a.png", "b.jpg"), ("a.jpg", "b.png"), ("a.tif", "b")])
def test_the_content_counts_not_the_suffix(tmp_path, content, name):
    write_image(tmp_path / content, CODES8)
    expected = read_photo(tmp_path / content).pixels
    np.testing.assert_array_equal(read_photo((tmp_path / content).rename(tmp_path / name)).pixels, expected)


@pytest.fixture
def ultra_hdr(tmp_path):
    noise = 8 * np.random.default_rng(0).random((64, 64, 3), np.float32).astype(np.float16)
    path = write_image(tmp_path / "a.jpg", noise, jpeg__ultrahdr=1, oiio__ColorSpace="lin_rec709_scene")
    if str(oiio.ImageBuf(str(path)).spec().format) == "uint8":
        pytest.skip("this OpenImageIO has no Ultra HDR writer or reader")
    return path


def test_ultra_hdr_gives_the_standard_image(tmp_path, ultra_hdr):
    whole = ultra_hdr.read_bytes()
    plain = written(tmp_path / "plain.jpg", whole[: whole.index(b"\xff\xd9", whole.index(b"\xff\xda")) + 2])
    photo = read_photo(ultra_hdr)
    assert (photo.bit_depth, photo.path, photo.metadata.has_gain_map) == (8, ultra_hdr, True)
    np.testing.assert_array_equal(photo.pixels, read_image(plain, kind="uint8") / np.float32(255))


def test_a_damaged_ultra_hdr_photograph_is_named_itself(ultra_hdr):
    whole = ultra_hdr.read_bytes()
    middle = (whole.index(b"\xff\xda") + whole.index(b"\xff\xd9")) // 2
    ultra_hdr.write_bytes(whole[:middle] + b"\xff\xd9" + whole[middle + 2 :])
    with refused(PhotoError, "damaged", path=ultra_hdr):
        read_photo(ultra_hdr)


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak memory as Linux reports it")
def test_memory_is_the_codes_alone(tmp_path):
    size, is_read = memory_of_reading(write_image(tmp_path / "a.png", np.zeros((3000, 4000, 3), np.uint8)))
    assert is_read
    assert size < 1.5 * 12e6 * 3 / 1024, "kB"


@pytest.mark.parametrize("source", [None, 3, CODES8, io.StringIO("text"), io.TextIOWrapper(io.BytesIO(b"\xff\xd8"))])
def test_other_sources_are_refused(source):
    assert refusal_of(PhotoError, read_photo, source).code == "photograph_source"


def test_bytes_and_open_files_are_read_as_their_file(tmp_path):
    path = write_image(tmp_path / "a.png", CODES16)
    expected = read_photo(path)
    with path.open("rb") as file:
        photos = [read_photo(source) for source in [path.read_bytes(), io.BytesIO(path.read_bytes()), file]]
    for photo in photos:
        np.testing.assert_array_equal(photo.pixels, expected.pixels)
        assert photo.metadata == expected.metadata
    assert [photo.path for photo in photos] == [Path("bytes"), Path("bytes"), path]


@pytest.mark.parametrize("name", ["..", "/", "a" * 300, "a\0b", "a/b.jpg", 7])
def test_the_name_of_an_open_file_is_a_name_only(tmp_path, name):
    file = io.BytesIO(write_image(tmp_path / "a.png", CODES8).read_bytes())
    file.name = name
    np.testing.assert_array_equal(read_photo(file).pixels, read_photo(tmp_path / "a.png").pixels)
    assert refusal_of(PhotoError, read_photo, file).code == "stream_at_end"


@pytest.mark.parametrize("problem", [OSError(5, "damaged"), ValueError("of closed file"), zipfile.BadZipFile()])
def test_a_file_that_cannot_be_read_is_refused(problem):
    class Broken(io.BytesIO):
        def read(self, size=-1):
            raise problem

    assert refusal_of(PhotoError, read_photo, Broken()).code == "stream_not_read"


def test_an_error_of_bytes_names_no_temporary_file():
    with refused(PhotoError, "not_an_image_file", path=Path("bytes")):
        read_photo(b"a.png")


@pytest.mark.parametrize("is_associated", [False, True])
def test_some_pixels_are_those_of_all_pixels_before_and_after_these_are_computed(tmp_path, is_associated):
    codes = np.random.default_rng(0).integers(0, 256, (40, 30, 4), np.uint8)
    stored = np.minimum(codes, codes[..., 3:]) if is_associated else codes
    photo = read_photo(write_image(tmp_path / "a.tif", stored, oiio__UnassociatedAlpha=int(not is_associated)))
    index = np.s_[3:30:4, ::5]
    before = photo[index]
    assert "pixels" not in vars(photo)
    assert photo.shape == photo.pixels.shape == (40, 30, 3)
    np.testing.assert_array_equal(before, photo.pixels[index])
    np.testing.assert_array_equal(photo[index], before)
