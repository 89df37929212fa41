"""`crfnet camera` and `--camera`: measured responses of cameras, kept to be used again."""

import json
import shlex
from dataclasses import replace

import numpy as np
import pytest

from crfnet.luts.files import read_lut
from crfnet.luts.response import response_of_lut
from crfnet_core.library import CameraLibrary
from crfnet_core.response.metrics import estimation_error
from tests.helpers.cameras import camera, photograph
from tests.helpers.folders import tree
from tests.helpers.images import read_image


@pytest.fixture(autouse=True)
def library(monkeypatch, tmp_path):
    """The user's own library, empty at first."""
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    return CameraLibrary.of_user()


@pytest.fixture
def photos(plate, tmp_path):
    return [photograph(plate, tmp_path / f"IMG_{n}.jpg", Exif__PhotographicSensitivity=100) for n in range(2)]


@pytest.fixture
def measured(library):
    """The camera "measured", which is in the library."""
    measured = camera("measured", 2.0, make="SONY", model="ILCE-7M3", iso=(100,))
    library.save(measured)
    return measured


@pytest.fixture
def run(crfnet, fixed_model):
    """Run `crfnet camera`, or another command with the fixed model; it must succeed."""

    def run_command(command, *arguments):
        model = () if command == "camera" else ("--model", fixed_model)
        return crfnet(command, *arguments, *model).printed

    return run_command


def test_a_calibration_becomes_a_camera_that_is_shown_and_removed(crfnet, run, stack, tmp_path, library):
    assert crfnet("calibrate", *stack, "--out", tmp_path / "look", "--name", "eos20d", "--no-sheet").printed
    calibration = tmp_path / "look" / "eos20d.json"
    out = run("camera", "add", "--from-calibration", calibration, "--name", "20D")
    assert f"Written: {library.folder / '20D.json'}." in out
    assert "20D: Canon EOS 20D; measured from 6 exposures, ISO 100" in out
    document = json.loads(calibration.read_text(encoding="utf-8"))
    assert library.get("20D").shape_stops == document["shape_uncertainty_stops"]
    assert np.allclose(library.get("20D").curve.brightness, document["response"]["brightness"], atol=1e-4)
    assert out.endswith(run("camera", "show", "20d"))
    assert "Removed: 20D." in run("camera", "remove", "20D")
    assert library.cameras() == []
    run("camera", "add", "--from-calibration", calibration)
    assert [one.name for one in library.cameras()] == ["eos20d"]


def test_the_list_names_cameras_and_damaged_files(run, measured, library):
    (library.folder / "damaged.json").write_text("{")
    out = run("camera", "list")
    assert "  measured: SONY ILCE-7M3; measured from 6 exposures, ISO 100\n" in out
    assert f"note: {library.folder / 'damaged.json'}: " in out
    listed = json.loads(run("camera", "list", "--json"))
    assert (listed["folder"], len(listed["problems"])) == (str(library.folder), 1)
    assert [one["name"] for one in listed["cameras"]] == ["measured"]
    shown = json.loads(run("camera", "show", "measured", "--json"))
    assert (shown["make"], shown["iso"], shown["estimate"]["camera"]["name"]) == ("SONY", [100], "measured")


def test_an_estimate_uses_a_camera_that_is_asked_for(run, measured, photos, tmp_path):
    out = run("estimate", photos[0], "--camera", "measured", "--out", tmp_path / "look", "--no-sheet")
    assert 'Response of the camera "measured", measured from 6 exposures, ISO 100.\n' in out
    lut = read_lut(tmp_path / "look" / "IMG_0.spi1d")
    assert estimation_error(response_of_lut(lut), measured.curve) < 0.01
    assert any('camera "measured"' in comment for comment in lut.comments)
    assert not any(words in text for text in (out, *lut.comments) for words in ("windows agree", "Model: "))
    document = json.loads((tmp_path / "look" / "IMG_0.json").read_text(encoding="utf-8"))
    assert document["camera"]["name"] == "measured"
    assert "known_cameras" not in document


def test_a_camera_that_fits_is_offered_but_not_used(run, measured, photos, tmp_path):
    out = run("estimate", photos[0], "--out", tmp_path / "look", "--no-sheet")
    assert "to use it, add --camera measured (measured from 6 exposures, ISO 100)." in out
    document = json.loads((tmp_path / "look" / "IMG_0.json").read_text(encoding="utf-8"))
    assert document["camera"] is None
    assert document["known_cameras"] == [{"name": "measured", "basis": measured.basis}]
    quiet = run("estimate", photos[0], "--out", tmp_path / "quiet", "--no-sheet", "--ignore-metadata")
    assert "is known" not in quiet


def test_plates_are_linearized_with_a_camera_as_with_its_exported_lut(run, crfnet, measured, photos, tmp_path):
    out = run("linearize", photos[0], "--camera", "measured", "--out", tmp_path / "a.exr", "--depth", "float")
    assert out.count('Response of the camera "measured", measured from 6 exposures') == 1
    run("camera", "export", "measured", tmp_path / "measured.spi1d")
    lut = ("--lut", tmp_path / "measured.spi1d")
    assert crfnet("linearize", photos[0], *lut, "--out", tmp_path / "b.exr", "--depth", "float").code == 0
    assert np.array_equal(read_image(tmp_path / "a.exr"), read_image(tmp_path / "b.exr"))
    assert crfnet("camera", "export", "measured", lut[1]).refusal == "exists"


def test_a_camera_is_handed_on_as_a_file(run, measured, library, tmp_path):
    run("camera", "export", "measured", tmp_path / "given.json")
    run("camera", "add", "--from-calibration", tmp_path / "given.json", "--name", "handed on")
    assert library.get("handed on") == replace(measured, name="handed on")


BAD = [
    ("not_a_calibration", "camera add --from-calibration IMG_0.jpg"),
    ("bad_camera_name", "camera add --from-calibration IMG_0.jpg --name a/b"),
    ("no_camera", "camera show nobody"),
    ("no_camera", "camera remove nobody"),
    ("packaged_camera", "camera remove 'Canon EOS 20D'"),
    ("lut_suffix", "camera export measured a.xyz"),
    ("no_camera", "estimate IMG_0.jpg --out look --camera nobody"),
    ("no_camera", "estimate IMG_0.jpg --each --out look --camera nobody"),
    ("no_camera", "linearize IMG_0.jpg --each --out a.exr --camera nobody"),
    ("two_responses", "linearize IMG_0.jpg --out a.exr --camera measured --lut a.spi1d"),
    ("usage", "camera"),
]


@pytest.mark.parametrize(("code", "line"), BAD)
def test_a_mistake_is_refused_and_changes_nothing(crfnet, measured, photos, tmp_path, monkeypatch, code, line):
    monkeypatch.chdir(tmp_path)
    before = tree(tmp_path)
    done = crfnet(*shlex.split(line))
    assert (done.refusal, done.out) == (code, "")
    assert tree(tmp_path) == before
