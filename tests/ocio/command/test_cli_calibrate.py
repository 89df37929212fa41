import json
import sys

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.luts.files import read_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.response import response_of_lut
from crfnet.pipeline.calibrations import response_to_compare
from crfnet_core.library import read_calibration
from crfnet_core.response.metrics import shape_error
from tests.helpers.folders import listed, tree, written
from tests.helpers.images import read_image
from tests.helpers.refusals import refused
from tests.helpers.schemas import problems_by, read_schema
from tests.helpers.stacks import light_of

FILES = {"eos20d.spi1d", "eos20d.cube", "eos20d.clf", "eos20d.json", "eos20d_sheet.png", "config.ocio"}


@pytest.fixture(scope="module")
def camera(crfnet, stack, look, tmp_path_factory):
    """The output folder of a calibration, and what it printed."""
    folder = tmp_path_factory.mktemp("calibration") / "camera"
    arguments = ("--out", folder, "--name", "eos20d", "--compare", look / "plate.json")
    return folder, crfnet("calibrate", *stack, *arguments).printed


def test_writes_what_it_says(camera, true_response):
    folder, out = camera
    lut = read_lut(folder / "eos20d.spi1d")
    assert shape_error(true_response, response_to_compare(folder / "eos20d.cube")) < 0.05
    assert any("Measured from 6 frames of Canon EOS 20D" in comment for comment in lut.comments)
    assert any(comment.startswith("Standard deviations: shape 0.0") for comment in lut.comments)
    assert set(listed(folder)) == FILES
    assert all(name in out for name in FILES)
    assert "6 frames of Canon EOS 20D, ISO 100, f/8, 1/60 s to 0.5 s (5.0 stops)." in out
    assert "\nStandard deviations: shape 0.0" in out
    assert "The other response is off by " in out
    assert "Warning" not in out


def test_the_document_says_all(camera):
    found = json.loads((camera[0] / "eos20d.json").read_text(encoding="utf-8"))
    assert found["kind"] == "calibration"
    assert found["camera"] == {"make": "Canon", "model": "Canon EOS 20D", "firmware": ""}
    parts = found["uncertainty_parts"]["shape"]
    assert found["shape_uncertainty_stops"] == pytest.approx(np.linalg.norm([*parts.values()]), abs=1e-4)
    curve = response_to_compare(camera[0] / "eos20d.json")
    assert curve.brightness.tolist() == found["response"]["brightness"], "to the last bit"
    lut = read_lut(camera[0] / "eos20d.spi1d")
    np.testing.assert_allclose(lut.values, inverse_response_lut(curve).values, rtol=1e-7)
    assert len(found["weights"]) == 11
    assert [frame["name"] for frame in found["frames"]] == [f"stack_{i:02d}.png" for i in range(6)]
    assert all(frame["used"] and len(frame["offsets_stops"]) == 3 for frame in found["frames"])
    assert found["frames"][0]["iso"] == 100
    assert set(found["comparison"]) == {"estimation_error", "linearization_error", "shape_error", "scale_error"}
    assert found["files"]["linear"] == []


def test_the_config_converts_as_the_lut(camera, stack, oiiotool, tmp_path):
    folder, converted, looked_up = camera[0], tmp_path / "a.exr", tmp_path / "b.exr"
    convert = ("--colorconvert", "CRF eos20d", "scene_linear", "-d", "float", "-o", converted)
    oiiotool("--colorconfig", folder / "config.ocio", stack[3], *convert)
    oiiotool(stack[3], "--ociofiletransform", folder / "eos20d.spi1d", "-d", "float", "-o", looked_up)
    np.testing.assert_allclose(read_image(converted), read_image(looked_up), atol=1e-5)
    config = (folder / "config.ocio").read_text(encoding="utf-8")
    assert "as crfnet measured it from 6 exposures" in config
    assert "stack_00" not in config


def test_times_from_a_list(crfnet, stack, tmp_path):
    times = ",".join(str(2**index) for index in range(6))
    printed = crfnet("calibrate", *stack, "--times", times, "--out", tmp_path, "--no-sheet", "--json").printed
    assert [frame["seconds"] for frame in json.loads(printed)["frames"]] == [1, 2, 4, 8, 16, 32]


@pytest.mark.parametrize(
    ("arguments", "code"), [(("--name", "a/b"), "not_a_file_name"), (("--compare", "none.json"), "not_opened")]
)
def test_bad_input_is_refused(crfnet, stack, tmp_path, arguments, code):
    assert crfnet("calibrate", *stack, "--out", tmp_path / "out", *arguments).refusal == code
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "text",
    ['{"a": 1}', '{"response": {"brightness": [0, 1e999]}}', f'{{"response": {{"brightness": [0, 1{"0" * 400}]}}}}'],
)
def test_a_document_without_a_response_is_refused(tmp_path, text):
    with refused(PlateError, "no_response_in_file"):
        response_to_compare(written(tmp_path / "other.json", text))


def test_what_is_there_stays_there(crfnet, stack, tmp_path):
    (tmp_path / "eos20d.cube").write_text("mine")
    assert crfnet("calibrate", *stack, "--out", tmp_path, "--name", "eos20d").refusal == "file_exists"
    assert tree(tmp_path) == {"eos20d.cube": b"mine"}


@pytest.fixture(scope="module")
def raw_folder(crfnet, root, true_response, tmp_path_factory):
    """A folder with one raw file and its JPEG, measured: the folder, its output, and what was printed."""
    pytest.importorskip("rawpy", reason="raw pairs need the calibrate extra")
    from tests.helpers.pairs import PairOptions, make_pair

    folder = tmp_path_factory.mktemp("raw")
    make_pair(folder, light_of(root / "tests" / "data" / "lights" / "interior.exr"), true_response, PairOptions())
    return folder, crfnet("calibrate", folder, "--out", folder / "out", "--name", "body").printed


def test_a_raw_file_and_its_jpeg_give_the_same_files(raw_folder, true_response):
    folder, out = raw_folder
    assert set(listed(folder / "out")) == {name.replace("eos20d", "body") for name in FILES}
    assert "1 raw file of an unnamed camera, with its JPEG." in out
    assert "were seen; where white is: " in out
    lut = read_lut(folder / "out" / "body.spi1d")
    assert shape_error(true_response, response_of_lut(lut)) < 0.05
    assert any("Measured from 1 raw file" in comment for comment in lut.comments)
    assert read_image(folder / "out" / "body_sheet.png").shape[:2] == (1080, 1800)


def test_the_document_of_a_raw_file_follows_the_schema_and_becomes_a_camera(raw_folder):
    path = raw_folder[0] / "out" / "body.json"
    document = json.loads(path.read_text(encoding="utf-8"))
    assert problems_by(read_schema("calibrate"))(document) == []
    assert document["method"] == "raw pairs"
    camera = read_calibration(path, "Body")
    assert camera.basis.startswith(f"measured from 1 raw file (white {document['white_basis']})")
    assert camera.curve.brightness.tolist() == document["response"]["brightness"]


def test_times_of_a_raw_file_and_a_raw_file_without_its_packages_are_refused(raw_folder, crfnet, tmp_path, monkeypatch):
    arguments = ("calibrate", raw_folder[0] / "shot.dng", "--out", tmp_path / "out", "--no-sheet")
    assert crfnet(*arguments, "--times", "1/60").refusal == "times_of_raw_files"
    monkeypatch.setitem(sys.modules, "rawpy", None)
    assert crfnet(*arguments).refusal == "rawpy_missing"
