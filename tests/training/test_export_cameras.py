import csv
import re

import numpy as np
import pytest

from crfnet_core import ResponseCurve
from crfnet_core.library import camera_estimate
from crfnet_core.response.metrics import shape_error
from tests.helpers.pairs import PairOptions, make_pair
from tests.helpers.stacks import light_of
from training.export.cameras import measured_cameras

ROW = {
    "id": "a",
    "stack": "a",
    "body": "NIKON D90",
    "use": "yes",
    "uncertainty_L2": "0.5",
    "grade": "A",
    "n_frames": "11",
    "exif_make": "NIKON CORPORATION",
    "exif_model": "NIKON D90",
    "exif_software": "Ver.1.00",
    "iso": "200.0",
    "original_size": "2144x1424",
    "gt": "gt/2.2.csv",
}


@pytest.fixture
def cameras(tmp_path):
    """The cameras of some rows that differ from `ROW`: cameras({"stack": "b"}, ...)."""
    folder = tmp_path / "real_bodies"
    (folder / "gt").mkdir(parents=True)
    for gamma in (1.8, 2.2, 2.21):
        curve = ResponseCurve.gamma(gamma)
        table = np.stack([curve.irradiance, curve.brightness], axis=1)
        np.savetxt(folder / "gt" / f"{gamma}.csv", table, delimiter=",", header="irradiance,response", comments="")

    def of_rows(*changes):
        with (folder / "cases.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, ROW)
            writer.writeheader()
            writer.writerows(ROW | change for change in changes)
        return measured_cameras(tmp_path)

    return of_rows


def test_a_stack_becomes_a_camera_with_the_uncertainty_of_its_measurement(cameras):
    (camera,) = cameras({})
    assert (camera.name, camera.basis) == ("NIKON D90", "measured from 11 exposures, ISO 200")
    assert camera_estimate(camera).uncertainty == pytest.approx(0.5, abs=0.01)
    assert camera.shape_stops == 0.05


def test_stacks_that_agree_are_one_setting_of_which_the_most_certain_is_kept(cameras):
    other = {"stack": "b", "gt": "gt/2.21.csv", "uncertainty_L2": "0.3", "iso": "800"}
    (camera,) = cameras({}, other)
    assert camera.basis == "measured from 11 exposures (the best of 2 stacks), ISO 200 to 800"
    assert camera.scale_stops < camera.shape_stops


def test_stacks_that_differ_are_settings_of_their_own(cameras):
    found = cameras({"stack": "b", "gt": "gt/1.8.csv", "uncertainty_L2": "0.6"}, {})
    assert [camera.name for camera in found] == ["NIKON D90 (1)", "NIKON D90 (2)"]
    assert found[1].curve.brightness[512] == pytest.approx(ResponseCurve.gamma(1.8).brightness[512], abs=1e-4)


@pytest.mark.parametrize(
    "change",
    [
        {"grade": "C"},
        {"use": "caution: edited/developed by software"},
        {"exif_software": "Adobe Photoshop CS6"},
        {"body": "unknown someone/pictures", "exif_make": "", "exif_model": ""},
    ],
)
def test_what_is_uncertain_developed_or_unknown_is_left_out(cameras, change):
    assert cameras(change) == []


def test_a_reason_for_caution_is_kept(cameras):
    (camera,) = cameras({"use": "caution: few frames", "exif_make": "", "exif_model": ""})
    assert camera.warnings == ("measured with caution: few frames",)
    assert camera.settings.camera == "NIKON D90"


def test_raw_files_become_a_camera(tmp_path, root, true_response):
    folder = tmp_path / "raw_pairs"
    (tmp_path / "real_bodies").mkdir()
    (tmp_path / "real_bodies" / "cases.csv").write_text(",".join(ROW) + "\n")
    folder.mkdir()
    scene = light_of(root / "tests" / "data" / "lights" / "interior.exr")
    for number in (1, 2):
        make_pair(folder, scene, true_response, PairOptions(seed=number, brightest=97.5 + number), f"{number}")
    (camera,) = measured_cameras(tmp_path)
    assert re.fullmatch(r"2 raw files \(white by .+\)", camera.source)
    assert shape_error(true_response, camera.curve) < camera.shape_stops
