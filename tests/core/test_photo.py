"""read_photo: exact code values from every format, and one clear line for everything else."""

import os
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet_core.errors import PhotoError
from crfnet_core.image_io import MAX_PIXELS, read_codes, read_photo
from tests.helpers.crafted_files import jpeg, png, png_chunk, tiff, with_jpeg_size
from tests.helpers.images import read_image, write_image

ROOT = Path(__file__).parents[2]
CODES8 = np.array([[[0, 1, 2], [127, 128, 129]], [[253, 254, 255], [10, 20, 30]]], np.uint8)
CODES16 = np.array([[[0, 1, 2], [32767, 32768, 32769]], [[65533, 65534, 65535], [100, 200, 300]]], np.uint16)


def widened(codes, bits):
    """Return codes of `bits` bits as OpenImageIO takes them: on the scale of 16 bits."""
    return np.round(np.asarray(codes) * (65535 / (2**bits - 1))).astype(np.uint16)


def refusal(path):
    """Return the message of the refusal of `path`, which must be one line that begins with the name."""
    with pytest.raises(PhotoError) as caught:
        read_photo(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert not oiio.geterror()
    return message.removeprefix(f"{path}: ")


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.webp", "a.dpx"])
def test_8_bit_codes_over_255(tmp_path, name):
    photo = read_photo(write_image(tmp_path / name, CODES8, Compression="lossless"))
    assert photo.pixels.dtype == np.float32
    assert photo.pixels.flags.c_contiguous
    assert photo.bit_depth == 8
    assert not photo.is_gray
    assert photo.path == tmp_path / name
    np.testing.assert_array_equal(photo.pixels, (CODES8 / 255).astype(np.float32))


def test_all_8_bit_codes_are_the_nearest_float(tmp_path):
    ramp = np.repeat(np.arange(256, dtype=np.uint8).reshape(16, 16, 1), 3, axis=2)
    pixels = read_photo(write_image(tmp_path / "a.png", ramp)).pixels
    np.testing.assert_array_equal(pixels[..., 0].ravel(), (np.arange(256) / 255).astype(np.float32))
    assert pixels.min() == 0
    assert pixels.max() == 1


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.dpx"])
def test_16_bit_codes_over_65535(tmp_path, name):
    photo = read_photo(write_image(tmp_path / name, CODES16))
    assert photo.bit_depth == 16
    np.testing.assert_array_equal(photo.pixels, (CODES16 / 65535).astype(np.float32))


@pytest.mark.parametrize(("name", "bits"), [("a.dpx", 10), ("a.dpx", 12), ("a.tif", 10), ("a.tif", 12)])
def test_10_and_12_bit_codes_over_their_own_largest(tmp_path, name, bits):
    side = 2 ** (bits // 2)
    codes = np.arange(2**bits).reshape(side, side, 1).repeat(3, axis=2)
    path = write_image(tmp_path / name, widened(codes, bits), oiio__BitsPerSample=bits)
    np.testing.assert_array_equal(read_codes(path).codes, codes)
    photo = read_photo(path)
    assert photo.bit_depth == bits
    np.testing.assert_array_equal(photo.pixels, (codes / (2**bits - 1)).astype(np.float32))


def test_jpeg_is_decoded_as_oiiotool_does(tmp_path):
    path = tmp_path / "a.jpg"
    jpeg(path)
    expected = read_image(path)
    photo = read_photo(str(path))
    assert (photo.pixels.shape, photo.bit_depth) == ((120, 160, 3), 8)
    np.testing.assert_allclose(photo.pixels, expected, rtol=0, atol=2e-7)


def test_no_profile_or_gamma_is_applied(tmp_path):
    rows = b"".join(b"\0" + bytes(row.ravel().tolist()) for row in CODES8)
    path = tmp_path / "a.png"
    path.write_bytes(png(2, 2, rows, chunks=png_chunk(b"gAMA", struct.pack(">I", 100000))))
    np.testing.assert_array_equal(read_codes(path).codes, CODES8)


def test_orientation_is_ignored(tmp_path):
    path = write_image(tmp_path / "a.tif", np.concatenate([CODES8, CODES8[:1]]), Orientation=6)
    np.testing.assert_array_equal(read_codes(path).codes[:2], CODES8)


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.jpg", "a.dpx"])
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


def test_opaque_webp_with_alpha_keeps_its_codes(tmp_path):
    opaque = np.concatenate([CODES8, np.full((2, 2, 1), 255, np.uint8)], axis=2)
    path = write_image(tmp_path / "a.webp", opaque, Compression="lossless", oiio__UnassociatedAlpha=1)
    np.testing.assert_array_equal(read_photo(path).pixels, (CODES8 / 255).astype(np.float32))


def test_associated_alpha_is_divided_out(tmp_path):
    stored = np.array([[[0, 0, 0, 0], [50, 100, 25, 100], [10, 20, 30, 255], [90, 0, 0, 80]]], np.uint8)
    photo = read_photo(write_image(tmp_path / "a.tif", stored))
    expected = [[[0, 0, 0], [0.5, 1, 0.25], [10 / 255, 20 / 255, 30 / 255], [1, 0, 0]]]
    np.testing.assert_allclose(photo.pixels, expected, rtol=1e-7)


def test_extra_channel_that_is_no_alpha_is_dropped(tmp_path):
    path = tmp_path / "a.tif"
    path.write_bytes(tiff(1, 1, samples=4, extra=((338, 3, 0),), content=bytes([10, 20, 30, 40])))
    assert read_codes(path).codes.tolist() == [[[10, 20, 30]]]
    assert read_codes(path).alpha is None


def test_gray_with_alpha(tmp_path):
    path = write_image(tmp_path / "a.png", np.array([[[9, 100], [8, 0]]], np.uint8), oiio__UnassociatedAlpha=1)
    values = read_codes(path)
    assert values.codes.tolist() == [[[9, 9, 9], [8, 8, 8]]]
    assert values.alpha.tolist() == [[100, 0]]


def test_first_of_several_frames(tmp_path):
    path = str(tmp_path / "a.tif")
    spec = oiio.ImageSpec(2, 2, 3, "uint8")
    output = oiio.ImageOutput.create(path)
    assert output.open(path, (spec, spec))
    assert output.write_image(CODES8)
    assert output.open(path, spec, "AppendSubimage")
    assert output.write_image(np.zeros_like(CODES8))
    output.close()
    np.testing.assert_array_equal(read_codes(path).codes, CODES8)


def test_one_pixel(tmp_path):
    assert read_photo(write_image(tmp_path / "a.png", CODES8[:1, :1])).pixels.shape == (1, 1, 3)


@pytest.mark.parametrize(("content", "name"), [("a.png", "b.jpg"), ("a.jpg", "b.png"), ("a.tif", "b")])
def test_the_content_counts_not_the_suffix(tmp_path, content, name):
    write_image(tmp_path / content, CODES8)
    expected = read_photo(tmp_path / content).pixels
    path = (tmp_path / content).rename(tmp_path / name)
    np.testing.assert_array_equal(read_photo(path).pixels, expected)


def test_ultra_hdr_gives_the_standard_image(tmp_path):
    hdr = np.linspace(0, 8, 64 * 64 * 3, dtype=np.float32).reshape(64, 64, 3).astype(np.float16)
    path = tmp_path / "a.jpg"
    write_image(path, hdr, jpeg__ultrahdr=1, oiio__ColorSpace="lin_rec709_scene")
    if str(oiio.ImageBuf(str(path)).spec().format) == "uint8":
        pytest.skip("this OpenImageIO has no Ultra HDR writer or reader")
    whole = path.read_bytes()
    plain = tmp_path / "plain.jpg"
    plain.write_bytes(whole[: whole.index(b"\xff\xd9", whole.index(b"\xff\xda")) + 2])
    photo = read_photo(path)
    assert (photo.bit_depth, photo.path) == (8, path)
    np.testing.assert_array_equal(photo.pixels, read_image(plain, kind="uint8") / np.float32(255))


def absent(path):
    pass


def folder(path):
    path.mkdir()


def empty(path):
    path.touch()


def text(path):
    path.write_text("hello\n" * 20)


def heic(path):
    path.write_bytes(b"\0\0\0\x18ftypheic" + bytes(100))


def wave(path):
    path.write_bytes(b"RIFF\0\0\0\0WAVEfmt ")


def float_tiff(path):
    path.write_bytes(tiff(2, 2, bits=32, kind=3, content=bytes(48)))


def half_tiff(path):
    path.write_bytes(tiff(2, 2, bits=16, kind=3, content=bytes(24)))


def exr(path):
    write_image(path, np.ones((2, 2, 3), np.float16))


def radiance(path):
    write_image(path, np.ones((2, 2, 3), np.float32))


def raw(path):
    path.write_bytes(tiff(2, 2, content=bytes(12)))


def mosaic(path):
    path.write_bytes(tiff(2, 2, samples=1, photometric=32803, content=bytes(4)))


def cmyk_tiff(path):
    path.write_bytes(tiff(2, 2, samples=4, photometric=5, content=bytes(16)))


def lab_tiff(path):
    path.write_bytes(tiff(2, 2, photometric=8, content=bytes(12)))


def signed_tiff(path):
    path.write_bytes(tiff(2, 2, kind=2, content=bytes(12)))


def long_tiff(path):
    path.write_bytes(tiff(2, 2, bits=32, content=bytes(48)))


def bilevel_tiff(path):
    path.write_bytes(tiff(8, 2, samples=1, photometric=1, bits=1, content=bytes(2)))


def cmyk_jpeg(path):
    path.write_bytes(FOUR_INKS)


def huge_jpeg(path):
    path.write_bytes(with_jpeg_size(jpeg(path), 50000, 50000))


def huge_progressive_jpeg(path):
    path.write_bytes(with_jpeg_size(jpeg(path, jpeg__progressive=1), 50000, 50000))


def huge_png(path):
    path.write_bytes(png(50000, 50000))


def huge_tiff(path):
    path.write_bytes(tiff(50000, 50000, content=bytes(100)))


def zero_png(path):
    path.write_bytes(png(0, 0))


def lying_png(path):
    path.write_bytes(png(2000, 2000))


def _four_inks():
    """Return an 8 x 8 CMYK JPEG: one DC symbol (no difference) and one end of block for each of four components."""
    table = b"\x01" + bytes(15) + b"\0"
    segments = [
        (0xDB, b"\0" + bytes([1] * 64)),
        (0xC0, struct.pack(">BHHB", 8, 8, 8, 4) + b"".join(bytes([n, 0x11, 0]) for n in (1, 2, 3, 4))),
        (0xC4, b"\x00" + table),
        (0xC4, b"\x10" + table),
        (0xDA, b"\x04" + b"".join(bytes([n, 0]) for n in (1, 2, 3, 4)) + b"\0\x3f\0"),
    ]
    parts = [b"\xff" + bytes([marker]) + struct.pack(">H", len(body) + 2) + body for marker, body in segments]
    return b"\xff\xd8" + b"".join(parts) + b"\0" + b"\xff\xd9"


FOUR_INKS = _four_inks()


@pytest.mark.parametrize(
    ("make", "name", "found", "advice"),
    [
        (absent, "a.jpg", "no such file", "check the name"),
        (folder, "a.jpg", "is a folder", "one photograph"),
        (empty, "a.jpg", "is empty", "copy it again"),
        (text, "a.jpg", "is no JPEG, PNG, TIFF, WebP or DPX", "save the photograph"),
        (heic, "a.heic", "is no JPEG, PNG, TIFF, WebP or DPX", "save the photograph"),
        (wave, "a.webp", "is no JPEG, PNG, TIFF, WebP or DPX", "save the photograph"),
        (exr, "a.exr", "OpenEXR holds scene-linear values", "give the JPEG"),
        (radiance, "a.hdr", "Radiance HDR holds scene-linear values", "give the JPEG"),
        (float_tiff, "a.tif", "float samples holds scene-linear values", "give the JPEG"),
        (half_tiff, "a.tif", "half samples holds scene-linear values", "give the JPEG"),
        (raw, "a.NEF", "camera raw", "developed from it"),
        (mosaic, "a.tif", "camera raw", "developed from it"),
        (cmyk_tiff, "a.tif", "holds CMYK", "give the RGB"),
        (cmyk_jpeg, "a.jpg", "holds CMYK", "give the RGB"),
        (lab_tiff, "a.tif", "holds CIE L*a*b*", "give the RGB"),
        (signed_tiff, "a.tif", "8-bit int8 samples", "convert it"),
        (long_tiff, "a.tif", "32-bit uint samples", "convert it"),
        (bilevel_tiff, "a.tif", "1-bit uint8 samples", "convert it"),
        (huge_jpeg, "a.jpg", "claims 50000 x 50000 pixels; at most 250 megapixels", "crop it"),
        (huge_progressive_jpeg, "a.jpg", "claims 50000 x 50000 pixels; at most 250 megapixels", "crop it"),
        (huge_png, "a.png", "claims", ""),
        (huge_tiff, "a.tif", "claims", ""),
        (zero_png, "a.png", "damaged or cut short", "copy it again"),
        (lying_png, "a.png", "damaged or cut short", "copy it again"),
    ],
)
def test_refusal_names_what_was_found_and_what_to_do(tmp_path, make, name, found, advice):
    make(tmp_path / name)
    message = refusal(tmp_path / name)
    assert found in message
    assert advice in message


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_does_not_block(tmp_path):
    os.mkfifo(tmp_path / "a.jpg")
    assert "no such file" in refusal(tmp_path / "a.jpg")


@pytest.mark.parametrize("progressive", [0, 1])
@pytest.mark.parametrize("share", [0.0005, 0.05, 0.3, 0.6, 0.99, 1.0])
def test_cut_jpeg_is_refused_wherever_it_is_cut(tmp_path, progressive, share):
    path = tmp_path / "a.jpg"
    whole = jpeg(path, jpeg__progressive=progressive)
    assert read_photo(path).pixels.shape == (120, 160, 3)
    path.write_bytes(whole[: max(4, int(len(whole) * share) - 2)])
    assert "damaged or cut short" in refusal(path)


def test_jpeg_of_a_failed_download_is_refused(tmp_path):
    whole = jpeg(tmp_path / "a.jpg")
    (tmp_path / "a.jpg").write_bytes(whole[: len(whole) // 2] + bytes(len(whole) // 2))
    assert "damaged or cut short" in refusal(tmp_path / "a.jpg")


def test_what_follows_a_jpeg_is_ignored(tmp_path):
    path = tmp_path / "a.jpg"
    whole = jpeg(path)
    expected = read_photo(path).pixels
    path.write_bytes(whole + bytes(5000))
    np.testing.assert_array_equal(read_photo(path).pixels, expected)


@pytest.mark.parametrize("share", [0.3, 0.8, 0.95])
@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.webp", "a.dpx"])
def test_other_cut_files_are_refused(tmp_path, name, share):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    whole = write_image(tmp_path / name, noise, Compression="lossless" if name == "a.webp" else "none").read_bytes()
    (tmp_path / name).write_bytes(whole[: int(len(whole) * share)])
    assert "damaged or cut short" in refusal(tmp_path / name)


def test_sparse_file_above_the_limit(tmp_path):
    path = tmp_path / "a.tif"
    header = tiff(50000, 50000, samples=1, photometric=1)
    path.write_bytes(header)
    os.truncate(path, 50000 * 50000 + len(header))
    assert "claims 50000 x 50000 pixels" in refusal(path)
    assert 200e6 < MAX_PIXELS < 2500e6


BOMBS = [huge_jpeg, huge_progressive_jpeg, huge_png, huge_tiff]


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak memory as Linux reports it")
def test_bombs_take_little_memory(tmp_path):
    names = [str(tmp_path / make.__name__) for make in BOMBS]
    for make, name in zip(BOMBS, names, strict=True):
        made = tmp_path / ("made.jpg" if "jpeg" in name else "made")
        make(made)
        made.rename(name)
    code = (
        "import resource, sys\n"
        "from crfnet_core.image_io import read_photo\n"
        "from crfnet_core.errors import PhotoError\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "for name in sys.argv[1:]:\n"
        "    try:\n        read_photo(name)\n        sys.exit('was read')\n"
        "    except PhotoError:\n        pass\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)\n"
    )
    run = subprocess.run([sys.executable, "-c", code, *names], cwd=ROOT, capture_output=True, text=True, timeout=30)
    assert run.returncode == 0, run.stderr
    assert int(run.stdout) < 50_000, "kB beyond what the imports take"


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak memory as Linux reports it")
def test_memory_is_the_codes_and_the_floats(tmp_path):
    path = write_image(tmp_path / "a.png", np.zeros((3000, 4000, 3), np.uint8))
    code = (
        "import resource, sys\n"
        "from crfnet_core.image_io import read_photo\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "read_photo(sys.argv[1])\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)\n"
    )
    run = subprocess.run([sys.executable, "-c", code, path], cwd=ROOT, capture_output=True, text=True, timeout=30)
    assert run.returncode == 0, run.stderr
    needed = 12e6 * 3 * (1 + 4) / 1024
    assert int(run.stdout) < 1.3 * needed, "kB"


def test_unreadable_file(tmp_path, monkeypatch):
    path = write_image(tmp_path / "a.png", CODES8)

    def refused(*arguments, **options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    assert refusal(path) == "cannot be opened (Permission denied); check its name and permissions"


def test_names_that_no_system_takes(tmp_path):
    assert "File name too long" in refusal(tmp_path / ("x" * 300))
    assert "no such file" in refusal(tmp_path / "a\0.jpg")


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux stores names as bytes")
def test_name_that_is_not_utf8(tmp_path):
    path = os.fsencode(tmp_path) + b"/\xff.png"
    Path(os.fsdecode(path)).write_bytes(png(1, 1, bytes(4)))
    with pytest.raises(PhotoError, match=r"^'.*udcff.png': the name is not UTF-8; rename"):
        read_photo(os.fsdecode(path))


@pytest.mark.parametrize("path", [None, 3, b"a.png", CODES8])
def test_argument_that_is_no_path(path):
    with pytest.raises(TypeError):
        read_photo(path)


def test_photo_is_frozen(tmp_path):
    photo = read_photo(write_image(tmp_path / "a.png", CODES8))
    with pytest.raises(AttributeError):
        photo.bit_depth = 16


def test_reading_twice_gives_the_same(tmp_path):
    path = write_image(tmp_path / "a.png", CODES8)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        np.testing.assert_array_equal(read_photo(path).pixels, read_photo(path).pixels)
