"""The stored cameras that the add-on offers."""

import pytest

from blender_addon.work.errors import AddonError
from blender_addon.work.wording import problem_line
from crfnet_core import ResponseCurve
from crfnet_core.errors import CameraError
from crfnet_core.library import CameraLibrary, CameraSettings, MeasuredResponse, add_measured, listed_cameras


@pytest.fixture(autouse=True)
def library(monkeypatch, tmp_path):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path))
    library = CameraLibrary.of_user()
    for name, model in (("Anna's", "ILCE-7M3"), ("old", "ILCE-7M2")):
        measured = MeasuredResponse(ResponseCurve.gamma(), 0.05, 0.1, "6 exposures", CameraSettings("SONY", model))
        add_measured(library, name, measured)
    return library


def test_the_user_s_own_come_before_those_that_come_with_the_add_on():
    names = [name for name, _ in listed_cameras()]
    assert names[:2] == ["Anna's", "old"]
    assert "Canon EOS 20D" in names
    assert ("old", "measured from 6 exposures") in listed_cameras()


def test_cameras_of_the_plate_s_make_and_model_come_first():
    assert listed_cameras(models=["Sony ILCE-7M2"])[0][0] == "old"
    assert listed_cameras(models=["Canon EOS 20D"])[0][0] == "Canon EOS 20D"


def test_a_text_narrows_them():
    assert [name for name, _ in listed_cameras("anna")] == ["Anna's"]
    assert listed_cameras("nobody's") == []


def test_a_damaged_file_hides_no_other(library):
    (library.folder / "damaged.json").write_text("{")
    assert "old" in [name for name, _ in listed_cameras()]


def test_an_unknown_camera_is_told_in_words_of_the_interface(library):
    with pytest.raises(CameraError) as problem:
        library.get("nobody")
    assert "nobody" in problem_line(problem.value)
    assert not issubclass(CameraError, AddonError)
