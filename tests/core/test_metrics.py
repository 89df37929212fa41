import numpy as np
import pytest

from crfnet_core.response.curve import SAMPLES, UNIFORM, ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, scale_error, shape_error

STRAIGHT = ResponseCurve.from_samples([0.0, 1.0])
SQUARE = ResponseCurve.gamma(0.5)


def test_estimation_error_of_two_known_curves():
    """The L2 distance of E and E ** 2: sqrt(1024 * integral of (x - x^2)^2) = sqrt(1024 / 30)."""
    assert estimation_error(STRAIGHT, SQUARE) == pytest.approx(np.sqrt(SAMPLES / 30), rel=2e-3)
    assert estimation_error(STRAIGHT, STRAIGHT) == 0
    assert estimation_error(STRAIGHT, SQUARE) == estimation_error(SQUARE, STRAIGHT)


def test_linearization_error_of_known_pixels():
    """By hand: B = 0.25 is E = 0.25 on the straight line, and 0.5 on the square."""
    assert linearization_error([0.25, 1.0], STRAIGHT, SQUARE) == pytest.approx(0.25 / np.sqrt(2), abs=1e-3)


def test_counts_stand_for_repeated_pixels():
    pixels = np.array([0.1, 0.1, 0.1, 0.6, 0.9, 0.9])
    counted = linearization_error([0.1, 0.6, 0.9, 1.0], STRAIGHT, SQUARE, counts=[3, 1, 2, 0])
    assert counted == pytest.approx(linearization_error(pixels, STRAIGHT, SQUARE), rel=1e-12)


def test_the_shape_error_of_two_powers():
    """By hand: log2(B ** 2 / B) = log2(B), whose spread over the codes 16 to 240 is a sum of logarithms."""
    codes = np.arange(16, 241)
    assert shape_error(STRAIGHT, SQUARE) == pytest.approx(np.std(np.log2(codes)) / 2, rel=2e-2)


def test_the_shape_error_ignores_the_exposure_which_is_the_scale_error():
    """f(E) = 2 E until it clips: the linear light of codes below white is off by one stop everywhere."""
    clipped = ResponseCurve.from_samples(np.minimum(2 * UNIFORM, 1))
    assert estimation_error(STRAIGHT, clipped) > 5
    assert shape_error(STRAIGHT, clipped) < 2e-3
    assert scale_error(STRAIGHT, clipped) == pytest.approx(-1, abs=2e-3)
    assert scale_error(clipped, STRAIGHT) == pytest.approx(1, abs=2e-3)
