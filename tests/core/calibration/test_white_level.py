import numpy as np
import pytest

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.calibration.frames import read_frames, white_level
from crfnet_core.response.metrics import scale_error
from tests.helpers.images import write_image
from tests.helpers.stacks import StackOptions, emor_response, light_of, make_stack

#: Scenes: large flat parts, and detail in which JPEG rings.
SCENES = ("interior", "forest", "courtyard")


@pytest.fixture
def white_of(root, tmp_path):
    """The white that is found of a stack: white_of("forest", white=251 / 255) -> code."""

    def found(scene, **options):
        light = light_of(root / "tests" / "data" / "lights" / f"{scene}.exr")[::2, ::2]
        paths = make_stack(tmp_path, light, emor_response(100), StackOptions(frames=6, **options))
        return 255 * white_level(read_frames(paths))

    return found


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize(("code", "quality"), [(240, 92), (251, 0)])
def test_a_camera_that_clips_below_the_largest_code_is_found(white_of, scene, code, quality):
    assert white_of(scene, white=code / 255, quality=quality) == pytest.approx(code)


@pytest.mark.parametrize(
    ("scene", "options"),
    [("interior", {"quality": 0}), ("forest", {"quality": 75, "shot_noise": 1e-3}), ("courtyard", {"ceiling": 0.5})],
    ids=["PNG", "noisy", "white unseen"],
)
def test_a_camera_that_clips_at_the_largest_code_is_left_alone(white_of, scene, options):
    assert white_of(scene, **options) == 255


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


def test_the_scale_of_a_detailed_stack_that_clips_at_code_251_is_right(root, tmp_path):
    """JPEG's ringing hid that white, and the scale was off by stops without a warning."""
    light, response = light_of(root / "tests" / "data" / "lights" / "forest.exr"), emor_response(100)
    found = calibrate_stack(make_stack(tmp_path, light, response, StackOptions(white=251 / 255)))
    assert abs(scale_error(in_file_codes(response, 251 / 255), found.curve)) < 0.03
    assert "white_below_largest" in {warning.code for warning in found.warnings}
