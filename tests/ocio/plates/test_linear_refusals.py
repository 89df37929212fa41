"""linearize_plates refuses what it cannot write, before it writes anything; a failed write leaves nothing."""

import os
import struct
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.errors import PlateError
from crfnet.plates import exr
from crfnet_core.errors import CRFNetError, PhotoError
from tests.helpers.crafted_files import png, png_chunk
from tests.helpers.folders import listed, tree
from tests.helpers.images import read_image, write_image
from tests.helpers.plates import LUT, SMALL, linearize, write_sequence
from tests.helpers.refusals import refused


def refusal(*arguments, **options):
    with pytest.raises(CRFNetError) as caught:
        linearize(*arguments, **options)
    return caught.value.code


def test_a_bad_single_plate_gives_its_own_error(tmp_path, out):
    (tmp_path / "a.png").touch()
    write_image(tmp_path / "a.tif", SMALL[..., :3].astype(np.float32))
    for name in ("a.png", "a.tif"):
        with pytest.raises(PhotoError):
            linearize(tmp_path / name, out / "a.exr", LUT)
    assert tree(out) == {}


@pytest.mark.parametrize(("number", "words"), [(1, "is linear already"), (2, "its transfer function is linear")])
def test_a_frame_tagged_linear_is_refused(tmp_path, out, number, words):
    plates, plate = write_sequence(tmp_path, (1, 2)), tmp_path / f"plate.{number:04d}.png"
    plate.write_bytes(png(1, 1, bytes(4), chunks=png_chunk(b"gAMA", struct.pack(">I", 100_000))))
    with pytest.raises(CRFNetError, match=words):
        linearize(plates, out / "l.%04d.exr", LUT)
    assert listed(out) == ["l.0001.exr"][: number - 1]
    assert linearize(plate, out / "a.exr", LUT, is_encoded=True).written


@pytest.mark.parametrize(
    ("target", "code"),
    [("out/a.exr", "no_placeholder"), ("out/a.%04d.png", "not_exr"), ("out/a.##.##.exr", "several_placeholders")],
)
@pytest.mark.parametrize("numbers", [(1, 2), (1,)])
def test_output_names_that_cannot_be_are_refused(tmp_path, out, numbers, target, code):
    assert refusal(write_sequence(tmp_path, numbers), tmp_path / target, LUT) == code
    assert tree(out) == {}


def test_an_absent_folder_is_refused(tmp_path):
    assert refusal(write_sequence(tmp_path, (1,)), tmp_path / "absent" / "a.#.exr", LUT) == "folder_absent"


def write_over(path, *, pixels=slice(None), names="RGB", compression="zips"):
    """Write a comp with all metadata of a linear plate over it."""
    samples = read_image(path)[pixels, :, : len(names)]
    header = oiio.ImageBuf(str(path)).spec().extra_attribs
    attributes = {each.name: each.value for each in header if isinstance(each.value, str | float)}
    attributes |= {"compression": compression}
    write_image(path, samples.astype(np.float16), names=tuple(names), **attributes)


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda path: path.write_text("notes"), "finished_foreign"),
        (lambda path: os.truncate(path, 0), "finished_foreign"),
        (lambda path: os.truncate(path, path.stat().st_size - 1), "finished_foreign"),
        (lambda path: write_image(path, SMALL[..., :3].astype(np.float32)), "finished_foreign"),
        (lambda path: write_over(path, pixels=slice(8)), "finished_foreign"),
        (lambda path: write_over(path, names="Y"), "finished_foreign"),
        (lambda path: write_over(path, compression="none"), "finished_foreign"),
        (lambda path: linearize(path.parent / "a.0003.png", path, LUT, overwrite=True), "finished_outdated"),
    ],
)
@pytest.mark.parametrize(("name", "target"), [("a.0002.png", "a.exr"), ("a.####.png", "a.0002.exr")])
def test_a_target_that_is_not_the_whole_linear_frame_of_its_plate_is_refused(tmp_path, name, target, change, code):
    """A user would take it for one; `test_cli_exposure` has other settings."""
    write_sequence(tmp_path, (1, 2, 3), name="a.{:04d}.png")
    plates, target, out = tmp_path / name, tmp_path / target, tmp_path / target.replace("0002", "####")
    linearize(plates, out, LUT)
    assert linearize(plates, out, LUT).written == ()
    change(target)
    before = tree(tmp_path)
    with refused(PlateError, code, path=target):
        linearize(plates, out, LUT)
    assert tree(tmp_path) == before
    assert target in linearize(plates, out, LUT, overwrite=True).written


@pytest.mark.parametrize(
    ("plate", "target"), [("a.exr", "a.exr"), ("a.#.exr", "a.%04d.exr"), ("a.#.exr", "./b/../a.@.exr")]
)
def test_plates_are_never_replaced(tmp_path, plate, target):
    values = SMALL[..., :3].astype(np.float32) / 255
    (tmp_path / "b").mkdir()
    for name in ("a.exr", "a.0001.exr", "a.1001.exr"):
        write_image(tmp_path / name, values)
    before = {name: (tmp_path / name).read_bytes() for name in listed(tmp_path) if name != "b"}
    assert refusal(tmp_path / plate, f"{tmp_path}/{target}", LUT, overwrite=True) == "target_is_plate"
    assert {name: (tmp_path / name).read_bytes() for name in listed(tmp_path) if name != "b"} == before


@pytest.mark.parametrize(
    ("options", "code"),
    [
        *(({name: "other"}, "bad_option") for name in ("depth", "exposure", "gray", "primaries", "output_space")),
        *(({"exposure": stops}, "bad_option") for stops in (float("nan"), 5000, -5000)),
        ({"exposure": 100, "gray": 1e-12}, "exposure_out_of_range"),
        ({"exposure": 17}, "exceeds_half"),
        ({"workers": 0}, "bad_workers"),
        ({"frames": "1-3"}, "single_file"),
    ],
)
def test_options_out_of_range_are_refused(tmp_path, out, options, code):
    assert refusal(write_image(tmp_path / "a.png", SMALL[..., :3]), out / "a.exr", LUT, **options) == code
    assert tree(out) == {}


def test_alpha_that_does_not_fit_into_half_floats_is_refused(tmp_path, out):
    samples = np.full((2, 2, 4), 0.5, np.float32)
    samples[0, 0, 3] = 1e5
    plate = write_image(tmp_path / "a.exr", samples, names=("R", "G", "B", "A"))
    assert refusal(plate, out / "a.exr", LUT, is_encoded=True) == "exceeds_half"
    assert tree(out) == {}
    linearize(plate, out / "a.exr", LUT, is_encoded=True, depth="float")
    assert read_image(out / "a.exr")[0, 0, 3] == 1e5


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device that is always full")
def test_a_full_disk_is_named(tmp_path):
    (tmp_path / "full.exr").symlink_to("/dev/full")
    spec = oiio.ImageSpec(90, 70, 4, "half")
    with refused(PlateError, "exr_not_written"):
        exr.write_exr(tmp_path / "full.exr", spec, SMALL.astype(np.float16), name=Path("a.exr"))


def test_a_file_whose_end_is_lost_while_it_is_written_is_refused(tmp_path, monkeypatch):
    """As on a full disk: OpenEXR reports no error of its last writes."""
    is_whole = exr.is_whole

    def lose(path, header):
        os.truncate(path, path.stat().st_size - 1)
        return is_whole(path, header)

    monkeypatch.setattr(exr, "is_whole", lose)
    plate = write_image(tmp_path / "a.png", SMALL)
    assert refusal(plate, tmp_path / "a.exr", LUT) == "exr_not_written"
