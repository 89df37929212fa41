import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from training.synthesis.camera import (
    TARGET_BRIGHTNESS,
    Capture,
    apply_response,
    automatic_exposure,
    reference_luminance,
    simulate_capture,
)

UNIFORM = np.linspace(0, 1, 1024)
GAMMA = UNIFORM ** (1 / 2.2)


def test_apply_response_is_the_curve_and_clips(rng):
    irradiance = rng.uniform(-0.2, 1.3, (5, 7, 3)).astype(np.float32)
    np.testing.assert_allclose(apply_response(irradiance, GAMMA), np.interp(irradiance, UNIFORM, GAMMA), atol=2e-5)


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
