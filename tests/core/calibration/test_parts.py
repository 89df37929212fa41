import numpy as np
import pytest

from crfnet_core.calibration.alignment import chain_of_shifts, common_parts, displacement, rank_image
from crfnet_core.calibration.blocks import block_means, observe
from crfnet_core.calibration.curve_model import CurveModel
from crfnet_core.response.metrics import shape_error
from tests.helpers.stacks import emor_response


def texture(height=160, width=200, seed=0):
    """A smooth random texture, which repeats at its edges."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((height, width)))
    rows, columns = np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None]
    return np.fft.irfft2(spectrum * np.exp(-200 * (rows**2 + columns**2)), s=(height, width))


@pytest.mark.parametrize("shift", [(0, 0), (5, 0), (0, -7), (-6, 11)])
def test_a_shift_is_found(shift):
    image = texture()
    moved = np.roll(image, shift, axis=(0, 1))
    np.testing.assert_allclose(displacement(rank_image(image), rank_image(moved**3)), shift, atol=0.3)


def test_shifts_add_up_along_the_exposures():
    """Frames 2, 0, 1 from dark to bright: 0 is the reference, its neighbors are compared with it."""
    image = texture()
    ranks = [rank_image(np.roll(image, shift, axis=(0, 1))) for shift in ((0, 0), (3, 2), (-4, 0))]
    assert chain_of_shifts(ranks, [2, 0, 1], stride=2) == ((0, 0), (6, 4), (-8, 0))


def test_displaced_images_are_cut_to_what_all_of_them_show():
    image, shifts = texture(), [(0, 0), (5, -3), (-2, 4)]
    parts = common_parts([np.roll(image, shift, axis=(0, 1)) for shift in shifts], shifts)
    np.testing.assert_array_equal(parts, [image[2:155, 3:196]] * 3)


def test_blocks_hold_means_spread_and_white():
    """One block of 4 x 4 pixels: half at 100, half at 255, so mean 177.5, spread 77.5, half white; green is flat."""
    codes = np.full((4, 4, 3), 51, np.uint8)
    codes[:2, :, 0], codes[2:, :, 0] = 100, 255
    (brightness,), (spread,), (white,) = block_means(codes, 255)
    np.testing.assert_allclose(brightness * 255, [177.5, 51, 51])
    np.testing.assert_allclose(spread * 255, [77.5, 0, 0], atol=1e-9)
    np.testing.assert_allclose(white, [0.5, 0, 0])


def test_partly_white_and_nearly_black_blocks_do_not_count():
    frames = [np.full((4, 4, 3), code, np.uint8) for code in (2, 100, 255)]
    half = frames[1].copy()
    half[:2] = 255
    seen = observe([block_means(codes, 255) for codes in (*frames, half)], is_gray=True)
    np.testing.assert_array_equal(seen.is_used, [[False, True, False, False]])
    np.testing.assert_array_equal(seen.white_fraction, [[0, 0, 1, 0.5]])


@pytest.mark.parametrize("seed", range(2))
def test_the_model_holds_emor_responses(seed):
    model, curve = CurveModel.load(), emor_response(seed)
    assert shape_error(curve, model.response(model.weights_of(curve))) < 0.02


def test_gradients_of_the_model_are_its_differences():
    model = CurveModel.load()
    weights = model.weights_of(emor_response(1))
    stops = np.array([-7.3, -2.15, -0.4, 0.2])
    brightness, slope = model.brightness(weights, stops)
    step = np.zeros(len(weights))
    step[3] = 1e-6
    moved, _ = model.brightness(weights + step, stops)
    np.testing.assert_allclose((moved - brightness) / 1e-6, model.gradient(stops)[:, 3], atol=1e-6)
    beside, _ = model.brightness(weights, stops + 1e-6)
    np.testing.assert_allclose((beside - brightness) / 1e-6, slope, atol=1e-5)
