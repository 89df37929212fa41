import numpy as np
import pytest

from crfnet_core.calibration.exposures import ExposureLabel, parse_times, stack_exposures
from crfnet_core.errors import CalibrationError
from tests.helpers.refusals import refusal_of


def of_times(*seconds):
    return stack_exposures([ExposureLabel(time) for time in seconds])


@pytest.mark.parametrize(
    ("times", "step"),
    [
        ((1 / 125, 1 / 60, 1 / 30, 1 / 15), 1),  # 1/60 s is 2^-6 s, 1/15 s is 2^-4 s
        ((1 / 60, 1 / 50, 1 / 40, 1 / 30), 1 / 3),
        ((1 / 60, 1 / 45, 1 / 30, 1 / 20), 1 / 2),
        ((4, 5, 6, 8), 1 / 3),
    ],
)
def test_nominal_times_stand_for_powers_of_two(times, step):
    found = of_times(*times)
    np.testing.assert_allclose(np.diff(found.snapped), step)
    np.testing.assert_allclose(np.diff(found.nominal), np.diff(np.log2(times)))


def test_times_of_no_steps_stay_as_they_are():
    assert of_times(1 / 60, 1 / 56, 1 / 30, 1 / 15).snapped is None


def test_iso_and_aperture_count():
    """ISO 200 doubles the exposure, f/11 halves the exposure of f/8: log2(11 / 8) * 2 is 0.92, and stands for 1."""
    labels = [ExposureLabel(1.0, 8.0, 100.0), ExposureLabel(1.0, 8.0, 200.0), ExposureLabel(1.0, 11.0, 200.0)]
    found = stack_exposures(labels)
    np.testing.assert_allclose(np.diff(found.snapped), [1, -1])
    np.testing.assert_allclose(np.diff(found.nominal), [1, -2 * np.log2(11 / 8)])
    assert found.differing == ("ISO", "aperture")


def test_times_are_read_from_a_list():
    assert parse_times("1/60, 0.5s,2") == pytest.approx((1 / 60, 0.5, 2))


@pytest.mark.parametrize("text", ["", "1/0", "fast", "-1", "nan", "inf", "1/60,"])
def test_a_text_that_is_not_a_time_is_refused(text):
    assert refusal_of(CalibrationError, parse_times, text).code == "bad_seconds"
