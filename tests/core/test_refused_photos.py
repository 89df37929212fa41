import mmap
import os
import re
import struct
import sys
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet_core.errors import PhotoError, one_line
from crfnet_core.photograph.image_io import MAX_PIXELS, read_photo
from tests.helpers.crafted_files import jpeg, png, tiff, with_jpeg_size
from tests.helpers.folders import written
from tests.helpers.images import write_image
from tests.helpers.memory import memory_of_reading


def refusal(path):
    """Return the code of the refusal of `path`, whose sentence must be one line that begins with the name."""
    with pytest.raises(PhotoError) as caught:
        read_photo(path)
    message = str(caught.value)
    assert message.startswith(one_line(f"{path}: ".rstrip()))
    assert "\n" not in message
    assert " 0-bit" not in message
    assert not oiio.geterror()
    return caught.value.code


def with_compression(content, scheme):
    return content.replace(struct.pack("<HHII", 259, 3, 1, 1), struct.pack("<HHII", 259, 3, 1, scheme))


def four_inks():
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


HUGE = {"huge.png": png(50000, 50000), "huge.tif": tiff(50000, 50000, content=bytes(100))}

#: Files by content: name, content, and the code of the refusal.
FILES = [
    ("empty.jpg", b"", "photograph_is_empty"),
    ("text.jpg", b"hello\n" * 20, "not_an_image_file"),
    ("huge.webp", b"RIFF\xff\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0" + b"\x7f\x3e\0" * 2, "coding_not_read"),
    ("wave.webp", b"RIFF\0\0\0\0WAVEfmt ", "not_an_image_file"),
    ("cut.heic", b"\0\0\0\x18ftypheic" + bytes(100), "damaged"),
    *((f"{bits}.tif", tiff(2, 2, bits=bits, kind=3, content=bytes(48)), "scene_linear_file") for bits in (16, 32)),
    ("logluv.tif", with_compression(tiff(2, 2, photometric=32845, content=bytes(12)), 34676), "scene_linear_file"),
    ("named.NEF", tiff(2, 2, content=bytes(12)), "camera_raw"),
    ("mosaic.tif", tiff(2, 2, samples=1, photometric=32803, content=bytes(4)), "camera_raw"),
    ("cr2.tif", b"II*\0" + struct.pack("<I", 20) + b"CR\2\0" + bytes(40), "camera_raw"),
    ("dng.tif", tiff(2, 2, extra=((50706, 1, 0x0401),), content=bytes(12)), "camera_raw"),
    ("preview.tif", tiff(2, 2, extra=((254, 4, 1), (330, 4, 8)), content=bytes(12)), "coding_not_read"),
    ("below.tif", tiff(2, 2, extra=((330, 4, 8),), content=struct.pack("<HHHII", 1, 256, 4, 1, 3)), "coding_not_read"),
    ("raf.tif", b"FUJIFILMCCD-RAW 0201" + bytes(80), "camera_raw"),
    ("cr3.tif", b"\0\0\0\x18ftypcrx \0\0\0\x01crx isom" + bytes(80), "camera_raw"),
    ("cmyk.tif", tiff(2, 2, samples=4, photometric=5, content=bytes(16)), "other_colors"),
    ("cmyk.jpg", four_inks(), "other_colors"),
    ("lab.tif", tiff(2, 2, photometric=8, content=bytes(12)), "other_colors"),
    ("icclab.tif", tiff(2, 2, photometric=9, content=bytes(12)), "coding_not_read"),
    ("signed.tif", tiff(2, 2, kind=2, content=bytes(12)), "sample_type"),
    ("9.tif", tiff(2, 2, bits=9, content=bytes(14)), "coding_not_read"),
    ("complex.tif", tiff(2, 2, bits=64, kind=6, content=bytes(96)), "coding_not_read"),
    ("tile.tif", tiff(2, 2, extra=((322, 4, 60000), (323, 4, 60000)), content=bytes(12)), "too_many_pixels"),
    ("long.tif", tiff(2, 2, bits=32, content=bytes(48)), "sample_type"),
    ("bilevel.tif", tiff(8, 2, samples=1, photometric=1, bits=1, content=bytes(2)), "sample_type"),
    ("exotic.tif", with_compression(tiff(2, 2, content=bytes(12)), 34926), "coding_not_read"),
    ("order.tif", with_compression(tiff(2, 2, extra=((266, 3, 2),), content=bytes(12)), 8), "coding_not_read"),
    ("directory.tif", b"II*\0" + struct.pack("<I", 10**9) + bytes(8), "damaged"),
    *(("zero.png", png(0, 0), "damaged"), ("lying.png", png(2000, 2000), "damaged")),
    *((name, content, "damaged") for name, content in HUGE.items()),
]


@pytest.mark.parametrize(("name", "content", "code"), FILES, ids=[name for name, _, _ in FILES])
def test_other_files_are_refused(tmp_path, name, content, code):
    assert refusal(written(tmp_path / name, content)) == code


@pytest.mark.parametrize(("name", "kind"), [("a.exr", np.float16), ("a.hdr", np.float32)])
def test_scene_linear_formats_are_refused(tmp_path, name, kind):
    assert refusal(write_image(tmp_path / name, np.ones((2, 2, 3), kind))) == "scene_linear_file"


def test_folders_and_absent_files_are_refused(tmp_path):
    assert refusal(tmp_path / "a.jpg") == "no_such_photograph"
    (tmp_path / "a.jpg").mkdir()
    assert refusal(tmp_path / "a.jpg") == "photograph_is_folder"


#: Changes of a JPEG, and the code of the refusal; Pillow would read an endless header byte by byte.
JPEG_CHANGES = [
    (lambda whole: re.sub(b"(\xff[\xc0\xc2]\0\x11)\x08", rb"\1" + b"\x0c", whole), "coding_not_read"),  # of 12 bits
    (lambda whole: re.sub(b"\xff[\xc0\xc2]\0\x11", b"\xff\xf7\0\x11", whole), "coding_not_read"),  # JPEG-LS
    (lambda whole: with_jpeg_size(whole, 50000, 50000), "too_many_pixels"),
    (lambda whole: whole[:2] + b"\xff\xe1\0\3a" * 5000 + whole[2:], "damaged"),
    (lambda whole: whole[:2] + b"\xff" * 2**21 + whole[2:], "damaged"),
    (lambda whole: whole[: len(whole) // 2] + bytes(len(whole) // 2), "damaged"),  # a failed download
    *((lambda whole, part=part: whole[: int(len(whole) * part) - 2], "damaged") for part in (0.001, 0.05, 0.6, 1)),
]


@pytest.mark.parametrize("progressive", [0, 1])
@pytest.mark.parametrize(("change", "code"), JPEG_CHANGES)
def test_changed_jpegs_are_refused(tmp_path, change, code, progressive):
    whole = jpeg(tmp_path / "a.jpg", jpeg__progressive=progressive)
    assert refusal(written(tmp_path / "a.jpg", change(whole))) == code


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_does_not_block(tmp_path):
    os.mkfifo(tmp_path / "a.jpg")
    assert refusal(tmp_path / "a.jpg") == "not_a_file"


def test_what_follows_a_jpeg_is_ignored(tmp_path):
    path = tmp_path / "a.jpg"
    whole = jpeg(path)
    expected = read_photo(path).pixels
    np.testing.assert_array_equal(read_photo(written(path, whole + bytes(5000))).pixels, expected)


@pytest.mark.parametrize("name", ["a.jpg", "a.jxl", "a.jp2"])
def test_no_file_is_mapped(tmp_path, codes, monkeypatch, name):
    """Where the disk cannot read a page of a mapped file, the system ends the process."""
    monkeypatch.setattr(mmap, "mmap", None)
    assert read_photo(write_image(tmp_path / name, codes)).shape == codes.shape


@pytest.mark.parametrize("fraction", [0.3, 0.5, 0.99])
@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.webp", "a.dpx", "10.dpx", "12.dpx", "a.jxl", "a.jp2", "a.bmp"])
def test_other_cut_files_are_refused(tmp_path, name, fraction):
    bits = {"10.dpx": 10, "12.dpx": 12}.get(name, 8)
    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3)).astype(np.uint8 if bits == 8 else np.uint16)
    compression = {"a.webp": "lossless", "a.jxl": "jpegxl:100"}.get(name, "none")
    path = write_image(tmp_path / name, noise, Compression=compression, oiio__BitsPerSample=bits)
    whole = path.read_bytes()
    assert refusal(written(path, whole[: int(len(whole) * fraction)])) == "damaged"


def test_sparse_file_above_the_limit(tmp_path):
    header = tiff(50000, 50000, samples=1, photometric=1)
    path = written(tmp_path / "a.tif", header)
    os.truncate(path, 50000 * 50000 + len(header))
    assert refusal(path) == "too_many_pixels"
    assert 200e6 < MAX_PIXELS < 2500e6


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak memory as Linux reports it")
def test_bombs_take_little_memory(tmp_path):
    bombs = {**HUGE, "huge.jpg": with_jpeg_size(jpeg(tmp_path / "a.jpg", jpeg__progressive=1), 50000, 50000)}
    size, is_read = memory_of_reading(*(written(tmp_path / name, content) for name, content in bombs.items()))
    assert not is_read
    assert size < 50_000, "kB"


def test_unreadable_file(tmp_path, monkeypatch):
    path = write_image(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8))
    monkeypatch.setattr(Path, "open", Mock(side_effect=PermissionError(13, "Permission denied")))
    assert refusal(path) == "cannot_open_photograph"


def test_names_that_no_system_takes(tmp_path):
    assert refusal(tmp_path / ("x" * 300)) == "cannot_open_photograph"
    assert refusal(tmp_path / "a\0.jpg") == "no_such_photograph"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux stores names as bytes")
def test_name_that_is_not_utf8(tmp_path):
    path = os.fsencode(tmp_path) + b"/\xff.png"
    Path(os.fsdecode(path)).write_bytes(png(1, 1, bytes(4)))
    with pytest.raises(PhotoError) as caught:
        read_photo(os.fsdecode(path))
    assert (caught.value.code, str(caught.value).isprintable()) == ("name_not_utf8", True)
    assert "'" not in str(caught.value.facts["path"])
