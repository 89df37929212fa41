"""linearize_plates refuses what it cannot write, before it writes anything; a failed write leaves nothing."""

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.errors import PlateError
from crfnet.plates import exr, linear
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_codes
from tests.helpers.folders import listed, tree
from tests.helpers.images import write_image
from tests.helpers.plates import LUT, SMALL, linearize, write_sequence


def test_our_own_output_is_refused_as_a_plate(tmp_path, out):
    linearize(write_image(tmp_path / "a.png", SMALL[..., :3]), out / "a.exr", LUT)
    with pytest.raises(
        PlateError, match=r"a\.exr: is scene-linear already \(lin_rec709_scene\); give the encoded plate"
    ):
        linearize(out / "a.exr", out / "b.exr", LUT)
    assert not (out / "b.exr").exists()


def test_a_bad_single_plate_gives_its_own_message(tmp_path, out):
    (tmp_path / "a.png").touch()
    with pytest.raises(PlateError, match=r"a\.png: the file is empty; copy it again$"):
        linearize(tmp_path / "a.png", out / "a.exr", LUT)
    assert tree(out) == {}


def test_scene_linear_float_plates_are_refused(tmp_path, out):
    write_image(tmp_path / "a.tif", SMALL[..., :3].astype(np.float32))
    with pytest.raises(PlateError, match="float samples holds scene-linear values"):
        linearize(tmp_path / "a.tif", out / "a.exr", LUT)
    with pytest.raises(PhotoError):
        read_codes(tmp_path / "a.tif")


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("out/a.exr", "one name for 2 frames; put their number into it, as in plate.%04d.exr"),
        ("out/a.%04d.png", r"linear plates are OpenEXR; give a name that ends in \.exr"),
        ("out/a", "linear plates are OpenEXR"),
        ("absent/a.####.exr", "the folder .*absent does not exist; create it first"),
        ("out/a.##.##.exr", "holds 2 frame placeholders"),
    ],
)
def test_output_names_that_cannot_be_are_refused(tmp_path, out, target, message):
    with pytest.raises(PlateError, match=message) as caught:
        linearize(write_sequence(tmp_path, (1, 2)), tmp_path / target, LUT)
    assert "\n" not in str(caught.value)
    assert tree(out) == {}


def test_one_frame_of_a_sequence_needs_a_number_too(tmp_path, out):
    with pytest.raises(PlateError, match="one name for a frame of a sequence; put its number into it, as in"):
        linearize(write_sequence(tmp_path, (1,)), out / "a.exr", LUT)


def test_a_finished_plate_of_another_size_is_that_of_another_plate(tmp_path, out):
    linearize(write_image(tmp_path / "a.png", SMALL[..., :3]), out / "a.exr", LUT)
    before, (height, width) = tree(out), SMALL.shape[:2]
    other = write_image(tmp_path / "b.png", SMALL[:, 1:, :3])
    words = f"is there already, with {width} x {height} pixels, not {width - 1} x {height}; .* add --overwrite"
    with pytest.raises(PlateError, match=words):
        linearize(other, out / "a.exr", LUT)
    assert tree(out) == before
    linearize(other, out / "a.exr", LUT, overwrite=True)
    assert tree(out) != before


@pytest.mark.parametrize(
    ("plate", "target"), [("a.exr", "a.exr"), ("a.#.exr", "a.%04d.exr"), ("a.#.exr", "./b/../a.@.exr")]
)
def test_plates_are_never_replaced(tmp_path, plate, target):
    values = SMALL[..., :3].astype(np.float32) / 255
    (tmp_path / "b").mkdir()
    for name in ("a.exr", "a.0001.exr", "a.1001.exr"):
        write_image(tmp_path / name, values)
    before = {name: (tmp_path / name).read_bytes() for name in listed(tmp_path) if name != "b"}
    with pytest.raises(PlateError, match="is one of the plates, which are never replaced; choose another name"):
        linearize(tmp_path / plate, f"{tmp_path}/{target}", LUT, overwrite=True)
    assert {name: (tmp_path / name).read_bytes() for name in listed(tmp_path) if name != "b"} == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"depth": "double"}, "depth 'double' is unknown; choose half or float"),
        ({"exposure": float("nan")}, "an exposure of nan stops is out of range"),
        ({"exposure": float("inf")}, "an exposure of inf stops is out of range"),
        ({"exposure": 5000}, "an exposure of 5000 stops is out of range"),
        ({"exposure": -5000}, "an exposure of -5000 stops is out of range"),
        ({"exposure": 17}, "values up to 131072 do not fit into half floats; ask for float"),
        ({"workers": 0}, "0 workers cannot work; give 1 or more"),
        ({"frames": "1-3"}, "is a single file, which has no frames"),
    ],
)
def test_options_out_of_range_are_refused(tmp_path, out, options, message):
    plate = write_image(tmp_path / "a.png", SMALL[..., :3])
    with pytest.raises(PlateError, match=message):
        linearize(plate, out / "a.exr", LUT, **options)
    assert tree(out) == {}


def test_a_failed_write_leaves_nothing(tmp_path, out, monkeypatch):
    def fail(path, header, pixels, *, name):
        path.write_bytes(b"half an EXR")
        raise PlateError(f"{name}: cannot be written (disk full); check the disk")

    monkeypatch.setattr(linear, "write_exr", fail)
    with pytest.raises(PlateError, match=r"out/a\.exr: cannot be written"):
        linearize(write_image(tmp_path / "a.png", SMALL), out / "a.exr", LUT)
    assert tree(out) == {}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device that is always full")
def test_a_full_disk_is_named(tmp_path):
    (tmp_path / "full.exr").symlink_to("/dev/full")
    spec = oiio.ImageSpec(90, 70, 4, "half")
    with pytest.raises(PlateError) as caught:
        exr.write_exr(tmp_path / "full.exr", spec, SMALL.astype(np.float16), name=Path("a.exr"))
    assert caught.value.code == "exr_not_written"


@pytest.mark.parametrize("kept", [0.5, 0.99])
def test_a_file_whose_last_page_is_lost_is_refused(tmp_path, monkeypatch, kept):
    """As on a full disk: OpenEXR reports no error of its last write."""
    check = exr._check_chunks

    def lose(path, name):
        os.truncate(path, int(path.stat().st_size * kept))
        check(path, name)

    monkeypatch.setattr(exr, "_check_chunks", lose)
    with pytest.raises(PlateError) as caught:
        exr.write_exr(
            tmp_path / "a.exr", oiio.ImageSpec(90, 70, 4, "half"), SMALL.astype(np.float16), name=Path("a.exr")
        )
    assert caught.value.code == "exr_not_written"


def test_metadata_that_is_not_utf_8_is_kept_in_part():
    """Makers write their names in Latin-1, Shift-JIS and GBK."""
    source = oiio.ImageSpec(4, 4, 3, "uint8")
    make = SimpleNamespace(name="Make", type=oiio.TypeDesc("string"), value="Voigtl\udce4nder")
    names = ("width", "height", "x", "y", "full_x", "full_y", "full_width", "full_height")
    plate = SimpleNamespace(extra_attribs=[make], **{name: getattr(source, name) for name in names})
    header = exr.linear_header(plate, channels=3, depth="half", attributes={})
    assert header.getattribute("Make") == header.getattribute("cameraMake") == "Voigtl?nder"
