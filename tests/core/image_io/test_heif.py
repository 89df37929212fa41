import struct
import sys

import numpy as np
import pytest
from PIL import Image

from crfnet_core.colorimetry import DISPLAY_P3
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes, read_photo
from tests.helpers.colored_ramp import colored_ramp
from tests.helpers.crafted_files import box
from tests.helpers.folders import changed, written
from tests.helpers.refusals import refusal_of, refused

#: The largest difference in codes: lossless RGB is exact; a matrix rounds twice, and limited range has fewer codes.
FILES = {"rgb8.heic": 0, "rgb10.heic": 0, "full8.heic": 1, "limited8.heic": 2, "limited10.heic": 2}


@pytest.fixture
def heif(root):
    """The folder of test files; make_heif.py there says how they were made."""
    return root / "tests" / "data" / "heif"


@pytest.mark.parametrize("name", FILES)
def test_heic_keeps_its_codes(heif, name):
    values = read_codes(heif / name)
    bits = 10 if "10" in name else 8
    assert (values.bit_depth, values.codes.dtype) == (bits, np.uint8 if bits == 8 else np.uint16)
    assert np.abs(values.codes.astype(int) - colored_ramp(bits)).max() <= FILES[name]


def test_a_phone_held_upright_gives_an_upright_picture_that_says_so_once(heif):
    values = read_codes(heif / "phone.heic")
    np.testing.assert_array_equal(values.codes, np.rot90(colored_ramp(8), -1))
    assert values.header.get_int_attribute("Orientation") == 1
    assert (values.header.width, values.header.height) == (48, 64)
    assert values.metadata.is_turned
    assert not read_photo(heif / "rgb8.heic").metadata.is_turned


def test_exif_and_icc_have_the_names_that_a_jpeg_gives_them(heif):
    values = read_codes(heif / "phone.heic")
    assert (values.metadata.make, values.metadata.model) == ("Apple", "iPhone 15")
    assert values.metadata.file_format == "HEIC"
    profile = bytes(values.header.getattribute("ICCProfile"))
    assert (profile[36:40], len(profile)) == (b"acsp", struct.unpack(">I", profile[:4])[0])


@pytest.mark.parametrize(("code", "name"), [(16, "PQ"), (18, "HLG"), (8, "linear"), (13, "")])
def test_the_transfer_that_cicp_names(heif, tmp_path, code, name):
    old, new = (b"nclx\0\x0c" + struct.pack(">H", each) for each in (13, code))
    color = read_codes(changed(heif / "rgb10.heic", old, new, to=tmp_path / "a.heic")).metadata.color
    assert (color.transfer, color.source) == (name, "CICP")
    assert color.primaries == DISPLAY_P3


def with_gain_map(content, mark):
    """Return a HEIC whose box `meta` lies at its end, so that offsets hold, and contains one more box with a mark."""
    at = content.index(b"meta")
    size = int.from_bytes(content[at - 4 : at])
    meta = box(content[at : at + 4], content[at + 4 : at - 4 + size], box(b"free", mark))
    return content[:at] + b"free" + content[at + 4 :] + meta


@pytest.mark.parametrize("mark", [b"tmap", b"urn:com:apple:photo:2020:aux:hdrgainmap"])
def test_a_gain_map_is_said_and_the_base_picture_read(heif, tmp_path, mark):
    content = (heif / "rgb8.heic").read_bytes()
    assert not read_photo(heif / "rgb8.heic").metadata.has_gain_map
    values = read_codes(written(tmp_path / "a.heic", with_gain_map(content, mark)))
    assert values.metadata.has_gain_map
    np.testing.assert_array_equal(values.codes, colored_ramp(8))


@pytest.mark.parametrize("limits", ["full", "limited"])
def test_avif_of_8_bits_is_read_by_pillow(tmp_path, limits):
    codes = colored_ramp(8)
    Image.fromarray(codes).save(tmp_path / "a.avif", quality=100, subsampling="4:4:4", range=limits)
    values = read_codes(tmp_path / "a.avif")
    assert (values.bit_depth, values.metadata.file_format) == (8, "AVIF")
    assert np.abs(values.codes.astype(int) - codes).max() <= 3
    assert values.header.getattribute("CICP")[3] == (limits == "full")


def test_alpha_of_avif_is_told_from_none(tmp_path):
    codes = colored_ramp(8)
    for name, samples in (("a.avif", codes), ("b.avif", np.dstack([codes, codes[..., :1]]))):
        Image.fromarray(samples).save(tmp_path / name, quality=100, subsampling="4:4:4")
    without, with_alpha = (read_codes(tmp_path / name) for name in ("a.avif", "b.avif"))
    assert without.alpha is None
    assert with_alpha.alpha is not None
    assert not with_alpha.is_associated


@pytest.mark.parametrize(
    ("name", "package", "code"),
    [("limited10.avif", "av", "deep_avif_package_missing"), ("rgb8.heic", "pi_heif", "heif_package_missing")],
)
def test_a_missing_package_is_named(heif, monkeypatch, name, package, code):
    monkeypatch.setitem(sys.modules, package, None)
    assert refusal_of(PhotoError, read_photo, heif / name).code == code


@pytest.mark.parametrize("name", ["rgb8.heic", "limited10.avif"])
@pytest.mark.parametrize("fraction", [0.02, 0.2, 0.6, 0.95])
def test_cut_files_are_refused(heif, tmp_path, name, fraction):
    if name.endswith("avif"):
        pytest.importorskip("av", reason="AVIF of more than 8 bits needs PyAV")
    content = (heif / name).read_bytes()
    path = written(tmp_path / name, content[: int(len(content) * fraction)])
    assert refusal_of(PhotoError, read_photo, path).code == "damaged"


def test_items_whose_type_is_no_text_are_refused(heif, tmp_path):
    """They would end the process in pi-heif 1.4."""
    rest = b"xif\0\0\0\0\x0epitm"
    path = changed(heif / "phone.heic", b"E" + rest, b"\xff" + rest, to=tmp_path / "a.heic")
    with refused(PhotoError, "damaged", problem="the type of an item is not text"):
        read_photo(path)


@pytest.mark.parametrize(
    ("name", "stored", "other"),
    [
        ("a.heic", b"hvc1", b"jpeg"),
        ("a.avif", b"av01", b"iden"),
        ("a.png", b"\0\0\0\rIHDR", b"\0\0\0\4CgBIP\0 \2+\xd5\xb3\x7f\0\0\0\rIHDR"),
    ],
)
def test_a_coding_that_the_decoder_lacks_is_not_called_damage(heif, tmp_path, name, stored, other):
    """HEIF of JPEG, AVIF with an item derived from others, PNG of Apple's Xcode."""
    content = (heif / "rgb8.heic").read_bytes()
    if name != "a.heic":
        Image.fromarray(colored_ramp(8)).save(tmp_path / name)
        content = (tmp_path / name).read_bytes()
    path = written(tmp_path / name, content.replace(stored, other, 1))
    assert refusal_of(PhotoError, read_photo, path).code == "coding_not_read"


def test_a_huge_size_is_refused_before_decoding(heif, monkeypatch):
    monkeypatch.setattr("crfnet_core.photograph.image_io.header_checks.MAX_PIXELS", 64 * 48 - 1)
    monkeypatch.setattr("crfnet_core.photograph.image_io.pillow_files._heic", None)
    assert refusal_of(PhotoError, read_photo, heif / "rgb8.heic").code == "too_many_pixels"


def test_exif_that_is_not_utf8_is_read(heif, tmp_path):
    path = changed(heif / "phone.heic", b"Apple\0", b"Appl\xe9\0", to=tmp_path / "a.heic")
    assert read_codes(path).metadata.make == "Appl?"


@pytest.mark.filterwarnings("error")
def test_damaged_exif_of_avif_warns_nobody(tmp_path):
    exif = Image.Exif()
    exif[0x010F] = "A maker's name"
    Image.fromarray(colored_ramp(8)).save(tmp_path / "a.avif", exif=exif)
    content = (tmp_path / "a.avif").read_bytes()
    at = content.index(b"\x0f\x01\x02\0") if b"\x0f\x01\x02\0" in content else content.index(b"\x01\x0f\0\x02")
    path = written(tmp_path / "a.avif", content[: at + 4] + b"\x7f" * 4 + content[at + 8 :])
    assert read_codes(path).metadata.make == ""
