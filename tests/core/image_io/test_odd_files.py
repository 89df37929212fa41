"""Files that decoders often get wrong."""

import io
import struct
from contextlib import nullcontext

import numpy as np
import pytest
from PIL import Image

from crfnet.plates.exr import linear_header
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_metadata, read_photo
from tests.helpers.colored_ramp import colored_ramp
from tests.helpers.crafted_files import bmp, jpeg, tiff, with_jpeg_segment, xmp_packet
from tests.helpers.folders import changed, written
from tests.helpers.images import write_image
from tests.helpers.refusals import refusal_of, refused


@pytest.mark.parametrize("bits", [8, 16])
def test_white_is_zero_but_alpha_is_not_inverted(tmp_path, bits):
    codes = np.array([[[0, 1], [2, 3]], [[2 ** (bits - 1), 5], [2**bits - 1, 6]]], f"<u{bits // 8}")
    more = {"extra": ((338, 3, 2),), "content": codes.tobytes()}
    values = read_codes(written(tmp_path / "a.tif", tiff(2, 2, samples=2, photometric=0, bits=bits, **more)))
    np.testing.assert_array_equal(values.codes[..., 0], 2**bits - 1 - codes[..., 0].astype(int))
    np.testing.assert_array_equal(values.alpha, codes[..., 1])


@pytest.mark.parametrize("bits", [10, 12, 14])
def test_packed_codes_of_tiff_keep_their_bits(tmp_path, bits):
    codes = np.array([0, 1, 777, 2 ** (bits - 1), 2**bits - 2, 2**bits - 1, 5, 6])
    packed = int("".join(f"{code:0{bits}b}" for code in codes), 2).to_bytes(bits)
    content = tiff(8, 1, samples=1, photometric=1, bits=bits, content=packed)
    values = read_codes(written(tmp_path / "a.tif", content))
    assert (values.bit_depth, values.codes[0, :, 0].tolist()) == (bits, codes.tolist())


@pytest.mark.parametrize(("photometric", "colors"), [(2, [0, 1, 2]), (1, [0, 0, 0])])
def test_channels_of_unknown_use_are_neither_colors_nor_alpha(tmp_path, photometric, colors):
    codes = np.arange(20, dtype=np.uint8).reshape(2, 2, 5)
    content = tiff(2, 2, samples=5, photometric=photometric, content=codes.tobytes())
    values = read_codes(written(tmp_path / "a.tif", content))
    assert values.alpha is None
    np.testing.assert_array_equal(values.codes, codes[..., colors])


@pytest.mark.parametrize("form", [struct.Struct("<HHI"), struct.Struct("<HHQ")])
def test_the_last_of_two_more_channels_may_be_alpha_by_which_colors_are_multiplied(tmp_path, form):
    more = {"extra": ((338, 3, 1 << 16),), "content": bytes((50, 60, 70, 7, 128) * 4), "is_big": form.size > 8}
    content = tiff(2, 2, samples=5, **more).replace(form.pack(338, 3, 1), form.pack(338, 3, 2))
    values = read_codes(written(tmp_path / "a.tif", content))
    assert (values.is_associated, set(values.alpha.flat)) == (True, {128})
    np.testing.assert_allclose(values.pixels()[0, 0], np.array([50, 60, 70]) / 128, atol=1e-6)


@pytest.mark.parametrize(("color", "is_associated"), [(120, True), (200, False)])
def test_colors_of_dpx_are_multiplied_by_alpha_unless_they_are_above_it(tmp_path, color, is_associated):
    """Its header does not state it."""
    codes = np.full((16, 16, 4), (color, color, color, 128), np.uint8)
    values = read_codes(write_image(tmp_path / "a.dpx", codes))
    np.testing.assert_allclose(values.pixels(), color / (128 if is_associated else 255), atol=1e-6)


@pytest.mark.parametrize("widths", [(8, 16), (8, 8, 16), (16, 8), (16, 8, 16)])
def test_the_first_of_the_largest_pages_is_read(tmp_path, widths):
    """Thumbnails are often not marked as reduced pictures."""
    first, *more = (np.full((8, width, 3), 100 + place, np.uint8) for place, width in enumerate(widths))
    path = write_image(tmp_path / "a.tif", first)
    with Image.open(path) as file:
        file.save(path, save_all=True, append_images=[Image.fromarray(page) for page in more])
    np.testing.assert_array_equal(read_codes(path).codes, np.full((8, 16, 3), 100 + widths.index(16)))
    assert read_metadata(path).width == 16


def test_planes_apart_in_one_long_strip(tmp_path):
    codes = np.random.default_rng(0).integers(0, 256, (600, 16, 3), np.uint8)
    path = write_image(tmp_path / "a.tif", codes, planarconfig="separate", compression="lzw", tiff__RowsPerStrip=600)
    np.testing.assert_array_equal(read_codes(path).codes, codes)


@pytest.mark.parametrize("masks", [(0xFF0000, 0xFF00, 0xFF), (0xFF000000, 0xFF0000, 0xFF00)])
def test_masks_of_bmp(tmp_path, masks):
    codes = np.arange(12, dtype=np.uint32).reshape(2, 2, 3) * 20
    shifts = [(mask & -mask).bit_length() - 1 for mask in masks]
    pixels = sum(codes[..., channel] << shift for channel, shift in enumerate(shifts))
    content = bmp(2, -2, pixels.astype("<u4").tobytes(), bits=32, coding=3, fields=struct.pack("<3I", *masks))
    np.testing.assert_array_equal(read_codes(written(tmp_path / "a.bmp", content)).codes, codes)


@pytest.mark.parametrize("size", [40, 108])
def test_bmp_of_runs(tmp_path, size):
    """The runs of gray picture of 4 x 2 pixels, bottom up."""
    palette = b"".join(bytes([code, code, code, 0]) for code in range(256))
    runs = bytes([3, 9, 1, 8, 0, 0, 4, 7, 0, 0, 0, 1])
    path = written(tmp_path / "a.bmp", bmp(4, 2, runs, bits=8, coding=1, size=size, palette=palette))
    assert read_codes(path).codes[..., 0].tolist() == [[7, 7, 7, 7], [9, 9, 9, 8]]


@pytest.mark.parametrize("name", ["a.bmp", "a.jxl", "a.webp"])
def test_alpha_that_is_straight_by_the_format(tmp_path, name):
    codes = np.random.default_rng(0).integers(0, 256, (32, 32, 4), np.uint8)
    masks = struct.pack("<4I", 0xFF0000, 0xFF00, 0xFF, 0xFF000000)
    content = bmp(32, -32, codes[..., [2, 1, 0, 3]].tobytes(), bits=32, coding=3, size=108, fields=masks)
    written(tmp_path / "a.bmp", content)
    write_image(tmp_path / "a.jxl", codes, compression="jpegxl:100")
    Image.fromarray(codes).save(tmp_path / "a.webp", lossless=True, exact=True)
    values = read_codes(tmp_path / name)
    np.testing.assert_array_equal(values.alpha, codes[..., 3])
    np.testing.assert_allclose(values.pixels(), codes[..., :3] / 255, atol=1e-6)
    assert not values.is_associated


def test_the_first_frame_of_a_webp_file_may_be_a_part_of_the_picture(tmp_path):
    """OpenImageIO leaves the rest as the memory is."""
    first, second = (Image.new("RGBA", (64, 48), color) for color in ((0, 0, 0, 0), (50, 60, 70, 128)))
    first.paste((1, 2, 3, 255), (4, 4, 20, 20))
    first.save(tmp_path / "a.webp", save_all=True, append_images=[second], lossless=True)
    values = read_codes(tmp_path / "a.webp")
    np.testing.assert_array_equal(np.dstack([values.codes, values.alpha]), np.asarray(first))


def test_a_bmp_of_other_grays_has_a_palette(tmp_path):
    image = Image.fromarray(np.arange(256, dtype=np.uint8).reshape(16, 16)).convert("P")
    image.putpalette(bytes(255 - code // 3 for code in range(768)))
    image.save(tmp_path / "a.bmp")
    assert refusal_of(PhotoError, read_codes, tmp_path / "a.bmp").code == "palette"


@pytest.mark.parametrize(
    ("channels", "changes"),
    [
        *((3, {768: b"\5"}), (3, {770: b"\3", 800: b"\1"}), (4, {800: b"\x33"})),
        *((3, {800: bytes([descriptor])}) for descriptor in (0, 6, 53, 100, 151)),
        *((3, {808: place}) for place in (bytes(4), b"\xff" * 4)),
    ],
)
def test_dpx_that_openimageio_misreads_is_refused(tmp_path, channels, changes):
    """Lines from top to bottom, planes apart, lines of 10 bits (6, 51) that end within a word, no place of pixels."""
    path = write_image(tmp_path / "a.dpx", np.zeros((16, 25, channels), np.uint16), oiio__BitsPerSample=10)
    content = bytearray(path.read_bytes())
    for place, field in changes.items():
        content[place : place + len(field)] = field
    path.write_bytes(content)
    assert refusal_of(PhotoError, read_codes, path).code == "coding_not_read"


@pytest.mark.parametrize(("name", "descriptor"), [("Y", 6), ("R", 1), ("G", 2), ("B", 3)])
def test_dpx_of_one_channel_is_gray_also_if_it_has_the_name_of_a_color(tmp_path, name, descriptor):
    codes = np.arange(16 * 24, dtype=np.uint16).reshape(16, 24, 1)
    path = write_image(tmp_path / "a.dpx", codes << 6 | codes >> 4, names=name, oiio__BitsPerSample=10)
    assert path.read_bytes()[800] == descriptor
    np.testing.assert_array_equal(read_codes(path).codes, np.broadcast_to(codes, (16, 24, 3)))


def test_dpx_with_padded_lines_that_its_header_does_not_name_is_refused(tmp_path):
    """FFmpeg writes them, and OpenImageIO shears the picture."""
    codes = np.random.default_rng(0).integers(0, 256, (6, 5, 3), np.uint8)
    path = write_image(tmp_path / "a.dpx", codes)
    np.testing.assert_array_equal(read_codes(path).codes, codes)
    lines = b"".join(line.tobytes() + b"\0" for line in codes)
    written(path, path.read_bytes()[: -codes.size] + lines)
    assert refusal_of(PhotoError, read_codes, path).code == "coding_not_read"


def test_xmp_does_not_change_the_bits(tmp_path):
    """OpenImageIO hands properties of any namespace on under their own names."""
    whole, path = jpeg(tmp_path / "a.jpg"), tmp_path / "a.jpg"
    expected = read_codes(path).codes
    xmp = xmp_packet(b'xmlns:oiio="oiio" oiio:BitsPerSample="10" xmlns:png="png" png:palette="1"')
    values = read_codes(written(path, with_jpeg_segment(whole, 0xE1, b"http://ns.adobe.com/xap/1.0/\0" + xmp)))
    assert values.bit_depth == 8
    np.testing.assert_array_equal(values.codes, expected)


def test_stray_bytes_between_segments_of_a_jpeg(tmp_path):
    whole, path = jpeg(tmp_path / "a.jpg"), tmp_path / "a.jpg"
    expected = read_codes(path).codes
    for stray in (b"\0\0", b"\0\1\2", b"\xff\0\7"):
        content = whole.replace(b"\xff\xdb", stray + b"\xff\xdb", 1)
        np.testing.assert_array_equal(read_codes(written(path, content)).codes, expected)


def test_a_jpeg_of_hundreds_of_scans_is_refused_before_decoding(tmp_path):
    """Each takes as long as the whole picture, however short it is."""
    file = io.BytesIO()
    Image.new("RGB", (64, 64), (200, 100, 50)).save(file, "JPEG", progressive=True, restart_marker_blocks=4)
    begin, path = (whole := file.getvalue()).rindex(b"\xff\xda"), tmp_path / "a.jpg"
    for more, is_read in ((400, True), (500, False)):
        path.write_bytes(whole[:begin] + whole[begin:-2] * more + whole[-2:] + b"\xff\xda\0\2" * 500)
        with nullcontext() if is_read else refused(PhotoError, "coding_not_read", problem="more than 500 scans"):
            read_metadata(path)


def test_a_later_jfif(tmp_path):
    jpeg(path := tmp_path / "a.jpg")
    assert read_codes(changed(path, b"JFIF\0\1", b"JFIF\0\2")).metadata.has_jfif
    adobe = changed(path, b"JFIF", b"none").read_bytes()  # else its number of a transform does not count
    written(path, with_jpeg_segment(adobe, 0xEE, b"Adobe\0\x64\0\0\0\0\7"))
    assert read_codes(path).metadata.has_adobe


def test_names_that_are_not_utf8(tmp_path):
    """Control characters become question marks, too, and a long text is cut."""
    exif = Image.Exif()
    exif[0x010F], exif[0x0110], exif[0x0131] = "Voigtl_nder", "EOS\n\x1b[2J20D", "x" * 1000
    Image.new("RGB", (16, 16)).save(tmp_path / "a.jpg", exif=exif)
    values = read_codes(changed(tmp_path / "a.jpg", b"l_n", b"l\xe4n"))
    assert (values.metadata.make, values.metadata.model) == ("Voigtl?nder", "EOS ?[2J20D")
    assert len(values.metadata.software) == 200
    header = linear_header(values.header, channels=3, depth="half", attributes={})
    assert header.getattribute("Make") == "Voigtl?nder"
    assert all(value.value.isprintable() for value in values.header.extra_attribs if isinstance(value.value, str))


@pytest.mark.parametrize("name", ["a.gif", "a.png", "a.tif", "a.bmp"])
def test_palettes_are_refused_alike(tmp_path, name):
    Image.fromarray(colored_ramp(8).astype(np.uint8)).quantize(16).save(tmp_path / name)
    for read in (read_photo, read_metadata):
        assert refusal_of(PhotoError, read, tmp_path / name).code == "palette"


@pytest.mark.parametrize("extra", [((254, 4, 0), (330, 4, 8)), ((254, 4, 2),), ()])
def test_other_tiff_files_are_no_raw(tmp_path, extra):
    path = written(tmp_path / "a.tif", tiff(2, 2, extra=extra, content=bytes(range(12))))
    assert read_codes(path).codes.ravel().tolist() == list(range(12))


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
    assert read_photo(written(path, with_jpeg_segment(content, marker, payload))).metadata.has_gain_map
