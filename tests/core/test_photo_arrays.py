import io
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

from crfnet_core import Photo, read_photo
from crfnet_core.errors import CRFNetError, PhotoError
from crfnet_core.photograph.metadata import FileMetadata
from tests.helpers.images import write_image
from tests.helpers.refusals import refusal_of, refused

CODES = np.array([[[0, 1, 2], [127, 128, 129]], [[253, 254, 255], [10, 20, 30]]], np.uint8)
ALPHA = np.array([[[255], [255]], [[0], [128]]], np.uint8)
EXACT = (CODES / 255).astype(np.float32)
CAMERA = FileMetadata(make="Canon", model="Canon EOS 20D")


def code_of(array, **options):
    """Return the code of the error by which an array is refused; its sentence begins with the name."""
    with pytest.raises(PhotoError) as caught:
        Photo.from_array(array, name="shot 7", **options)
    assert str(caught.value).startswith("shot 7: ")
    return caught.value.code


def with_alpha(codes):
    return np.concatenate([codes, ALPHA], axis=2)


@pytest.mark.parametrize(
    ("array", "order"),
    [
        *((CODES, "RGB"), (CODES[..., ::-1], "BGR"), (with_alpha(CODES), "RGBA")),
        *((with_alpha(CODES[..., ::-1]), "BGRA"), (EXACT, "RGB"), (EXACT.tolist(), "RGB")),
        (EXACT.astype(np.float64)[..., ::-1], "BGR"),
    ],
)
def test_the_order_of_the_channels_is_as_stated(array, order):
    photo = Photo.from_array(array, color_order=order, name="shot 7", metadata=CAMERA)
    assert (photo.path, photo.metadata) == (Path("shot 7"), CAMERA)
    assert not np.shares_memory(photo.pixels, array)
    assert photo.pixels.dtype == np.float32
    assert photo.pixels.flags.c_contiguous
    np.testing.assert_array_equal(photo.pixels, EXACT)
    assert not photo.is_gray


def test_a_file_that_is_mapped_into_memory_is_an_array(tmp_path):
    CODES.tofile(tmp_path / "codes")
    mapped = np.memmap(tmp_path / "codes", CODES.dtype, "r", shape=CODES.shape)
    np.testing.assert_array_equal(Photo.from_array(mapped, color_order="RGB").pixels, EXACT)


@pytest.mark.parametrize("bits", [10, 12, np.uint8(16)])
def test_uint16_is_divided_by_the_largest_code_of_its_bit_depth(bits):
    largest = 2 ** int(bits) - 1
    codes = np.array([[[0, 1, largest]]], np.uint16)
    photo = Photo.from_array(codes, color_order="RGB", bit_depth=bits)
    np.testing.assert_array_equal(photo.pixels, (codes / largest).astype(np.float32))
    assert photo.bit_depth == bits


@pytest.mark.parametrize("array", [CODES[..., 0], CODES[..., :1], CODES[..., 0].astype(np.float32) / np.float32(255)])
def test_one_channel_is_replicated(array):
    photo = Photo.from_array(array)
    np.testing.assert_array_equal(photo.pixels, np.repeat(EXACT[..., :1], 3, axis=2))
    assert photo.is_gray


@pytest.mark.parametrize(("kind", "bits"), [(np.uint8, 8), (np.float16, 16), (np.float32, 32), (np.float64, 64)])
def test_the_bit_depth_is_that_of_the_type(kind, bits):
    photo = Photo.from_array(np.zeros((2, 2), kind))
    assert photo.bit_depth == bits
    assert Photo.from_array(np.zeros((2, 2), np.float32), bit_depth=10).bit_depth == 10


@pytest.mark.parametrize(
    ("array", "channels"),
    [
        *((CODES, [0, 1, 2]), (with_alpha(CODES), [0, 1, 2])),
        *((CODES[..., 0], [0, 0, 0]), (with_alpha(CODES[..., :1]), [0, 0, 0])),
    ],
)
def test_an_image_of_pillow_knows_its_order(array, channels):
    np.testing.assert_array_equal(Photo.from_array(Image.fromarray(array)).pixels, EXACT[..., channels])


@pytest.mark.parametrize("byte_order", ["<", ">"])
def test_an_image_of_pillow_with_16_bits(byte_order):
    codes = np.array([[0, 1, 300], [40000, 65534, 65535]], f"{byte_order}u2")
    image = Image.frombytes(f"I;16{'B' if byte_order == '>' else ''}", (3, 2), codes.tobytes())
    photo = Photo.from_array(image, bit_depth=16)
    np.testing.assert_array_equal(photo.pixels[..., 1], (codes / 65535).astype(np.float32))
    assert code_of(image) == "array_without_bit_depth"


def test_opencv_reads_what_read_photo_reads(tmp_path, codes):
    cv2 = pytest.importorskip("cv2")
    path = write_image(tmp_path / "a.png", codes)
    found = Photo.from_array(cv2.imread(str(path)), color_order="BGR")
    np.testing.assert_array_equal(found.pixels, read_photo(path).pixels)


@pytest.mark.parametrize(("suffix", "channels"), [("png", np.s_[:]), ("tif", np.s_[:]), ("tif", 0)])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_an_image_of_pillow_is_turned_upright_as_its_file_is(tmp_path, codes, suffix, channels, orientation):
    path, exif = tmp_path / f"a.{suffix}", Image.Exif()
    exif[0x0112] = orientation
    Image.fromarray(np.ascontiguousarray(codes[..., channels])).save(path, exif=exif)
    with Image.open(path) as image:
        np.testing.assert_array_equal(Photo.from_array(image).pixels, read_photo(path).pixels)


def test_an_image_of_pillow_with_damaged_exif_is_as_stored_and_one_that_is_cut_short_is_refused(tmp_path, codes):
    Image.fromarray(codes).save(tmp_path / "a.png", exif=b"Exif\0\0damaged")
    with Image.open(tmp_path / "a.png") as image:
        np.testing.assert_array_equal(Photo.from_array(image).pixels, (codes / 255).astype(np.float32))
    content = write_image(tmp_path / "a.tif", codes, Compression="none").read_bytes()
    with Image.open(io.BytesIO(content[: len(content) // 2])) as image:
        assert code_of(image) == "damaged"


def test_a_closed_image_of_pillow_is_refused_as_such(tmp_path, codes):
    path = write_image(tmp_path / "a.jpg", codes)
    with Image.open(path) as never_read:
        pass
    loaded, plain = Image.open(path), Image.fromarray(codes)
    loaded.load()
    for image in (loaded, plain):
        image.close()
    with path.open("rb") as file:
        of_closed_file = Image.open(file)
    images = [never_read, loaded, plain, of_closed_file]
    assert [code_of(image) for image in images] == ["pillow_closed"] * 4


def test_pixels_that_were_checked_cannot_be_changed(tmp_path, codes):
    read = read_photo(write_image(tmp_path / "a.png", codes))
    for photo in (read, Photo.from_array(read.pixels, color_order="RGB"), Photo(read.pixels.copy(), 8, False, "a")):
        for pixels in (photo.pixels, photo.pixels[0]):
            with pytest.raises(ValueError, match="read-only"):
                pixels[...] = 2


#: Code -> arrays that are refused with it, and the order of their channels.
REFUSED_ARRAYS = {
    "array_is_none": [(None, None)],
    "array_sample_type": [
        *((Path("plate.jpg"), None), ([[1, 2], [3]], None), (CODES.astype(np.int64), "RGB")),
        *((np.ma.masked_greater(EXACT, 0.9), "RGB"), (SimpleNamespace(mode="rb"), None)),  # as open files have it
    ],
    "array_without_order": [(CODES, None)],
    "array_unknown_order": [(CODES, "GBR"), (CODES, 5), (CODES, CODES)],
    "array_other_order": [(CODES, "RGBA"), (CODES[..., 0], "RGB")],
    "array_channels_first": [(np.zeros((3, 20, 30), np.uint8), "RGB")],
    "array_shape": [(np.zeros(shape, np.uint8), "RGB") for shape in ((2, 20, 30, 3), (0, 0, 3), (5,))],
    "array_without_bit_depth": [(CODES.astype(np.uint16), "RGB")],
    "array_out_of_range": [(CODES / 1.0, "RGB"), (EXACT - np.float32(0.1), "RGB"), (np.full((2, 2), np.inf), None)],
    "array_holds_nan": [(np.full((2, 2), np.nan), None)],
    "pillow_mode": [(Image.new(mode, (4, 4)), None) for mode in ("P", "CMYK", "1", "F")],
    "pillow_order_stated": [(Image.fromarray(CODES), "BGR")],
}


@pytest.mark.parametrize(("code", "arrays"), REFUSED_ARRAYS.items())
def test_other_arrays_are_refused(code, arrays):
    assert {code_of(array, color_order=order) for array, order in arrays} == {code}


def test_a_bit_depth_that_the_array_does_not_have_and_arguments_of_another_kind_are_refused():
    for choice in ({"name": 5}, {"metadata": "Canon"}):
        with refused(CRFNetError, "argument_kind", name=next(iter(choice))):
            Photo.from_array(CODES, color_order="RGB", **choice)
    assert FileMetadata(make="a\0\ud800").has_camera  # texts that are no paths may hold anything
    assert code_of(CODES.astype(np.uint16) * 5, color_order="RGB", bit_depth=10) == "array_above_bit_depth"
    for bits in (10, 4, 7.5, "8", True):
        assert code_of(CODES, color_order="RGB", bit_depth=bits) == "array_bit_depth"


def test_the_constructor_checks_its_pixels():
    others = {"photo_pixels": [CODES, EXACT.astype(float), EXACT[..., 0], EXACT[:0], EXACT.tolist()]}
    others |= {"array_out_of_range": [255 * EXACT, EXACT - 1], "array_holds_nan": [np.full_like(EXACT, np.nan)]}
    for code, refused_pixels in others.items():
        for pixels in refused_pixels:
            assert refusal_of(PhotoError, Photo, pixels, 8, False, Path("a.png")).code == code


@pytest.mark.parametrize(("kind", "digits"), [(np.float32, "1.0000001"), (np.float64, "1.0000000000000002")])
def test_a_number_just_above_1_is_named_with_enough_digits(kind, digits):
    with pytest.raises(PhotoError) as caught:
        Photo.from_array(np.full((2, 2), np.nextafter(kind(1), kind(2))))
    assert digits in str(caught.value)
