"""What read_photo refuses, each in one clear line and with little memory."""

import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import MAX_PIXELS, read_photo
from tests.helpers.crafted_files import jpeg, png, tiff, with_jpeg_size
from tests.helpers.images import write_image

ROOT = Path(__file__).parents[2]


def refusal(path):
    """Return the message of the refusal of `path`, which must be one line that begins with the name."""
    with pytest.raises(PhotoError) as caught:
        read_photo(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    assert not oiio.geterror()
    return message.removeprefix(f"{path}: ")


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


def exotic_tiff(path):
    scheme = struct.pack("<HHII", 259, 3, 1, 1)
    path.write_bytes(tiff(2, 2, content=bytes(12)).replace(scheme, struct.pack("<HHII", 259, 3, 1, 34926)))


def plain_jpeg(path):
    jpeg(path.with_suffix(".jpg"))
    path.with_suffix(".jpg").rename(path)


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
        (folder, "a.jpg", "is a folder", "give a photograph in it"),
        (empty, "a.jpg", "is empty", "copy it again"),
        (text, "a.jpg", "is no JPEG, HEIC, PNG, TIFF, WebP,", "save the photograph"),
        (heic, "a.heic", "HEIC file is damaged or cut short", "copy it again"),
        (wave, "a.webp", "is no JPEG, HEIC, PNG, TIFF, WebP,", "save the photograph"),
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
        (exotic_tiff, "a.tif", "has a compression that is not read", "save it with another"),
        (plain_jpeg, "a.null", "reads no file of the suffix .null", "rename it"),
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
@pytest.mark.parametrize("fraction", [0.0005, 0.05, 0.3, 0.6, 0.99, 1.0])
def test_cut_jpeg_is_refused_wherever_it_is_cut(tmp_path, progressive, fraction):
    path = tmp_path / "a.jpg"
    whole = jpeg(path, jpeg__progressive=progressive)
    assert read_photo(path).pixels.shape == (120, 160, 3)
    path.write_bytes(whole[: max(4, int(len(whole) * fraction) - 2)])
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


@pytest.mark.parametrize("fraction", [0.3, 0.8, 0.95])
@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.webp", "a.dpx"])
def test_other_cut_files_are_refused(tmp_path, name, fraction):
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    whole = write_image(tmp_path / name, noise, Compression="lossless" if name == "a.webp" else "none").read_bytes()
    (tmp_path / name).write_bytes(whole[: int(len(whole) * fraction)])
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
        "from crfnet_core.photograph.image_io import read_photo\n"
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


def test_unreadable_file(tmp_path, monkeypatch):
    path = write_image(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))

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
