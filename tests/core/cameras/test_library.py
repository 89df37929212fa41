"""The library of cameras: files, names, damage, and two writers at once."""

import json
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from crfnet_core import ResponseCurve
from crfnet_core.errors import CameraError
from crfnet_core.library import Camera, CameraLibrary, CameraSettings, MeasuredResponse, add_measured, find_camera
from crfnet_core.library import library as library_module
from crfnet_core.library.documents import camera_document, read_calibration


def measured(**settings):
    return MeasuredResponse(ResponseCurve.gamma(), 0.05, 0.1, "6 exposures", CameraSettings(**settings))


@pytest.fixture
def library(tmp_path):
    return CameraLibrary(tmp_path / "cameras")


NAMES = ("A7 III", "../../etc/passwd", "a/b\\c", "CON", "写真機 七", "é" * 100, "a: *?", "-")


@pytest.mark.parametrize("name", NAMES)
def test_any_printable_name_is_kept_in_one_plain_file_of_the_folder(library, tmp_path, name):
    add_measured(library, name, measured())
    (path,) = (path for path in tmp_path.rglob("*") if path.is_file())
    assert path.parent == library.folder
    assert path.name.isascii()
    assert all(sign.isalnum() or sign in "-." for sign in path.name)
    assert path.stem.upper() not in ("CON", "NUL", "AUX", "PRN")
    assert [camera.name for camera in library.cameras()] == [name]


def test_names_that_are_written_alike_have_files_of_their_own(library):
    for name in ("a b", "a-b", "a/b"):
        add_measured(library, name, measured())
    assert len(library.cameras()) == 3


def test_a_name_is_found_in_upper_and_lower_case_and_in_decomposed_form(library):
    add_measured(library, "Caméra A7", measured())
    for name in ("caméra a7", "CAME\u0301RA  A7 "):
        assert library.get(name).name == "Caméra A7"


@pytest.mark.parametrize("name", ["", "  ", "a\nb\x07", "x" * 101])
def test_a_name_that_nobody_can_read_is_refused(library, name):
    with pytest.raises(CameraError, match="is no name for a camera"):
        add_measured(library, name, measured())
    assert not library.folder.exists()


def test_what_is_read_is_what_was_written(library):
    camera = add_measured(library, "a", measured(make="SONY", model="ILCE-7M3", software="v2", iso=(100, 400)))
    assert camera_document(library.get("a")) == camera_document(camera)
    assert library.get("a").measured == camera.measured


def test_a_measured_response_is_replaced_only_when_asked(library):
    add_measured(library, "a", measured(iso=(100,)))
    with pytest.raises(CameraError, match="has a measured response; give another name, or --overwrite"):
        add_measured(library, "a", measured(iso=(200,)))
    assert library.get("a").settings.iso == (100,)
    assert add_measured(library, "a", measured(iso=(200,)), overwrite=True).settings.iso == (200,)


def test_another_make_or_model_is_refused(library):
    add_measured(library, "a", measured(make="SONY", model="ILCE-7M3"))
    camera = library.get("a")
    camera.check_same(CameraSettings("Sony", "ilce-7m3"), "one.jpg")
    camera.check_same(CameraSettings(), "unknown.jpg")
    with pytest.raises(CameraError, match=r"two.jpg is of SONY ILCE-7M2, but 'a' is SONY ILCE-7M3"):
        camera.check_same(CameraSettings("SONY", "ILCE-7M2"), "two.jpg")


DAMAGES = {
    "empty": "",
    "cut short": '{"kind": "camera", "camera_ver',
    "no object": "[1, 2]",
    "something else": '{"kind": "calibration"}',
    "later": '{"kind": "camera", "camera_version": 2}',
    "without photographs": '{"kind": "camera", "camera_version": 1, "name": "b", "measured": null}',
    "a name that is none": '{"kind": "camera", "camera_version": 1, "name": 3, "measured": null, "photographs": []}',
    "nested too deeply": "[" * 100_000,
}


@pytest.mark.parametrize("content", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_hides_no_other_camera(library, content):
    add_measured(library, "a", measured())
    (library.folder / "b.json").write_text(content, encoding="utf-8")
    assert [camera.name for camera in library.cameras()] == ["a"]
    (problem,) = library.problems()
    assert "b.json" in problem
    assert "\n" not in problem
    with pytest.raises(CameraError, match=r"no camera 'b'.*b\.json"):
        library.get("b")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"camera_version": 2}, "has camera_version 2, this crfnet reads 1: update it"),
        ({"photographs": [{}]}, "is damaged .*; restore or remove it"),
        ({"name": "b"}, "holds the camera 'b', not 'A'; rename the file"),
    ],
    ids=["later", "damaged", "another camera"],
)
def test_a_file_that_is_not_read_as_the_camera_of_its_name_is_never_replaced(library, change, message):
    add_measured(library, "a", measured())
    (path,) = library.folder.glob("*.json")
    content = json.dumps(json.loads(path.read_text(encoding="utf-8")) | change)
    path.write_text(content, encoding="utf-8")
    for write in (library.save, lambda camera: add_measured(library, camera.name, measured(), overwrite=True)):
        with pytest.raises(CameraError, match=message):
            write(Camera("A"))
    assert path.read_text(encoding="utf-8") == content


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("brightness", [0, 1]),
        ("brightness", None),
        ("brightness", [0, 10**400]),
        ("shape_stops", -1),
        ("shape_stops", 10**400),
        ("scale_stops", "NaN"),
        ("iso", ["x"]),
        ("iso", [0]),
        ("iso", [100, 10**400]),
    ],
)
def test_numbers_that_describe_no_response_are_found_out(library, name, value):
    add_measured(library, "a", measured())
    (path,) = library.folder.glob("*.json")
    document = json.loads(path.read_text(encoding="utf-8"))
    document["measured"][name] = value
    path.write_text(json.dumps(document), encoding="utf-8")
    assert library.cameras() == []
    assert "is damaged" in library.problems()[0]


@pytest.mark.parametrize(
    "change",
    [
        {"shape_uncertainty_stops": 10**400},
        {"response": {"brightness": [0, 10**400]}},
        {"frames": [{"used": True, "iso": 10**400}]},
        {"frames": [{"used": True, "iso": 0.3}]},
    ],
)
def test_numbers_of_a_calibration_that_cannot_be_are_one_clear_line(tmp_path, change):
    document = {
        "kind": "calibration",
        "frames": [{"used": True, "iso": 100}],
        "camera": {"make": "SONY", "model": "ILCE-7M3", "firmware": ""},
        "response": {"brightness": ResponseCurve.gamma().brightness.tolist()},
        "shape_uncertainty_stops": 0.05,
        "scale_uncertainty_stops": 0.1,
        "warnings": [],
    }
    path = tmp_path / "a.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    assert read_calibration(path).settings.iso == (100,)
    path.write_text(json.dumps(document | change), encoding="utf-8")
    with pytest.raises(CameraError, match=r"a\.json: is damaged \(.*\); calibrate again"):
        read_calibration(path)


def test_a_file_of_any_name_is_a_camera_of_the_library(library, tmp_path):
    """To hand a camera on, its file is copied."""
    add_measured(CameraLibrary(tmp_path / "other"), "a", measured())
    (path,) = (tmp_path / "other").glob("*.json")
    library.folder.mkdir()
    path.rename(library.folder / "from Anna.json")
    assert library.get("a").measured
    add_measured(library, "a", measured(iso=(200,)), overwrite=True)
    assert [path.name for path in library.folder.glob("*.json")] == ["from Anna.json"]
    library.remove("A")
    assert library.cameras() == []


def test_of_two_who_write_at_once_neither_loses_anything(library):
    start = threading.Barrier(8)

    def add(number):
        start.wait()
        add_measured(library, f"camera {number}", measured())

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(add, range(8)))
    assert len(library.cameras()) == 8
    assert not (library.folder / ".lock").exists()


def test_a_lock_that_nobody_gives_back_is_named(library, monkeypatch):
    monkeypatch.setattr(library_module, "LOCK_SECONDS", 0.1)
    library.folder.mkdir()
    (library.folder / ".lock").touch()
    with pytest.raises(CameraError, match=r"\.lock: another crfnet changes the library; if none runs, remove"):
        add_measured(library, "a", measured())


def test_the_folder_may_be_given_as_text(tmp_path):
    assert CameraLibrary(str(tmp_path)) == CameraLibrary(tmp_path)
    assert CameraLibrary(str(tmp_path)).cameras() == []


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(CameraError, match="CRFNET_DATA_DIR"):
        add_measured(CameraLibrary(tmp_path / "file" / "cameras"), "a", measured())


def test_the_user_s_own_library_is_where_the_variable_or_the_system_says(monkeypatch, tmp_path):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path))
    assert CameraLibrary.of_user().folder == tmp_path / "cameras"
    monkeypatch.delenv("CRFNET_DATA_DIR")
    monkeypatch.setattr("platformdirs.user_data_path", lambda *_, **__: tmp_path / "share" / "crfnet")
    assert CameraLibrary.of_user().folder == tmp_path / "share" / "crfnet" / "cameras"


def test_a_camera_that_is_not_there_is_named():
    with pytest.raises(CameraError, match="no camera 'nobody'"):
        find_camera("nobody")


def test_a_new_camera_knows_nothing():
    assert Camera("a").settings == CameraSettings()
    assert Camera("a").basis == "estimated from 0 photographs"
