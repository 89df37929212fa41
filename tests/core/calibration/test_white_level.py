"""A camera that clips below the largest code: its white is found, and its response is in the codes of the file."""

import numpy as np
import pytest

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.calibration.frames import read_frames, white_level
from crfnet_core.library import Camera, CameraSettings, camera_estimate
from crfnet_core.response.metrics import scale_error, shape_error
from tests.helpers.images import write_image
from tests.helpers.stacks import StackOptions, emor_response, light_of, make_stack

#: The code at which the camera clips, as a part of the largest, and its response.
WHITE, RESPONSE = 240 / 255, emor_response(100)


@pytest.fixture
def white_of(root, tmp_path):
    """The white that is found of a stack: white_of("forest", white=251 / 255) -> code."""

    def found(scene, **options):
        light = light_of(root / "tests" / "data" / "lights" / f"{scene}.exr")[::2, ::2]
        return 255 * white_level(read_frames(make_stack(tmp_path, light, RESPONSE, StackOptions(frames=6, **options))))

    return found


@pytest.mark.parametrize(
    ("scene", "code", "options"),
    [
        ("interior", 240, {"quality": 92}),
        ("forest", 251, {"quality": 92}),  # detail, in which JPEG rings: the scale was off by stops
        ("courtyard", 251, {"quality": 0}),
        ("interior", 255, {"quality": 0}),
        ("forest", 255, {"quality": 75, "shot_noise": 1e-3}),
        ("courtyard", 255, {"ceiling": 0.5}),
    ],
)
def test_the_code_at_which_a_camera_clips_is_found(white_of, scene, code, options):
    assert white_of(scene, white=code / 255, **options) == pytest.approx(code)


@pytest.mark.parametrize(("code", "found"), [(65532, 65535), (63123, 63123)])
def test_the_white_of_16_bits_is_found_to_its_code(tmp_path, code, found):
    """The scene's own brightness is spread over all codes; rounding down took 65532 for 254 of 255."""
    light = 2.0 ** np.kron(np.random.default_rng(0).uniform(-8, 0, (20, 30, 1)), np.ones((8, 8, 3)))
    paths = []
    for index in range(6):
        codes = np.rint(code * np.minimum(light * 2.0 ** (index - 2), 1) ** (1 / 2.2)).astype(np.uint16)
        paths.append(write_image(tmp_path / f"{index}.png", codes, ExposureTime=2.0**index))
    assert white_level(read_frames(paths)) == pytest.approx(found / 65535, abs=1e-9)


def test_an_even_surface_in_one_frame_is_no_white(tmp_path):
    """A wall is at code 245 in one frame, and at another code in the next."""
    wall = np.random.default_rng(0).integers(0, 236, (64, 64, 3), dtype=np.uint8)
    paths = []
    for index, code in enumerate((120, 180, 245, 250)):
        wall[:20] = code
        paths.append(write_image(tmp_path / f"{index}.png", wall, ExposureTime=2.0**index))
    assert white_level(read_frames(paths)) == 1


def test_the_response_its_uncertainties_and_its_points_are_in_the_codes_of_the_file(light, tmp_path):
    found = calibrate_stack(make_stack(tmp_path, light, RESPONSE, StackOptions(white=WHITE)))
    true = in_file_codes(RESPONSE, WHITE)
    assert (found.white, found.warnings[-1].code) == (pytest.approx(WHITE), "white_below_largest")
    np.testing.assert_allclose(found.curve.inverse([WHITE, 0.98, 1]), 1, atol=2e-3)
    codes = np.arange(16, 241)
    assert np.std(np.log2(found.curve.inverse(codes / 255) / RESPONSE.inverse(codes / 240))) < 0.02
    assert shape_error(true, found.curve) < 2 * found.uncertainty.shape_stops < 0.1
    assert abs(scale_error(true, found.curve)) < min(0.04, 2 * found.uncertainty.scale_stops) < 0.25
    stops, brightness, residual, _ = found.points[found.points[:, 0] < -0.1].T
    assert 0.9 < brightness.max() / WHITE <= 1
    assert np.median(np.abs(brightness - found.curve.forward(np.exp2(stops)) - residual)) < 2e-3


def test_the_jump_to_the_largest_code_is_no_uncertainty_of_the_camera():
    """E_est of a camera follows from stops by the slope; at the jump that would be 40 times too steep."""
    plain, jumping = (
        camera_estimate(Camera("a", curve, 0.02, 0.05, "8 exposures", CameraSettings()))
        for curve in (RESPONSE, in_file_codes(RESPONSE, WHITE))
    )
    assert jumping.uncertainty == pytest.approx(WHITE * plain.uncertainty, rel=0.02)
    assert jumping.verdict == plain.verdict
