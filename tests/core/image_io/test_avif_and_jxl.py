import struct

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image, ImageCms

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_metadata
from crfnet_core.photograph.image_io.iso_boxes import boxes
from crfnet_core.photograph.image_io.jxl_files import JxlHeader, with_jxl_boxes
from crfnet_core.photograph.metadata.origin import file_origin
from tests.helpers.colored_ramp import colored_ramp
from tests.helpers.crafted_files import box, xmp_packet
from tests.helpers.folders import written
from tests.helpers.images import write_image
from tests.helpers.refusals import refusal_of, refused

NO_CAMERA = "the file names no camera"


def test_xmp_does_not_turn_avif(tmp_path):
    """In AVIF only its own boxes turn the picture (MIAF), and Pillow writes them from EXIF."""
    xmp = xmp_packet(b'xmlns:tiff="http://ns.adobe.com/tiff/1.0/" tiff:Orientation="3"')
    codes = colored_ramp(8)
    Image.fromarray(codes).save(tmp_path / "a.avif", quality=100, subsampling="4:4:4", xmp=xmp)
    with Image.open(tmp_path / "a.avif") as file:
        assert file.getexif()[0x0112] == 3, "Pillow by itself would turn it"
    assert np.abs(read_codes(tmp_path / "a.avif").codes.astype(int) - codes).max() <= 3


def deep_avif(path, codes, color_range, bits=10):
    """Write codes as AVIF of 4:2:0 in limited (1) or full range (2) of BT.709."""
    av = pytest.importorskip("av", reason="AVIF of more than 8 bits needs PyAV")
    if "libsvtav1" not in av.codecs_available:
        pytest.skip("needs libsvtav1")
    form = "yuv420p" if bits == 8 else "yuv420p10le"
    picture = av.VideoFrame.from_ndarray(codes.astype(np.uint16) << 16 - bits, format="rgb48le")
    frame = picture.reformat(format=form, dst_colorspace=1, dst_color_range=color_range)
    with av.open(str(path), "w", format="avif") as container:
        stream = container.add_stream("libsvtav1", rate=1, options={"crf": "8"})
        stream.width, stream.height, stream.pix_fmt = frame.width, frame.height, form
        stream.codec_context.color_range, stream.codec_context.colorspace = color_range, 1
        container.mux([*stream.encode(frame), *stream.encode()])


@pytest.mark.parametrize("bits", [8, 10])
@pytest.mark.parametrize("color_range", [1, 2])
def test_avif_with_odd_width_in_limited_and_full_range(tmp_path, color_range, bits):
    """Of 8 bits in limited range, Pillow's blue is 4 codes off here."""
    x, y = np.meshgrid(np.arange(131), np.arange(98))
    codes = np.dstack([x * 7, y * 5, 900 - x * 6]) >> 10 - bits
    deep_avif(tmp_path / "a.avif", codes, color_range, bits)
    values = read_codes(tmp_path / "a.avif")
    assert (values.codes.shape, values.bit_depth) == ((98, 131, 3), bits)
    assert np.abs(values.codes.astype(int) - codes).mean(axis=(0, 1)).max() < 8 * 2**bits / 1024


def test_the_range_of_the_box_overrides_the_stream(tmp_path):
    codes = np.tile(np.linspace(0, 1023, 128).round()[None, :, None], (96, 1, 3))
    deep_avif(tmp_path / "a.avif", codes, 1)
    content = (tmp_path / "a.avif").read_bytes()
    at = content.index(b"colrnclx") + 14
    written(tmp_path / "b.avif", content[:at] + b"\x80" + content[at + 1 :])
    limited, full = (read_codes(tmp_path / name).codes.astype(int) for name in ("a.avif", "b.avif"))
    assert np.abs(limited - codes).mean() < 4
    assert np.abs(full - (64 + codes * 876 / 1023)).mean() < 4


def with_item_before(content, other):
    """Return the content of an AVIF with the item of another before its own, which stays the main one."""
    pictures = [dict(boxes(each))[b"mdat"] for each in (other, content)]
    meta = dict(boxes(dict(boxes(content))[b"meta"][4:]))
    owned = dict(boxes(meta[b"iprp"]))
    owners = bytes(7) + b"\2" + b"".join(item + owned[b"ipma"][10:] for item in (b"\0\1", b"\0\2"))
    entries = b"".join(box(b"infe", b"\2\0\0\0" + item + b"\0\0av01\0") for item in (b"\0\1", b"\0\2"))
    rest = box(b"hdlr", meta[b"hdlr"]) + box(b"pitm", b"\0\0\0\0\0\2") + box(b"iinf", b"\0\0\0\0\0\2" + entries)
    rest += box(b"iprp", box(b"ipco", owned[b"ipco"]), box(b"ipma", owners))

    def before(place):
        first, second = map(len, pictures)
        iloc = struct.pack(">I5H2I3H2I", 0, 0x4400, 2, 1, 0, 1, place, first, 2, 0, 1, place + first, second)
        return box(b"ftyp", b"avif\0\0\0\0avifmif1miaf") + box(b"meta", bytes(4), rest, box(b"iloc", iloc))

    return before(len(before(0)) + 8) + box(b"mdat", *pictures)


def test_the_main_item_of_deep_avif_may_come_later(tmp_path):
    codes = np.tile(np.linspace(0, 1023, 128).round()[None, :, None], (96, 1, 3))
    for name, picture in (("main.avif", codes), ("other.avif", codes[:, ::-1])):
        deep_avif(tmp_path / name, picture, 2)
    main, other = ((tmp_path / name).read_bytes() for name in ("main.avif", "other.avif"))
    path = written(tmp_path / "both.avif", with_item_before(main, other))
    np.testing.assert_array_equal(read_codes(path).codes, read_codes(tmp_path / "main.avif").codes)


@pytest.mark.parametrize("name", ["alpha10.avif", "cropped8.avif"])
def test_avif_that_no_decoder_reads_in_full_is_refused(root, name):
    """PyAV leaves out alpha, by which the colors may be multiplied; Pillow and PyAV do not crop."""
    assert refusal_of(PhotoError, read_codes, root / "tests" / "data" / "heif" / name).code == "coding_not_read"


@pytest.mark.parametrize("quality", [90, 100])
def test_lossy_jpeg_xl_with_a_profile_of_its_own_is_refused(tmp_path, quality):
    """OpenImageIO would return linear light."""
    srgb = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    curve = struct.pack(">i", round(2.4 * 65536))
    assert curve in srgb
    profile = np.frombuffer(srgb.replace(curve, struct.pack(">i", round(1.7 * 65536))), np.uint8)
    attributes = {"compression": f"jpegxl:{quality}", "ICCProfile": (oiio.TypeDesc(f"uint8[{profile.size}]"), profile)}
    path = write_image(tmp_path / "a.jxl", colored_ramp(8), **attributes)
    if quality == 100:
        np.testing.assert_array_equal(read_codes(path).codes, colored_ramp(8))
        return
    for read in (read_codes, read_metadata):
        assert refusal_of(PhotoError, read, path).code == "jxl_linear"


@pytest.mark.parametrize(("box", "words"), [(b"brob", "its EXIF is compressed and was not read"), (b"skip", NO_CAMERA)])
def test_compressed_exif_of_jpeg_xl_is_said_not_to_be_read(tmp_path, box, words):
    content = write_image(tmp_path / "a.jxl", colored_ramp(8), compression="jpegxl:100").read_bytes()
    assert content.count(b"brobExif") == 1, "OpenImageIO compresses it, as cjxl does"
    (tmp_path / "a.jxl").write_bytes(content.replace(b"brobExif", box + b"Exif"))
    origin = file_origin(read_metadata(tmp_path / "a.jxl"))
    assert (origin.words[0], origin.is_scaled) == (words, True if words == NO_CAMERA else None)


def test_exif_and_xmp_of_jpeg_xl_are_read_and_do_not_turn_it(tmp_path):
    codes, exif = colored_ramp(8), Image.Exif()
    exif[0x010F], exif[0x0112] = "Maker", 6
    xmp = xmp_packet(b'xmlns:xmp="http://ns.adobe.com/xap/1.0/" xmp:CreatorTool="Adobe Photoshop 25.0"')
    content = write_image(tmp_path / "a.jxl", codes, compression="jpegxl:100").read_bytes()
    added = box(b"Exif", bytes(4), exif.tobytes()) + box(b"xml ", xmp)
    at = content.index(b"jxlp") - 4
    values = read_codes(written(tmp_path / "a.jxl", content[:at] + added + content[at:]))
    np.testing.assert_array_equal(values.codes, codes)
    assert (values.metadata.make, values.metadata.software) == ("Maker", "Adobe Photoshop 25.0")
    assert values.header.get_int_attribute("Orientation") == 1


def test_lossy_gray_jpeg_xl_is_refused_as_linear_light(tmp_path):
    header = oiio.ImageSpec(8, 8, 1, oiio.UINT8)
    header.attribute("ICCProfile:profile_description", "Gra_D65_Rel_Lin")
    assert refusal_of(PhotoError, with_jxl_boxes, header, tmp_path, JxlHeader()).code == "jxl_linear"


def test_lossless_jpeg_xl_tagged_linear_keeps_its_codes_and_its_tag(tmp_path):
    content = "ff0a18401050b40808020100a8004b12c582852452d2f3273b13527c6f09760036999979f8f3e7441e5d23efa3b3c97cde05170"
    values = read_codes(written(tmp_path / "a.jxl", bytes.fromhex(content.ljust(256, "0"))))
    np.testing.assert_array_equal(values.codes, np.arange(72).reshape(4, 6, 3) * 3 + 7)
    assert values.metadata.color.transfer == "linear"


@pytest.mark.parametrize("head", [b"", b"\0\0\0\x0cJXL \r\n\x87\n" + struct.pack(">I4sI", 100, b"jxlp", 0)])
@pytest.mark.parametrize(("place", "problem"), [(15, "a preview"), (16, "an animation")])
def test_an_animation_of_jpeg_xl_and_a_preview_are_refused(tmp_path, head, place, problem):
    """OpenImageIO would return the last frame. The bits: small sides, fields that are not the default, the problem."""
    fields = 1 | 3 << 1 | 1 << 6 | 1 << 10 | 1 << place
    path = written(tmp_path / "a.jxl", head + b"\xff\x0a" + fields.to_bytes(86, "little"))
    with refused(PhotoError, "coding_not_read", problem=problem):
        read_codes(path)


def test_jpeg_xl_of_10_bits_is_turned_upright_says_so_and_keeps_its_bits(tmp_path):
    content = "ff0a18400b0514970408020100c8004b12c5828524d640e436100841d5555007a02b140a85429f38e6828593a14796c542dd8f9c"
    values = read_codes(written(tmp_path / "a.jxl", bytes.fromhex((content + "da160a0d8d576802").ljust(256, "0"))))
    assert (values.bit_depth, values.metadata.is_turned) == (10, True)
    np.testing.assert_array_equal(values.codes, np.rot90(np.arange(72).reshape(4, 6, 3) * 14 + 7, -1))
