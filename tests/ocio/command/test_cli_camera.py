"""`crfnet camera` and `--camera`: responses of cameras, kept to be used again."""

import json

import numpy as np
import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.luts.files import WRITERS, read_lut
from crfnet.luts.response import response_of_lut
from crfnet_core import ResponseCurve
from crfnet_core.files import file_sha256
from crfnet_core.library import CameraLibrary, CameraSettings, MeasuredResponse, add_measured
from crfnet_core.response.metrics import estimation_error
from tests.helpers.cameras import photograph
from tests.helpers.folders import tree
from tests.helpers.images import read_image


@pytest.fixture(autouse=True)
def library(monkeypatch, tmp_path):
    """The user's own library, empty at first."""
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    return CameraLibrary.of_user()


@pytest.fixture
def photos(plate, tmp_path):
    return [photograph(plate, tmp_path / f"IMG_{n}.jpg", seed=n, Exif__PhotographicSensitivity=100) for n in range(3)]


@pytest.fixture
def measured(library):
    """The camera "measured", of a known response."""
    curve = ResponseCurve.gamma(2.0)
    settings = CameraSettings("SONY", "ILCE-7M3", iso=(100,))
    return add_measured(library, "measured", MeasuredResponse(curve, 0.05, 0.1, "6 exposures", settings))


@pytest.fixture
def run(crfnet, fixed_model):
    """Run `crfnet camera`, or another command, with the fixed model; it must succeed."""

    def run_command(command, *arguments, json=False):
        model = () if arguments[0] in ("list", "remove") else ("--model", fixed_model)
        done = crfnet(command, *arguments, *model, *(["--json"] if json else []))
        assert (done.code, done.err) == (0, "")
        return done.out

    return run_command


def test_photographs_are_added_shown_and_removed(run, photos, library):
    out = run("camera", "add", "A7 III", *photos[:2])
    assert f"Kept in {library.folder}." in out
    assert "A7 III: SONY ILCE-7M3; estimated from 2 photographs, ISO 100" in out
    out = run("camera", "add", "a7 iii", *photos[1:])
    assert "IMG_1.jpg is there already and counts once." in out
    assert 'Response of the camera "A7 III", estimated from 3 photographs, ISO 100.' in out
    assert "  A7 III: SONY ILCE-7M3; estimated from 3 photographs, ISO 100\n" in run("camera", "list")
    shown = run("camera", "show", "A7 III")
    assert "  IMG_0.jpg, ISO 100: its own estimate is 0." in shown
    assert "Warning" not in shown
    assert "Now estimated from 2 photographs" in run("camera", "remove", "A7 III", "IMG_1.jpg")
    assert "Removed: A7 III." in run("camera", "remove", "A7 III")
    assert library.cameras() == []


def test_the_same_as_json(run, photos, library):
    document = json.loads(run("camera", "add", "A7 III", *photos, json=True))
    assert (document["name"], document["make"], document["iso"]) == ("A7 III", "SONY", [100])
    assert [photo["agrees"] for photo in document["photographs"]] == [True] * 3
    assert document["estimate"]["camera"]["basis"] == "estimated from 3 photographs, ISO 100"
    listed = json.loads(run("camera", "list", json=True))
    assert listed["folder"] == str(library.folder)
    assert [camera["name"] for camera in listed["cameras"]] == ["A7 III"]
    assert json.loads(run("camera", "show", "A7 III", json=True)) == document
    removed = json.loads(run("camera", "remove", "A7 III", "IMG_0.jpg", json=True))
    assert removed["camera"]["photographs"] == 2


def test_a_damaged_file_is_a_note_of_the_list(run, measured, library):
    (library.folder / "damaged.json").write_text("{")
    out = run("camera", "list")
    assert "  measured: SONY ILCE-7M3; measured from 6 exposures, ISO 100\n" in out
    assert f"note: {library.folder / 'damaged.json'}: is not JSON; restore or remove it\n" in out


def test_a_calibration_becomes_a_camera(crfnet, run, root, true_response, tmp_path, library):
    from tests.helpers.stacks import StackOptions, light_of, make_stack

    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::2, ::2]
    (tmp_path / "stack").mkdir()
    header = {"Make": "Canon", "Model": "Canon EOS 20D", "Exif__PhotographicSensitivity": 100}
    frames = make_stack(tmp_path / "stack", light, true_response, StackOptions(frames=6, quality=0), **header)
    done = crfnet("calibrate", *frames, "--out", tmp_path / "look", "--name", "eos20d", "--no-sheet")
    assert (done.code, done.err) == (0, "")
    document = json.loads((tmp_path / "look" / "eos20d.json").read_text(encoding="utf-8"))
    out = run("camera", "add", "20D", "--from-calibration", tmp_path / "look" / "eos20d.json")
    assert "20D: Canon EOS 20D; measured from 6 exposures, ISO 100" in out
    kept = library.get("20D").measured
    assert kept.shape_stops == document["shape_uncertainty_stops"]
    assert np.allclose(kept.curve.brightness, document["response"]["brightness"], atol=1e-4)


def test_a_photograph_that_disagrees_is_reported_with_what_to_do(run, measured, photos, library):
    add_measured(library, "flat", MeasuredResponse(ResponseCurve.gamma(4), 0.05, 0.05, "6 exposures", CameraSettings()))
    out = run("camera", "add", "flat", photos[0])
    assert "Warning: IMG_0.jpg disagrees" in out
    assert "crfnet camera remove flat IMG_0.jpg" in out


def test_the_command_that_is_reported_takes_out_one_of_two_namesakes(run, photos, tmp_path, library):
    add_measured(library, "flat", MeasuredResponse(ResponseCurve.gamma(4), 0.05, 0.05, "6 exposures", CameraSettings()))
    (tmp_path / "day 2").mkdir()
    namesake = photos[1].rename(tmp_path / "day 2" / photos[0].name)
    out = run("camera", "add", "flat", photos[0], namesake)
    key = file_sha256(namesake)[:8]
    assert f"Warning: IMG_0.jpg (SHA-256 {key}) disagrees" in out
    assert f"  IMG_0.jpg (SHA-256 {key}), ISO 100: " in out
    assert f": crfnet camera remove flat {key}\n" in out
    run("camera", "remove", "flat", key)
    (left,) = library.get("flat").photographs
    assert left.sha256 == file_sha256(photos[0])


def test_a_camera_that_comes_with_crfnet_cannot_be_removed(crfnet):
    for photographs in ([], ["IMG_0.jpg"]):
        done = crfnet("camera", "remove", "Canon EOS 20D", *photographs)
        assert (done.code, done.err) == (
            BAD_INPUT,
            "crfnet: error: 'Canon EOS 20D' is a measured camera that comes with crfnet; it cannot be changed or"
            " removed\n",
        )


def test_an_estimate_uses_a_camera_that_is_asked_for(run, measured, photos, tmp_path):
    out = run("estimate", photos[0], "--camera", "measured", "--out", tmp_path / "look", "--no-sheet")
    assert 'Response of the camera "measured", measured from 6 exposures, ISO 100; the photographs\' own' in out
    lut = read_lut(tmp_path / "look" / "IMG_0.spi1d")
    assert estimation_error(response_of_lut(lut), measured.measured.curve) < 0.01
    assert any('camera "measured"' in comment for comment in lut.comments)
    document = json.loads((tmp_path / "look" / "IMG_0.json").read_text(encoding="utf-8"))
    assert document["camera"]["name"] == "measured"
    assert "known_cameras" not in document


def test_the_sheet_is_drawn_with_a_camera(run, measured, photos, tmp_path):
    pytest.importorskip("matplotlib")
    run("estimate", photos[0], "--camera", "measured", "--out", tmp_path / "look")
    assert (tmp_path / "look" / "IMG_0_sheet.png").stat().st_size > 10_000


def test_a_camera_that_fits_is_offered_but_not_used(run, measured, photos, tmp_path):
    out = run("estimate", photos[0], "--out", tmp_path / "look", "--no-sheet")
    assert "A response of this camera is known; to use it, add --camera measured (measured from 6 exposures" in out
    document = json.loads((tmp_path / "look" / "IMG_0.json").read_text(encoding="utf-8"))
    assert document["camera"] is None
    (offer,) = document["known_cameras"]
    assert (offer["name"], offer["is_measured"]) == ("measured", True)
    quiet = run("estimate", photos[0], "--out", tmp_path / "quiet", "--no-sheet", "--ignore-metadata")
    assert "is known" not in quiet


def test_each_photograph_gets_the_response_of_the_camera(run, measured, photos, tmp_path):
    out = run("estimate", *photos, "--each", "--camera", "measured", "--out", tmp_path / "all", "--no-sheet")
    assert out.count("usable") + out.count("good") >= 3
    luts = [read_lut(tmp_path / "all" / f"IMG_{n}.spi1d").values for n in range(3)]
    assert np.array_equal(luts[0], luts[1])
    assert np.array_equal(luts[0], luts[2])


def test_plates_are_linearized_with_a_camera_as_with_its_exported_lut(run, crfnet, measured, photos, tmp_path):
    out = run("linearize", photos[0], "--camera", "measured", "--out", tmp_path / "a.exr", "--depth", "float")
    assert 'Response of the camera "measured".' in out
    run("camera", "export", "measured", tmp_path / "measured.spi1d")
    lut = ("--lut", tmp_path / "measured.spi1d")
    assert crfnet("linearize", photos[0], *lut, "--out", tmp_path / "b.exr", "--depth", "float").code == 0
    assert np.array_equal(read_image(tmp_path / "a.exr"), read_image(tmp_path / "b.exr"))


@pytest.mark.parametrize("suffix", WRITERS)
def test_a_response_is_exported_in_every_format(run, crfnet, measured, tmp_path, suffix):
    path = tmp_path / f"measured{suffix}"
    assert f"Written: {path}." in run("camera", "export", "measured", path)
    assert crfnet("info", path).code == 0
    assert crfnet("camera", "export", "measured", path).code == BAD_INPUT


def test_a_camera_is_handed_on_as_a_file(run, measured, library, tmp_path, monkeypatch):
    run("camera", "export", "measured", tmp_path / "given.json")
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "of another"))
    (tmp_path / "of another" / "cameras").mkdir(parents=True)
    (tmp_path / "given.json").rename(tmp_path / "of another" / "cameras" / "given.json")
    assert CameraLibrary.of_user().get("measured").measured == measured.measured


@pytest.mark.parametrize(
    "arguments", [["remove", "nobody"], ["remove", "nobody", "a.jpg"], ["show", "nobody"], ["list"]]
)
def test_asking_makes_no_library(crfnet, tmp_path, arguments):
    crfnet("camera", *arguments)
    assert list(tmp_path.iterdir()) == []


BAD = {
    "neither": ["camera", "add", "a"],
    "both": ["camera", "add", "a", "{photo}", "--from-calibration", "{photo}"],
    "no calibration": ["camera", "add", "a", "--from-calibration", "{photo}"],
    "absent calibration": ["camera", "add", "a", "--from-calibration", "none.json"],
    "absent photograph": ["camera", "add", "a", "none.jpg"],
    "unreadable name": ["camera", "add", "\n", "{photo}"],
    "absent to show": ["camera", "show", "nobody"],
    "absent to remove": ["camera", "remove", "nobody"],
    "absent to export": ["camera", "export", "nobody", "a.spi1d"],
    "unknown format": ["camera", "export", "measured", "a.xyz"],
    "absent to estimate": ["estimate", "{photo}", "--out", "look", "--camera", "nobody"],
    "absent to estimate each": ["estimate", "{photo}", "--each", "--out", "look", "--camera", "nobody"],
    "absent to linearize": ["linearize", "{photo}", "--out", "a.exr", "--camera", "nobody"],
    "a LUT, too": ["linearize", "{photo}", "--out", "a.exr", "--camera", "measured", "--lut", "a.spi1d"],
    "no action": ["camera"],
}


@pytest.mark.parametrize("arguments", BAD.values(), ids=BAD)
def test_a_mistake_is_one_line_and_changes_nothing(crfnet, measured, photos, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    before = tree(tmp_path)
    done = crfnet(*(argument.replace("{photo}", str(photos[0])) for argument in arguments))
    assert (done.code, done.out, done.err.count("\n")) == (BAD_INPUT, "", 1)
    assert done.err.startswith("crfnet: error: ")
    assert tree(tmp_path) == before
