import numpy as np
import pytest

from crfnet_core.library import CameraLibrary, camera_estimate
from crfnet_core.posterior import Verdict


@pytest.fixture(scope="module")
def cameras():
    return CameraLibrary.shipped().cameras()


def test_every_file_holds_a_measured_response_that_may_be_used(cameras):
    assert CameraLibrary.shipped().problems() == []
    assert len(cameras) >= 20
    for camera in cameras:
        estimate = camera_estimate(camera)
        assert estimate.verdict is not Verdict.DO_NOT_TRUST
        assert 0 < estimate.shape_uncertainty <= 0.05
        assert camera.name.startswith(camera.settings.camera)


def test_their_slopes_do_not_jump(cameras):
    """A plate would get bands: from a code to the next, the stops of a code change by at most a quarter."""
    for camera in cameras:
        stops = np.diff(np.log2(camera.curve.inverse(np.arange(32, 255) / 255)))
        assert np.abs(np.diff(np.log2(stops))).max() < np.log2(1.25), camera.name
