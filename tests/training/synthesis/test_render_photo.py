import numpy as np
import pytest

from crfnet_core.response.curve import UNIFORM
from training.data.scenes import LUMINANCE, Scene
from training.synthesis.camera import (
    TARGET_BRIGHTNESS,
    Capture,
    apply_response,
    automatic_exposure,
    balanced_gains,
    reference_luminance,
    render_photo,
    sensor_light,
    simulate_capture,
)

CURVE = UNIFORM ** (1 / 2.2)

#: Gains of a white balance that is off.
COOL = (0.6, 1.0, 1.7)


def photo_of(scene, rng, exposure=0.2, **capture):
    return render_photo(sensor_light(scene, rng), CURVE, exposure, rng, name="made", capture=Capture(**capture))


def test_a_clean_photograph_is_the_rounded_response(scene, rng):
    expected = np.rint(255 * np.interp(0.2 * scene.pixels, UNIFORM, CURVE))
    photo = photo_of(scene, rng)
    assert np.abs(255 * photo.pixels - expected).max() <= 1
    assert (photo.bit_depth, photo.is_gray, photo.path.name) == (8, False, "made")


def test_noise_has_its_variance_in_codes(rng):
    gray = Scene("gray", np.full((700, 300, 3), 0.5, np.float32), False)
    codes = 255 * photo_of(gray, rng, exposure=1, grain=2 / 255).pixels
    assert codes.var() == pytest.approx(4 + 1 / 12, rel=0.01)  # rounding adds a twelfth
    assert np.corrcoef(codes[:512, :, 0].ravel(), codes[:512, :, 1].ravel())[0, 1] == pytest.approx(0, abs=0.01)


def test_gray_is_the_luminance_of_the_light(scene, rng):
    light = sensor_light(scene, rng, is_gray=True)
    photo = render_photo(light, CURVE, 0.2, rng, name="made")
    assert photo.is_gray
    assert (np.ptp(photo.pixels, axis=2) == 0).all()
    np.testing.assert_allclose(light[:, :, 0], scene.pixels @ LUMINANCE, rtol=1e-6)


def test_gains_keep_the_luminance_of_a_neutral():
    gains = balanced_gains(COOL)
    assert gains @ LUMINANCE == pytest.approx(1)
    assert gains[2] / gains[0] == pytest.approx(1.7 / 0.6)


def test_blur_keeps_the_sum_and_has_its_variance(rng):
    dot = np.zeros((41, 41, 3), np.float32)
    dot[20, 20] = 1
    spread = sensor_light(Scene("dot", dot, False), rng, blur=4.0)[:, :, 0]
    assert spread.sum() == pytest.approx(1)
    assert (spread.sum(axis=0) * (np.arange(41) - 20) ** 2).sum() == pytest.approx(4, rel=0.05)


def test_nothing_writes_into_the_scene(scene, rng):
    before = scene.pixels.copy()
    light = sensor_light(scene, rng, gains=COOL, is_gray=True, blur=1.0)
    for array in (scene.pixels, light):
        kept = array.copy()
        render_photo(array, CURVE, 0.2, rng, name="made", capture=Capture(1e-3, 1e-3, 1.0, 0.5, 0.01, 75))
        np.testing.assert_array_equal(array, kept)
    np.testing.assert_array_equal(scene.pixels, before)


def test_apply_response_is_the_curve_and_clips(rng):
    irradiance = rng.uniform(-0.2, 1.3, (5, 7, 3)).astype(np.float32)
    np.testing.assert_allclose(apply_response(irradiance, CURVE), np.interp(irradiance, UNIFORM, CURVE), atol=2e-5)


def test_noise_has_the_variance_asked_for(rng):
    flat = np.full((200, 200, 3), 0.5, np.float32)
    codes = simulate_capture(flat, UNIFORM, Capture(shot_noise=1e-3, read_noise=0.01), rng)
    assert (codes / 255).var() == pytest.approx(1e-3 * 0.5 + 1e-4, rel=0.05)


@pytest.mark.parametrize("exponent", [1.0, 1 / 2.2, 0.3])
def test_automatic_exposure_reaches_the_target(scene, exponent):
    luminance = reference_luminance([scene])
    curve = UNIFORM**exponent
    exposure = automatic_exposure(curve, luminance)
    assert apply_response(luminance * np.float32(exposure), curve).mean() == pytest.approx(TARGET_BRIGHTNESS, abs=1e-3)
