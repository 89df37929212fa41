import numpy as np
import pytest

from crfnet_core.response.transfer_functions import srgb_encode
from training.synthesis.unusual.film_scan import Negative
from training.synthesis.unusual.tone_mapping import drago, guided_base, reinhard
from training.synthesis.unusual.view_transforms import AGX_SIGMOID, filmic_sigmoid, scaled_stops

#: A neutral at -4, -2, 0, 2 and 4 stops around middle gray, as Blender 4.5 shows it.
NEUTRAL = 0.18 * np.exp2(np.array([-4, -2, 0, 2, 4], np.float32))
AGX_SHOWN = [0.0805, 0.2126, 0.4614, 0.7242, 0.8863]
FILMIC_SHOWN = [0.1095, 0.2577, 0.5002, 0.7571, 0.9256]


def test_agx_shows_a_neutral_as_blender_does():
    shown = srgb_encode(AGX_SIGMOID(scaled_stops(NEUTRAL)) ** 2.4)
    np.testing.assert_allclose(shown, AGX_SHOWN, atol=2e-3)


def test_filmic_shows_a_neutral_as_blender_does():
    np.testing.assert_allclose(filmic_sigmoid(2.17)(scaled_stops(NEUTRAL)), FILMIC_SHOWN, atol=6e-3)


def test_global_operators_map_the_white_to_1():
    luminance = np.array([0, 0.5, 8], np.float32)
    for mapped in (reinhard(luminance, 8.0), drago(luminance, 8.0, 0.85)):
        assert mapped[0] == pytest.approx(0)
        assert mapped[2] == pytest.approx(1, abs=1e-5)
        assert 0 < mapped[1] < 1


def test_the_base_layer_keeps_strong_edges_and_smooths_weak_ones(rng):
    stops = np.zeros((1, 60, 60), np.float32)
    stops[:, :, 30:] = 8
    noisy = stops + 0.1 * rng.standard_normal(stops.shape, dtype=np.float32)
    base = guided_base(noisy, 9, 0.3)
    assert base[0, :, 32].mean() - base[0, :, 27].mean() > 7
    assert base[0, :, :20].std() < 0.04


def test_density_rises_with_light_and_saturates(rng):
    film = Negative.draw(rng)
    ramp = np.geomspace(1e-4, 1e4, 50, dtype=np.float32)[:, None].repeat(3, axis=1)
    density = film.density(ramp)
    assert (np.diff(density, axis=0) > 0).all()
    assert (density < film.density_range + 1e-6).all()
