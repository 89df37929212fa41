"""The measured cameras that come with the project."""

import numpy as np
import pytest

from crfnet_core.library import CameraLibrary, CameraSettings, camera_estimate, find_camera, matching_cameras
from crfnet_core.posterior import Verdict


@pytest.fixture(scope="module")
def cameras():
    return CameraLibrary.shipped().cameras()


def test_every_file_holds_a_measured_response_that_may_be_used(cameras):
    assert CameraLibrary.shipped().problems() == []
    assert len(cameras) >= 20
    for camera in cameras:
        estimate = camera_estimate(camera, model="any")
        assert estimate.verdict is not Verdict.DO_NOT_TRUST
        assert 0 < estimate.shape_uncertainty <= 0.05
        assert camera.photographs == ()


def test_every_camera_is_found_by_its_name_and_fits_its_own_make_and_model(cameras):
    for camera in cameras:
        assert find_camera(camera.name.upper()).name == camera.name
        assert camera.name in [found.name for found in matching_cameras(camera.settings)]


@pytest.mark.parametrize(
    ("make", "model", "names"),
    [
        ("NIKON CORPORATION", "NIKON D90", ["NIKON D90 (2)", "NIKON D90 (1)"]),
        ("Canon", "Canon EOS 20D", ["Canon EOS 20D"]),
        ("SONY", "ILCE-7RM2", ["SONY ILCE-7RM2"]),
        ("Canon", "Canon EOS 20Da", []),
    ],
)
def test_the_makers_own_way_of_writing_finds_them(make, model, names):
    assert [camera.name for camera in matching_cameras(CameraSettings(make, model, iso=(400,)))] == names


def test_their_slopes_do_not_jump(cameras):
    """A plate would get bands: from a code to the next, the stops of a code change by at most a quarter."""
    for camera in cameras:
        stops = np.diff(np.log2(camera.measured.curve.inverse(np.arange(32, 255) / 255)))
        assert np.abs(np.diff(np.log2(stops))).max() < np.log2(1.25), camera.name
