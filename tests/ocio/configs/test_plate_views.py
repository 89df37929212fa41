"""Views "as photographed": CG and plate through the camera's response, and highlights above the plate's white."""

import math

import colour
import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.plate_views import KNEE, SOFTNESS, active_views, roll_off, view_names
from crfnet.configs.portable import MOST_PLATES_WITH_VIEWS, portable_config
from crfnet.luts.files import write_lut
from crfnet_core.colorimetry import DISPLAY_P3, REC709, conversion_matrix
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import written
from tests.helpers.looks import LUT

CLIPPED, ROLLED_OFF = view_names("CRF plate")


@pytest.fixture
def shown(tmp_path):
    """Show scene-linear pixels, shape (N, 3), in a view of a config with the plate: values that go to the display."""
    write_lut(tmp_path / "plate.spi1d", LUT)

    def show(config, display, view, pixels, *, optimization=OCIO.OPTIMIZATION_DEFAULT):
        result = loaded(written(tmp_path / "config.ocio", config.serialize()))
        pixels = np.array(pixels, dtype=np.float32)
        processor = result.getProcessor("scene_linear", display, view, OCIO.TRANSFORM_DIR_FORWARD)
        processor.getOptimizedCPUProcessor(optimization).applyRGB(pixels)
        return pixels

    return show


@pytest.fixture
def linear(tmp_path):
    """Linearize code values, shape (N, 3), by the plate's color space."""

    def convert(config, codes):
        write_lut(tmp_path / "plate.spi1d", LUT, overwrite=True)
        result = loaded(written(tmp_path / "linear.ocio", config.serialize()))
        return converted(result, "CRF plate", "scene_linear", np.array(codes) / 255)

    return convert


def with_plate(**options):
    return portable_config([PlateColorSpace("CRF plate", "plate.spi1d", **options)])


@pytest.mark.parametrize("exposure", [0, 1.5, -2])
class TestRoundTrip:
    def test_every_code_of_the_plate_comes_back(self, exposure, linear, shown, codes):
        config, codes = with_plate(exposure=exposure), codes.reshape(-1, 3)
        result = shown(config, "sRGB", CLIPPED, linear(config, codes))
        np.testing.assert_array_equal(np.rint(result * 255), codes)

    def test_the_rolled_off_view_leaves_codes_up_to_the_knee(self, exposure, linear, shown, codes):
        config, codes = with_plate(exposure=exposure), codes.reshape(-1, 3)
        result = np.rint(shown(config, "sRGB", ROLLED_OFF, linear(config, codes)) * 255)
        highest = int(np.floor(LUT.apply_inverse(KNEE) * 255))
        assert 200 < highest < 255
        below = (codes <= highest).all(axis=1)
        np.testing.assert_array_equal(result[below], codes[below])
        assert result[codes == 255].max() < 255


def test_highlights_are_clipped_in_one_view_and_differ_in_the_other(shown):
    light = np.repeat(np.float32([[1], [2], [4], [8], [14.3], [100]]), 3, axis=1)
    config = with_plate()
    np.testing.assert_allclose(shown(config, "sRGB", CLIPPED, light), 1, atol=1e-5)
    rolled_off = shown(config, "sRGB", ROLLED_OFF, light)[:, 0]
    assert (np.diff(rolled_off)[:4] > 0.004).all()
    np.testing.assert_allclose(rolled_off[4:], 1, atol=1e-5)


def test_a_video_display_shows_the_same_colors(shown):
    """The code of Rec.1886 is x^(1/2.4); the code of sRGB, above its linear part, 1.055 x^(1/2.4) - 0.055."""
    light, config = np.float32([[0.18, 0.18, 0.18]]), with_plate()
    srgb = shown(config, "sRGB", CLIPPED, light)[0, 0]
    video = shown(config, "Rec.709", CLIPPED, light)[0, 0]
    assert video == pytest.approx((srgb + 0.055) / 1.055, abs=1e-4)


def test_an_srgb_display_shows_the_same_colors_of_a_photograph_in_display_p3(linear, shown):
    """Within its gamut: decoded by the sRGB curve, display and plate differ by the matrix between the primaries."""
    codes = np.array([[120, 100, 90], [60, 64, 70]])
    config = with_plate(exposure=1, primaries=DISPLAY_P3)
    result = colour.models.eotf_sRGB(shown(config, "sRGB", CLIPPED, linear(config, codes)))
    expected = colour.models.eotf_sRGB(codes / 255) @ conversion_matrix(DISPLAY_P3, REC709).T
    np.testing.assert_allclose(result, expected, atol=1e-4)


class TestRollOff:
    def rolled_off(self, values, direction=OCIO.TRANSFORM_DIR_FORWARD):
        pixels = np.repeat(np.float32(values)[:, None], 3, axis=1)
        OCIO.Config.CreateRaw().getProcessor(roll_off(), direction).getDefaultCPUProcessor().applyRGB(pixels)
        return pixels[:, 0]

    def test_it_is_the_equation(self):
        x = np.linspace(0, 16, 999)
        with np.errstate(invalid="ignore"):
            expected = np.where(x <= KNEE, x, KNEE + SOFTNESS * np.log(1 + (x - KNEE) / SOFTNESS))
        np.testing.assert_allclose(self.rolled_off(x), expected, atol=2e-6)

    def test_white_and_the_end_are_as_stated(self):
        end = KNEE + SOFTNESS * (math.exp((1 - KNEE) / SOFTNESS) - 1)
        assert (round(end, 1), round(math.log2(end), 1)) == (14.2, 3.8)
        np.testing.assert_allclose(self.rolled_off([1, end]), [0.865, 1], atol=5e-4)


def test_many_plates_do_not_bury_the_other_views():
    spaces = [PlateColorSpace(f"CRF {number}", f"{number}.spi1d") for number in range(MOST_PLATES_WITH_VIEWS + 1)]
    assert len(active_views(portable_config(spaces[:-1]))) == 2 + 2 * MOST_PLATES_WITH_VIEWS
    assert active_views(portable_config(spaces)) == ["Standard", "Raw"]
