import json
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest

from crfnet_core.errors import CameraError
from crfnet_core.library import (
    CameraLibrary,
    camera_document,
    camera_estimate,
    find_camera,
    listed_cameras,
    read_calibration,
)
from crfnet_core.library.camera import read_camera
from crfnet_core.posterior import Verdict
from tests.helpers.cameras import camera
from tests.helpers.folders import written
from tests.helpers.refusals import refusal_of, refused


@pytest.fixture
def library(tmp_path):
    return CameraLibrary(tmp_path / "cameras")


@pytest.fixture
def calibration(tmp_path):
    """The document of a calibration, a7.json."""
    return written(tmp_path / "a7.json", json.dumps(CALIBRATION))


@pytest.fixture
def own(monkeypatch, tmp_path):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path))
    return CameraLibrary.of_user()


def test_what_is_read_is_what_was_written(library):
    first = camera("a", make="SONY", model="ILCE-7M3", software="v2", iso=(100, 400))
    assert (library.save(first), library.get("a")) == (library.folder / "a.json", first)
    assert first.basis == "measured from 6 exposures, ISO 100 to 400"


@pytest.mark.parametrize(
    ("name", "kept"), [("A7  III", "A7 III"), ("写真機 七", "写真機 七"), ("Came\u0301ra (1)", "Caméra (1)")]
)
def test_the_file_is_named_after_the_camera(library, calibration, name, kept):
    assert library.save(read_calibration(calibration, name)).name == f"{kept}.json"
    assert [one.name for one in library.cameras()] == [kept]
    assert library.get(name.upper()).name == kept


@pytest.mark.parametrize(
    "name", ["", " ", "-", ".a", "a/b", "..", "a\\b", "a:b", "a\nb\x07", "a.", "CON", "com1.x", "x" * 61]
)
def test_a_name_that_no_file_can_have_is_refused(tmp_path, name):
    assert refusal_of(CameraError, read_calibration, tmp_path / "a.json", name).code == "bad_camera_name"


def test_a_camera_is_replaced_only_when_asked_and_removed(library):
    library.save(camera("a", iso=(100,)))
    assert refusal_of(CameraError, library.save, camera("A", iso=(200,))).code == "camera_exists"
    assert library.get("a").settings.iso == (100,)
    library.save(camera("A", iso=(200,)), overwrite=True)
    assert [one.settings.iso for one in library.cameras()] == [(200,)]
    library.remove("a")
    assert library.cameras() == []
    assert refusal_of(CameraError, library.remove, "a").code == "no_camera"


DAMAGES = {
    "empty": ("", "not_a_camera"),
    "no object": ("[1, 2]", "not_a_camera"),
    "something else": ('{"kind": "calibration"}', "not_a_camera"),
    "later": ('{"kind": "camera", "camera_version": 2}', "camera_version"),
    "photographs alone": ('{"kind": "camera", "camera_version": 1, "measured": null}', "camera_not_measured"),
    "no entries": ('{"kind": "camera", "camera_version": 1, "measured": {}}', "damaged_camera"),
}
CHANGES = [{"brightness": [0, 1, 0.5]}, {"brightness": 5}, {"shape_stops": -1}, {"warnings": 5}]
CHANGES += [{"scale_stops": stops} for stops in (1e9, True)] + [{"iso": iso} for iso in (5, [0], [True], [1.5])]


@pytest.mark.parametrize(("text", "code"), DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_is_refused_and_hides_no_other(library, text, code):
    path = written(library.save(camera("a")).with_name("b.json"), text)
    assert refusal_of(CameraError, library.get, "b").code == code
    assert [one.name for one in library.cameras()] == ["a"]
    (problem,) = library.problems()
    assert problem.startswith(str(path))


def changed(folder, change):
    """The file of a camera whose measurement has other entries."""
    document = camera_document(camera("a"))
    document["measured"] |= change
    return written(folder / "a.json", json.dumps(document))


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_an_entry_of_another_kind_is_refused(tmp_path, change):
    assert refusal_of(CameraError, read_camera, changed(tmp_path, change)).code == "damaged_camera"


def test_control_characters_of_a_file_are_not_printed(tmp_path):
    change = {"source": "\x1b[31m6 exposures", "model": "\u202eA7", "warnings": ["a\nb"]}
    found = read_camera(changed(tmp_path, change))
    assert (found.source, found.settings.model, found.warnings) == ("?[31m6 exposures", "?A7", ("a b",))


CALIBRATION = {
    "kind": "calibration",
    "camera": {"make": "SONY", "model": "ILCE-7M3", "firmware": "v2"},
    "frames": [{"used": True, "iso": 100.0}, {"used": True, "iso": None}, {"used": False, "iso": 800}],
    "response": {"brightness": np.linspace(0, 1, 1024).tolist()},
    "shape_uncertainty_stops": 0.02,
    "scale_uncertainty_stops": 0.1,
    "warnings": ["few frames"],
}


def test_a_calibration_becomes_a_camera(calibration):
    found = read_calibration(calibration)
    assert (found.name, found.settings.camera) == ("a7", "SONY ILCE-7M3")
    assert found.basis == "measured from 2 exposures, ISO 100"
    assert (found.shape_stops, found.scale_stops, found.warnings) == (0.02, 0.1, ("few frames",))


@pytest.mark.parametrize(
    ("text", "code"),
    [(None, "unreadable_camera"), ("{", "not_a_calibration"), ('{"kind": "calibration"}', "damaged_calibration")],
)
def test_other_files_are_no_calibration(tmp_path, text, code):
    if text is not None:
        written(tmp_path / "a.json", text)
    assert refusal_of(CameraError, read_calibration, tmp_path / "a.json").code == code


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    with refused(CameraError, "camera_folder"):
        CameraLibrary(written(tmp_path / "file", "") / "cameras").save(camera("a"))


def test_a_folder_that_may_not_be_read_has_no_cameras_to_offer(tmp_path, monkeypatch):
    """As the home of another user: no estimate fails for that, but a camera that is asked for by name."""
    monkeypatch.setattr(Path, "glob", Mock(side_effect=PermissionError(13, "Permission denied")))
    library = CameraLibrary(tmp_path)
    assert library.cameras() == []
    assert "Permission denied" in library.problems()[0]
    assert refusal_of(CameraError, library.get, "a").code == "camera_folder"


def test_the_user_s_own_library_is_where_the_variable_or_the_system_says(own, monkeypatch, tmp_path):
    assert own.folder == tmp_path / "cameras"
    monkeypatch.delenv("CRFNET_DATA_DIR")
    monkeypatch.setattr("platformdirs.user_data_path", lambda *_, **__: tmp_path / "share" / "crfnet")
    assert CameraLibrary.of_user().folder == tmp_path / "share" / "crfnet" / "cameras"


def test_the_user_s_own_come_before_those_that_come_with_the_project(own):
    assert find_camera("canon eos 20d") == CameraLibrary.shipped().get("Canon EOS 20D")
    own.save(camera("Canon EOS 20D"))
    assert find_camera("canon eos 20d") == camera("Canon EOS 20D")
    with refused(CameraError, "no_camera", folders=f"{own.folder} or {CameraLibrary.shipped().folder}"):
        find_camera("nobody")


def test_cameras_are_listed_to_choose_from(own):
    for name, model in (("Anna's", "ILCE-7M3"), ("old", "ILCE-7M2")):
        own.save(camera(name, make="SONY", model=model))
    (own.folder / "damaged.json").write_text("{")
    names = [name for name, _ in listed_cameras()]
    assert (names[:2], "Canon EOS 20D" in names) == (["Anna's", "old"], True)
    assert listed_cameras(models=["Sony ILCE-7M2"])[0] == ("old", "measured from 6 exposures")
    assert [name for name, _ in listed_cameras("anna")] == ["Anna's"]


@pytest.fixture(scope="module")
def shipped():
    return CameraLibrary.shipped().cameras()


def test_every_shipped_file_holds_a_measured_response_that_may_be_used(shipped):
    assert CameraLibrary.shipped().problems() == []
    assert len(shipped) >= 20
    for one in shipped:
        estimate = camera_estimate(one)
        assert estimate.verdict is not Verdict.DO_NOT_TRUST
        assert 0 < estimate.shape_uncertainty <= 0.05
        assert one.name.startswith(one.settings.camera)


def test_the_slopes_of_shipped_cameras_do_not_jump(shipped):
    """A plate would get bands: from a code to the next, the stops of a code change by at most a quarter."""
    for one in shipped:
        stops = np.diff(np.log2(one.curve.inverse(np.arange(32, 255) / 255)))
        assert np.abs(np.diff(np.log2(stops))).max() < np.log2(1.25), one.name
