import json
import os
import shutil
from pathlib import Path, PurePosixPath
from unittest.mock import Mock

import numpy as np
import pytest

from crfnet import pipeline
from crfnet.cli.commands import printing
from crfnet.luts.files import WRITERS, read_lut
from crfnet_core import ResponseCurve, staging
from tests.helpers.configs import loaded
from tests.helpers.folders import listed, tree, written
from tests.helpers.images import write_image
from tests.helpers.looks import write_look

FILES = {*(f"plate{suffix}" for suffix in WRITERS), "config.ocio", "plate_linear.exr", "plate_sheet.png", "plate.json"}


def test_says_what_it_read_found_and_wrote(crfnet, plate, fixed_model, tmp_path):
    out = crfnet("estimate", plate, "--out", tmp_path / "look", "--model", fixed_model).out
    parts = ("plate.jpg: 672 x 378, 8 bits", "The estimate is ", "\nPrior: camera; metadata: ", "10 analyzed windows")
    assert all(part in out for part in (*parts, *FILES))
    assert set(listed(tmp_path / "look")) == FILES


def test_prints_one_json_document(estimate, plate, tmp_path):
    document = json.loads(estimate(plate, "--json").out)
    found = document["estimates"][0]
    assert document["folder"] == str(tmp_path / "out")
    assert found == json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))
    assert found["photographs"] == [
        {"name": "plate.jpg", "width": 672, "height": 378, "bit_depth": 8, "has_gain_map": False}
    ]
    assert (len(found["response"]["brightness"]), len(found["windows"])) == (1024, 10)
    assert found["files"]["sheet"] is None
    assert found["color_space"] == "CRF plate"


@pytest.mark.parametrize("name", ["any", "mine.json"])
def test_the_prior_can_be_chosen(estimate, plate, tmp_path, name):
    own = written(tmp_path / "mine.json", '{"shares": {"phone": 2e-1, "film": 1}, "evidence": 0.5}')
    printed = estimate(plate, "--prior", own if name == own.name else name).printed
    assert f"\nPrior: {Path(name).stem}; " in printed
    found = json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))
    assert (found["families"]["camera"] < 1e-200) == (name == own.name)


def test_an_editor_is_warned_of(estimate, codes, tmp_path):
    photo = write_image(tmp_path / "edited.jpg", codes, Software="GIMP 2.10", Make="Canon", Model="Canon EOS 20D")
    assert "\nWarning: saved by GIMP 2.10, which may have changed the tones" in estimate(photo).out


def test_the_luts_hold_the_inverse_of_the_response(look, true_response):
    lut = read_lut(look / "plate.spi1d")
    found = json.loads((look / "plate.json").read_text(encoding="utf-8"))["response"]["brightness"]
    expected = ResponseCurve.from_samples(np.array(found))
    np.testing.assert_allclose(lut.values, expected.inverse(np.linspace(0, 1, 4081)), atol=1e-3)
    np.testing.assert_allclose(lut.values, true_response.inverse(np.linspace(0, 1, 4081)), atol=0.1)
    assert any("plate.jpg" in comment for comment in lut.comments)
    assert any("fixed" in comment for comment in lut.comments)


def test_writes_nothing_outside_the_output_folder(crfnet, plate, fixed_model, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    photo = shutil.copy(plate, tmp_path / "photo.jpg")
    before = tree(tmp_path)
    assert crfnet("estimate", "photo.jpg", "--out", "deep/look", "--model", fixed_model).code == 0
    written = {path for path in tree(tmp_path) if path not in before}
    assert {str(PurePosixPath(path).parent) for path in written} == {"deep/look"}
    assert Path(photo).read_bytes() == plate.read_bytes()


def test_several_photographs_make_one_response(estimate, plate, tmp_path):
    out = estimate(plate, shutil.copy(plate, tmp_path / "other.jpg")).out
    assert set(listed(tmp_path / "out")) == FILES - {"plate_sheet.png"} | {"other_linear.exr"}
    assert " of 20 analyzed windows agree" in out


@pytest.mark.parametrize("name", ["a\\b.jpg", f"{'写' * 80}.jpg", "a$b%20#1.jpg", "q'u\"o.jpg", "[1,  2].jpg"])
def test_any_file_name_works(estimate, plate, tmp_path, name):
    assert estimate(shutil.copy(plate, tmp_path / name)).printed
    assert len(listed(tmp_path / "out")) == len(FILES) - 1


def test_what_is_there_is_replaced_only_when_asked(estimate, plate, out):
    (out / "plate.cube").write_text("mine")
    assert estimate(plate).refusal == "file_exists"
    assert tree(out) == {"plate.cube": b"mine"}
    assert estimate(plate, "--overwrite").code == 0
    assert "LUT_1D_SIZE 4081" in (out / "plate.cube").read_text()


def test_a_photograph_that_is_given_twice_counts_once(estimate, plate, monkeypatch):
    monkeypatch.chdir(plate.parent)
    done = estimate(plate, plate.name, plate, "--no-linear", "--json")
    assert [photo["name"] for photo in json.loads(done.out)["estimates"][0]["photographs"]] == ["plate.jpg"]


@pytest.mark.parametrize(
    ("part", "answer", "words"),
    [
        ("find_spec", [None], "pip install"),
        ("_font_folder", FileNotFoundError(2, "No usable temporary directory found in ['/tmp']"), "set TMPDIR"),
    ],
)
def test_says_how_to_get_the_sheet(crfnet, plate, fixed_model, tmp_path, monkeypatch, part, answer, words):
    """Without matplotlib, and on a disk to which nothing can be written but the results."""
    monkeypatch.delenv("MPLCONFIGDIR", raising=False)
    monkeypatch.setattr(printing, part, Mock(side_effect=answer))
    done = crfnet("estimate", plate, "--out", tmp_path, "--model", fixed_model)
    assert (done.code, words in done.err, done.err.count("\n")) == (0, True, 1)
    assert not (tmp_path / "plate_sheet.png").exists()


@pytest.mark.parametrize(("device", "words"), [("phone", "a phone"), ("other", "a camera")])
def test_the_user_may_state_the_device(estimate, plate, device, words):
    assert f"\nPrior: camera; you and the file say: taken with {words}, " in estimate(plate, "--taken-with", device).out
    document = json.loads(estimate(plate, "--taken-with", device, "--overwrite", "--json").out)
    (metadata,) = document["estimates"][0]["metadata"]
    assert metadata["has_stated_device"]
    assert (metadata["device"] == "phone") == (device == "phone")


def test_color_spaces_that_a_replaced_config_no_longer_has_are_named(estimate, crfnet, plate, tmp_path):
    other, out = shutil.copy(plate, tmp_path / "other.jpg"), tmp_path / "out"
    assert "was replaced" not in estimate(plate, "--no-linear").out
    assert "was replaced" not in estimate(plate, "--no-linear", "--overwrite").out
    words = 'Warning: config.ocio was replaced and no longer has "CRF plate"; '
    assert words in estimate(other, "--no-linear", "--overwrite").out
    both = tmp_path / "both"
    assert crfnet("config", "add", "--base", out / "config.ocio", "--out", both, out / "plate.json").code == 0
    assert {"CRF plate", "CRF other"} < set(loaded(both / "config.ocio").getColorSpaceNames())
    printed = estimate(plate, "--no-linear", "--overwrite", "--json").out
    assert json.loads(printed)["dropped"] == ["CRF other"]


def test_a_color_space_that_another_process_has_just_written_is_named_as_lost(estimate, plate, out, monkeypatch):
    """The config is looked at as it is replaced, and then no other process may write one."""
    fcntl = pytest.importorskip("fcntl", reason="Windows locks no folders")
    publish, light = staging._publish, pipeline.estimated_light

    def light_later(*arguments):
        write_look(out, ["b.jpg"])
        monkeypatch.setattr(staging, "_publish", publish_alone)
        return light(*arguments)

    def publish_alone(*arguments, **options):
        folder = os.open(out, os.O_RDONLY)
        with pytest.raises(BlockingIOError):
            fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
        os.close(folder)
        publish(*arguments, **options)

    monkeypatch.setattr(pipeline, "estimated_light", light_later)
    assert 'no longer has "CRF b"' in estimate(plate, "--no-linear", "--no-sheet", "--overwrite").out


@pytest.mark.parametrize("content", [b"no config", b"ocio_profile_version: \xe4\xff"])
def test_a_config_that_nobody_can_read_is_replaced(estimate, plate, out, content):
    (out / "config.ocio").write_bytes(content)
    assert estimate(plate, "--no-linear", "--overwrite").printed
    assert "CRF plate" in loaded(out / "config.ocio").getColorSpaceNames()
