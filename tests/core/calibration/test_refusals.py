import shutil
from functools import partial

import numpy as np
import pytest

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.checks import check_range
from crfnet_core.calibration.exposures import ExposureLabel, stack_exposures
from crfnet_core.errors import CalibrationError
from tests.helpers.images import read_image, write_image
from tests.helpers.refusals import refusal_of, refused
from tests.helpers.stacks import StackOptions, emor_response, make_stack

refusal = partial(refusal_of, CalibrationError, calibrate_stack)


def refused_or_named(paths, **options):
    """Return the codes of what a stack is refused for, or warned of."""
    try:
        return [warning.code for warning in calibrate_stack(paths, **options).warnings]
    except CalibrationError as problem:
        return [problem.code]


def test_too_few_frames_one_given_twice_or_of_another_size_are_named(stack):
    paths = stack(frames=4)
    with refused(CalibrationError, "few_frames", count=3):
        calibrate_stack(paths[:3])
    for twice in (paths[0], shutil.copy(paths[0], paths[0].with_name("copy.jpg"))):
        with refused(CalibrationError, "frame_twice", path=twice, first="stack_00.jpg"):
            calibrate_stack([*paths, twice])
    write_image(paths[2], np.zeros((64, 80, 3), np.uint8), ExposureTime=1.0)
    with refused(CalibrationError, "frame_size", size="80 x 64"):
        calibrate_stack(paths)


def test_frames_without_times_of_different_bit_depths_or_cameras_are_refused(tmp_path, codes):
    header = {"Make": "Canon", "Model": "A"}
    paths = [write_image(tmp_path / f"{i}.png", np.roll(codes, i, axis=0), **header) for i in range(4)]
    assert refusal(paths).code == "frame_untimed"
    write_image(paths[0], codes.astype(np.uint16) * 257, **header)
    assert refusal(paths).code == "frame_bits"
    write_image(paths[0], codes, **header | {"Model": "B"})
    with refused(CalibrationError, "frame_camera", camera="Canon A", first_camera="Canon B"):
        calibrate_stack(paths)


@pytest.mark.parametrize(
    ("seconds", "code"),
    [
        ([1, 2, 3], "times_count"),
        ([1.0] * 6, "exposures_span"),
        *((times, "exposures_gap") for times in ([1, 1, 1, 1, 1, 1e4], [1e-308, 1, 2, 4, 8, 1e308])),
        *(([1, 2, wrong, 8, 16, 32], "bad_seconds") for wrong in (0, -4, np.nan, np.inf, "4")),
        ([32, 16, 8, 4, 2, 1], "scene_moved"),
    ],
)
def test_times_that_are_no_stack_are_refused(stack, seconds, code):
    assert refusal(stack(frames=6), seconds=seconds).code == code


def test_edited_frames_are_refused_unless_accepted(stack):
    paths = stack(header={"Software": "Adobe Photoshop Lightroom 6.0"})
    with refused(CalibrationError, "frame_edited", editor="Adobe Photoshop Lightroom 6.0"):
        calibrate_stack(paths)
    assert calibrate_stack(paths, accept_edited=True).reaches_white


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (lambda codes, number, one: 255 - codes, "no_single_curve frame_mistimed"),  # by rounding
        (lambda codes, number, one: codes * np.linspace(0.6, 1.1, len(codes))[:, None, None], "scene_moved"),
        (lambda codes, number, one: np.roll(codes, (41 * number, 59 * number), axis=(0, 1)), "scene_moved"),
        (lambda codes, number, one: np.roll(codes, 60 * (number > 2), axis=0), "frame_mistimed"),
        (lambda codes, number, one: 0 * codes + 40 * number, "codes_unseen"),
        (lambda codes, number, one: one, "frame_twice"),
        (lambda codes, number, one: one * 2.0 ** (number - 3), "unlike_cameras"),
    ],
)
def test_frames_that_a_program_made_or_spoiled_are_refused_or_named(stack, tmp_path, change, code):
    seconds = [2.0**number for number in range(6)]
    pictures = [read_image(path, kind="uint8")[..., :3].astype(float) for path in stack(frames=6)]
    for number, codes in enumerate(pictures):
        changed = np.rint(change(codes, number, pictures[3]).clip(0, 255))
        write_image(tmp_path / f"{number}.png", changed.astype(np.uint8))
    assert {*code.split()} & {*refused_or_named(sorted(tmp_path.glob("*.png")), seconds=seconds)}


def test_times_that_contradict_the_files_are_named(stack):
    found = calibrate_stack(stack(frames=6), seconds=[1.6**number for number in range(6)])
    (named,) = [warning.facts["stops"] for warning in found.warnings if warning.code == "times_differ"]
    assert named == pytest.approx(5 - 5 * np.log2(1.6), abs=0.2)


@pytest.mark.parametrize(("off", "direction"), [(0.5, "brighter"), (-0.6, "darker")])
def test_a_mistimed_frame_is_named(stack, off, direction):
    problem = refusal(stack(frames=5, step=4, mistimed=(0, 0, 0, off, 0)))
    assert problem.code == "frame_mistimed"
    assert (problem.facts["path"], problem.facts["direction"]) == ("stack_03.jpg", direction)
    assert problem.facts["stops"] == pytest.approx(abs(off), abs=0.1)


def test_a_stack_whose_only_other_exposure_shows_another_scene_is_refused(tmp_path):
    """The frame at 1/8 s fits none of the others, and these alone say nothing of the exposures."""
    seconds = [1 / 60] * 4 + [1 / 40, 1 / 8]
    paths = []
    for i, time in enumerate(seconds):
        rng = np.random.default_rng(i == len(seconds) - 1)
        light = np.kron(np.exp2(rng.uniform(-6, 0, (30, 40, 1))), np.ones((16, 16, 3))) * time * 54
        codes = 255 * np.minimum(light, 1) ** (1 / 2.2) + np.random.default_rng(i).normal(0, 0.4, light.shape)
        paths.append(write_image(tmp_path / f"{i}.png", np.rint(codes).clip(0, 255).astype(np.uint8)))
    with refused(CalibrationError, "rest_span", unfit=1, count=6):
        calibrate_stack(paths, seconds=seconds)


def test_exposures_at_the_limits_are_not_refused():
    """Of exactly two stops, or six between neighbors: their differences come to a little less, or more."""
    for seconds in (1 / 1000, 1 / 800, 1 / 640, 1 / 250), (1 / 640, 0.1, 0.3, 6):
        check_range(stack_exposures([ExposureLabel(time, 8.0, 100.0) for time in seconds]))


@pytest.mark.parametrize(("seed", "code"), [(3, "no_single_curve"), (4, "frame_mistimed"), (20, "frames_differ")])
def test_frames_of_two_responses_are_refused_or_named(stack, tmp_path, seed, code):
    (tmp_path / "other").mkdir()
    paths = stack(frames=6)
    paths[::2] = stack(response=emor_response(seed), folder=tmp_path / "other", frames=6)[::2]
    assert code in refused_or_named(paths)


@pytest.mark.parametrize(
    ("gains", "channels"), [((1, 0, 0), "green and blue"), ((1, 0.8, 0), "blue")], ids=["red light", "yellow light"]
)
def test_light_that_a_channel_does_not_see_is_refused(tmp_path, light, true_response, gains, channels):
    paths = make_stack(tmp_path, light * np.float32(gains), true_response, StackOptions(quality=0, read_noise=0))
    with refused(CalibrationError, "dark_channel", channels=channels):
        calibrate_stack(paths)
