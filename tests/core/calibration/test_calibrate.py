import numpy as np
import pytest

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.exposures import ExposureLabel, parse_times, stack_exposures
from crfnet_core.errors import CalibrationError
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, scale_error, shape_error
from tests.helpers.refusals import refusal_of
from tests.helpers.stacks import StackOptions, emor_response, label_seconds, light_of, make_stack, opencv_response

#: The largest shape error allowed, in stops.
SHAPE = 0.05


@pytest.fixture(scope="module")
def plain(true_response, light, tmp_path_factory):
    """A stack of 8 JPEG frames, a stop apart, and what is measured on it."""
    paths = make_stack(tmp_path_factory.mktemp("stack"), light, true_response, StackOptions())
    return paths, calibrate_stack(paths)


def test_the_response_is_measured_and_its_uncertainties_hold(plain, true_response):
    """Within two standard deviations, neither of which is so large that this says nothing."""
    found = plain[1]
    assert (found.reaches_white, found.warnings) == (True, ())
    assert found.residual < 1.5
    assert shape_error(true_response, found.curve) < min(SHAPE, 2 * found.uncertainty.shape_stops) < 0.1
    assert abs(scale_error(true_response, found.curve)) < 2 * found.uncertainty.scale_stops < 0.25


def test_texture_does_not_hide_where_white_is(tmp_path, root):
    """In foliage the samples become white gradually: the scale was off by three standard deviations."""
    true, light = emor_response(103), light_of(root / "tests" / "data" / "lights" / "forest.exr")
    found = calibrate_stack(make_stack(tmp_path, light, true, StackOptions(frames=4, step=6)))
    assert abs(scale_error(true, found.curve)) < min(0.15, 2 * found.uncertainty.scale_stops)


def test_offsets_of_frames_are_found(plain):
    """Labels say 1/60 s where the exposure is 2^-6 s: read so, no frame is far from its label."""
    frames = plain[1].frames
    assert plain[1].labels == "exact powers of two"
    assert all(frame.is_used for frame in frames)
    assert np.abs([frame.offsets for frame in frames]).max() < 0.03
    np.testing.assert_allclose(np.diff([frame.stops for frame in frames]), 1)


@pytest.mark.parametrize(
    "options",
    [{"frames": 9, "step": 1}, {"frames": 5, "step": 6}, {"shot_noise": 1e-3, "read_noise": 3e-3}, {"balance": 0.1}],
    ids=str,
)
def test_other_stacks_are_measured(stack, options):
    true = emor_response(3)
    assert shape_error(true, calibrate_stack(stack(response=true, **options)).curve) < SHAPE


def test_shifted_frames_are_aligned(stack, true_response):
    shifts = ((0, 0), (1, 0), (0, -2), (3, 4), (0, 0), (-5, 7), (1, 1), (2, 0))
    found = calibrate_stack(stack(shifts=shifts, quality=0))
    assert [frame.shift for frame in found.frames] == [tuple(np.subtract(shift, shifts[4])) for shift in shifts]
    assert shape_error(true_response, found.curve) < SHAPE


def test_a_frame_that_shows_something_else_is_left_out(stack, true_response):
    found = calibrate_stack(stack(shifts=[(0, 0)] * 4 + [(90, 130)] + [(0, 0)] * 3))
    assert [frame.is_used for frame in found.frames] == [True] * 4 + [False] + [True] * 3
    assert [(warning.code, *warning.facts.values()) for warning in found.warnings] == [("frame_unfit", "stack_04.jpg")]
    assert shape_error(true_response, found.curve) < SHAPE


def test_the_frames_that_remain_may_span_one_stop(stack, true_response):
    """Times may be given, in any order of the frames, as long as the times are in the same."""
    seconds = 2.0 ** np.array([0, 1 / 3, 2 / 3, 1, 2])
    paths = stack(frames=5, step=1, mistimed=[0, 0, 0, 0, 2 / 3], shifts=[(0, 0)] * 4 + [(100, 150)])
    found = calibrate_stack(paths[::-1], seconds=seconds[::-1].tolist())
    assert [frame.is_used for frame in found.frames] == [False] + [True] * 4
    assert found.frames[0].label.seconds == 4
    assert shape_error(true_response, found.curve) < 2 * found.uncertainty.shape_stops


def test_without_white_the_scale_is_said_to_be_a_guess(stack, true_response):
    found = calibrate_stack(stack(brightest=97, ceiling=0.5))
    assert not found.reaches_white
    assert found.uncertainty.scale_stops >= 0.4
    assert "white_unseen" in {warning.code for warning in found.warnings}
    assert shape_error(true_response, found.curve) < 2 * SHAPE


def test_a_gray_stack_is_measured(tmp_path, light, true_response):
    gray = np.repeat(light[..., 1:2], 3, axis=2)
    options = StackOptions(shot_noise=0, read_noise=0, quality=0)
    found = calibrate_stack(make_stack(tmp_path, gray, true_response, options))
    assert found.frames[0].offsets.shape == (1,)
    assert shape_error(true_response, found.curve) < SHAPE


def test_another_response_is_compared(plain):
    found, gamma = plain[1], ResponseCurve.gamma()
    assert set(found.compare(found.curve).values()) == {0}
    errors = found.compare(gamma)
    assert errors["estimation_error"] == pytest.approx(estimation_error(found.curve, gamma))
    assert errors["shape_error"] > 0.3


def test_it_is_nearer_to_the_truth_than_opencv(plain, true_response):
    """On the same stack; OpenCV's scale, which it does not measure, is given the truth's."""
    pytest.importorskip("cv2", reason="OpenCV comes with the test extra")
    paths, found = plain
    for method in ("Debevec", "Robertson"):
        theirs = opencv_response(method, paths, label_seconds(StackOptions()), true_response)
        assert shape_error(true_response, found.curve) < shape_error(true_response, theirs) < 0.3


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
