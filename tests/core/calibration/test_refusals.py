"""Stacks that are none: the message says what is wrong."""

import numpy as np
import pytest

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.checks import check_range
from crfnet_core.calibration.exposures import ExposureLabel, stack_exposures
from crfnet_core.errors import CalibrationError, PhotoError
from tests.helpers.images import write_image
from tests.helpers.stacks import StackOptions, emor_response, make_stack


def test_three_frames_are_too_few(stack):
    with pytest.raises(CalibrationError, match=r"at least 4 frames of one scene at different exposures, found 3"):
        calibrate_stack(stack()[:3])


def test_a_folder_or_an_absent_file_in_place_of_frames_is_named(stack):
    folder = stack()[0].parent
    with pytest.raises(PhotoError, match=r"is a folder; give a photograph in it"):
        calibrate_stack([folder])
    with pytest.raises(PhotoError, match=r"stack_%02d\.jpg: there is no such file"):
        calibrate_stack([folder / "stack_%02d.jpg"])


def test_a_frame_that_is_given_twice_is_named(stack):
    paths = stack(frames=4)
    with pytest.raises(CalibrationError, match=r"stack_00.jpg: is given twice"):
        calibrate_stack([*paths, paths[0]])


def test_frames_of_different_sizes_are_refused(stack, tmp_path):
    paths = stack()
    write_image(paths[2], np.zeros((64, 80, 3), np.uint8), ExposureTime=1.0)
    with pytest.raises(CalibrationError, match=r"stack_02.jpg: has 80 x 64 pixels, stack_00.jpg has \d+ x \d+"):
        calibrate_stack(paths)


def test_frames_of_two_cameras_are_refused(stack, tmp_path):
    paths = stack(frames=4, step=6, header={"Make": "Canon", "Model": "A"})
    (tmp_path / "other").mkdir()
    others = stack(frames=4, step=6, header={"Make": "Canon", "Model": "B"}, folder=tmp_path / "other")
    with pytest.raises(CalibrationError, match=r"names Canon B, stack_00.jpg Canon A; give frames of one camera"):
        calibrate_stack([*paths[:3], others[3]])


def test_frames_without_times_are_refused(tmp_path, codes):
    paths = [write_image(tmp_path / f"{i}.png", np.roll(codes, i, axis=0)) for i in range(4)]
    with pytest.raises(CalibrationError, match=r"0.png: names no exposure time; give the times .* --times"):
        calibrate_stack(paths)


def test_as_many_times_as_frames_are_needed(stack):
    with pytest.raises(CalibrationError, match=r"3 times are given for 8 frames; give one for each"):
        calibrate_stack(stack(), seconds=[1, 2, 3])


def test_equal_exposures_are_refused(stack):
    with pytest.raises(
        CalibrationError, match=r"the exposures span 0.00 stops, by EXIF or --times; a stack needs 2 or"
    ):
        calibrate_stack(stack(), seconds=[1.0] * 8)


@pytest.mark.parametrize("seconds", [[1, 1, 1, 1, 1, 1e4], [1e-308, 1, 2, 4, 8, 1e308]])
def test_exposures_with_a_gap_are_refused(stack, seconds):
    with pytest.raises(
        CalibrationError, match=r"two neighbouring exposures are \d+\.\d\d stops apart, by EXIF or --times;"
    ):
        calibrate_stack(stack(frames=6), seconds=seconds)


def test_edited_frames_are_refused_unless_accepted(stack):
    paths = stack(header={"Software": "Adobe Photoshop Lightroom 6.0"})
    with pytest.raises(CalibrationError, match=r"saved by Adobe Photoshop Lightroom 6.0, which may have changed"):
        calibrate_stack(paths)
    assert calibrate_stack(paths, accept_edited=True).reaches_white


@pytest.mark.parametrize(
    ("stops", "words"), [((0, 0, 0, 0.5, 0, 0, 0, 0), "brighter"), ((0, 0, 0, -0.6, 0, 0, 0, 0), "darker")]
)
def test_a_mistimed_frame_is_named(stack, stops, words):
    with pytest.raises(CalibrationError, match=rf"stack_03.jpg: is 0.[456]\d stop {words} than its exposure time says"):
        calibrate_stack(stack(mistimed=stops))


def test_a_scene_that_moves_is_refused(stack):
    with pytest.raises(
        CalibrationError, match=r"the frames do not show the same scene: .*; the camera or the scene has moved"
    ):
        calibrate_stack(stack(shifts=[(41 * i, 59 * i) for i in range(8)]))


@pytest.mark.parametrize("seconds", [[1 / 60] * 5 + [1 / 8], [1 / 60] * 4 + [1 / 40, 1 / 8]])
def test_a_stack_whose_only_other_exposure_shows_another_scene_is_refused(tmp_path, seconds):
    """The frame at 1/8 s fits none of the others, and these alone tell nothing of the exposures."""
    paths = []
    for i, time in enumerate(seconds):
        rng = np.random.default_rng(i == len(seconds) - 1)
        light = np.kron(np.exp2(rng.uniform(-6, 0, (30, 40, 1))), np.ones((16, 16, 3))) * time * 54
        codes = 255 * np.minimum(light, 1) ** (1 / 2.2) + np.random.default_rng(i).normal(0, 0.4, light.shape)
        paths.append(write_image(tmp_path / f"{i}.png", np.rint(codes).clip(0, 255).astype(np.uint8)))
    with pytest.raises(
        CalibrationError, match=r"do not fit the others \(1 of 6\), the exposures span 0\.\d\d stops; these need 0\.9 "
    ):
        calibrate_stack(paths, seconds=seconds)


def test_exposures_at_the_limits_are_not_refused():
    """Of exactly two stops, or six between neighbours: their differences come to a little less, or more."""
    for seconds in (1 / 1000, 1 / 800, 1 / 640, 1 / 250), (1 / 640, 0.1, 0.3, 6):
        check_range(stack_exposures([ExposureLabel(time, 8.0, 100.0) for time in seconds]))


def test_frames_that_were_rendered_each_on_its_own_are_refused(stack, tmp_path):
    """Every second frame has another response."""
    (tmp_path / "other").mkdir()
    first, second = stack(), stack(response=emor_response(4), folder=tmp_path / "other")
    mixed = [path if index % 2 else other for index, (path, other) in enumerate(zip(first, second, strict=True))]
    with pytest.raises(CalibrationError, match=r"no single curve explains the frames|stop (brighter|darker) than its"):
        calibrate_stack(mixed)


@pytest.mark.parametrize(
    ("gains", "channels"), [((1, 0, 0), "green and blue"), ((1, 0.8, 0), "blue")], ids=["red light", "yellow light"]
)
def test_light_that_a_channel_does_not_see_is_refused(tmp_path, light, true_response, gains, channels):
    paths = make_stack(tmp_path, light * np.float32(gains), true_response, StackOptions(quality=0, read_noise=0))
    with pytest.raises(CalibrationError, match=rf"only 0 flat places .*: in {channels} nearly everything is black or"):
        calibrate_stack(paths)


def test_frames_that_show_nothing_in_common_are_refused(tmp_path):
    """14 stops lie between two frames, whatever is said: what one shows is black or white in the next."""
    stops = np.kron(np.random.default_rng(0).uniform(-40, 0, (20, 30, 1)), np.ones((20, 20, 3)))
    codes = [np.rint(255 * np.exp2(np.minimum(stops + 14 * i, 0) / 2.2)).astype(np.uint8) for i in range(4)]
    paths = [write_image(tmp_path / f"{i}.png", each) for i, each in enumerate(codes)]
    with pytest.raises(CalibrationError, match=r"only 0 flat places are seen well in two frames, 200 .*; take more fr"):
        calibrate_stack(paths, seconds=[2.0**-18, 2.0**-12, 2.0**-6, 1])


def test_a_flat_scene_is_refused(stack, tmp_path, true_response):
    codes = [np.full((300, 400, 3), code, np.uint8) for code in (20, 40, 70, 110)]
    paths = [write_image(tmp_path / f"{i}.png", each) for i, each in enumerate(codes)]
    with pytest.raises(CalibrationError, match=r"of the codes between 16 and 240; take a scene with more range"):
        calibrate_stack(paths, seconds=[1, 2, 4, 8])
