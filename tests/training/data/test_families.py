import numpy as np
import pytest

from crfnet_core.posterior import Family
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.metrics import shape_error
from training.data.curves import CurveSource
from training.data.families import DEVELOPED_HEADROOM, SHOULDER, developed, draw_responses, edited, with_headroom

#: Powers that stand for the in-camera responses of a kind.
POWERS = {Family.PHONE: 0.4, Family.COMPACT: 0.45, Family.CAMERA: 0.5}


@pytest.mark.parametrize("family", [family for family in Family if family is not Family.UNEXPLAINED])
def test_responses_of_every_family_rise_from_0_to_1(family):
    film = CurveSource(UNIFORM ** np.array([[0.3], [0.7]]), (), camera_fraction=0).draw

    def in_camera(family, count, rng):
        return np.tile(UNIFORM ** POWERS[family], (count, 1))

    drawn, again = (
        draw_responses(family, 20, np.random.default_rng(0), in_camera=in_camera, film=film) for _ in range(2)
    )
    assert drawn.shape == (20, 1024)
    assert (np.diff(drawn, axis=1) >= -1e-12).all()
    np.testing.assert_allclose(drawn[:, [0, -1]], [[0, 1]] * 20, atol=1e-9)
    np.testing.assert_array_equal(drawn, again)


def test_most_edits_are_small_and_a_few_are_large():
    before = np.tile(UNIFORM**0.45, (300, 1))
    after = edited(before, np.random.default_rng(1))
    start = ResponseCurve.from_samples(before[0])
    errors = np.array([shape_error(start, ResponseCurve.from_samples(row)) for row in after])
    assert np.median(errors) < 0.3
    assert errors.max() > 3 * np.median(errors)
    assert errors.min() > 0


@pytest.mark.parametrize("stops", [0.0, 0.5, 1.0, -0.1])
def test_headroom_divides_the_irradiance_below_the_shoulder_and_keeps_white(stops):
    curve = ResponseCurve.from_samples(1 - (1 - UNIFORM**0.6) ** 2)
    found = with_headroom(curve, stops)
    below = np.array([0.3, 0.5, 0.9])
    np.testing.assert_allclose(found.inverse(below), curve.inverse(below) / 2**stops, rtol=0.01)
    assert found.inverse(1.0) == pytest.approx(1)
    assert (np.diff(found.inverse(np.linspace(SHOULDER, 1, 20))) > 0).all()
    assert shape_error(curve, found) < 0.01


def test_developed_responses_have_more_headroom_and_the_same_shape():
    before = 1 - (1 - UNIFORM[None] ** np.array([[0.6], [0.7]])) ** 2
    for first, second in zip(before, developed(before), strict=True):
        camera, program = (ResponseCurve.from_samples(row) for row in (first, second))
        assert np.log2(camera.inverse(0.5) / program.inverse(0.5)) == pytest.approx(DEVELOPED_HEADROOM, abs=0.01)
        assert shape_error(camera, program) < 0.01
