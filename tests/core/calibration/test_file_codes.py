"""A camera that clips below the largest code: its response is in the file's codes, as all that is compared with it."""

import numpy as np
import pytest

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.library import Camera, CameraSettings, camera_estimate
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import scale_error, shape_error
from tests.helpers.stacks import StackOptions, emor_response, make_stack

#: The code at which the camera clips, as a part of the largest.
WHITE = 240 / 255


@pytest.fixture(scope="module")
def response():
    return emor_response(100)


@pytest.fixture(scope="module")
def found(light, response, tmp_path_factory):
    return calibrate_stack(make_stack(tmp_path_factory.mktemp("stack"), light, response, StackOptions(white=WHITE)))


def test_a_response_in_file_codes_reaches_white_and_jumps():
    curve = in_file_codes(ResponseCurve.gamma(2), WHITE)
    np.testing.assert_allclose(curve.forward([0.25, 0.81]), [0.5 * WHITE, 0.9 * WHITE], atol=2e-4)
    np.testing.assert_allclose(curve.inverse([0.5 * WHITE, WHITE, 0.98, 1]), [0.25, 1, 1, 1], atol=1e-3)


def test_the_response_leads_from_the_codes_of_the_file_to_light(found, response):
    codes = np.arange(16, 241)
    stops = np.log2(found.curve.inverse(codes / 255) / response.inverse(codes / 240))
    assert found.white == pytest.approx(WHITE)
    assert found.curve.inverse(WHITE) == pytest.approx(1, abs=2e-3)
    assert np.std(stops) < 0.02
    assert abs(np.mean(stops)) < 0.04


def test_the_uncertainties_of_the_response_in_file_codes_hold(found, response):
    true = in_file_codes(response, WHITE)
    assert shape_error(true, found.curve) < 2 * found.uncertainty.shape_stops < 0.1
    assert abs(scale_error(true, found.curve)) < 2 * found.uncertainty.scale_stops < 0.25


def test_the_points_lie_on_the_response_in_file_codes(found):
    stops, brightness, residual, _ = found.points.T
    dark = stops < -0.1
    assert 0.9 < brightness.max() / WHITE <= 1
    on_curve = found.curve.forward(np.exp2(stops[dark]))
    np.testing.assert_allclose(np.median(np.abs(brightness[dark] - on_curve - residual[dark])), 0, atol=2e-3)


def test_the_jump_to_the_largest_code_is_no_uncertainty_of_the_camera(response):
    """E_est of a camera follows from stops by the slope; at the jump that would be 40 times too steep."""
    errors = [
        camera_estimate(Camera("a", curve, 0.02, 0.05, "8 exposures", CameraSettings()))
        for curve in (response, in_file_codes(response, WHITE))
    ]
    assert errors[1].uncertainty == pytest.approx(WHITE * errors[0].uncertainty, rel=0.02)
    assert errors[1].verdict == errors[0].verdict
