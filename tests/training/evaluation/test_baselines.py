import numpy as np
import pytest

from crfnet_core.response.curve import LEAST_SLOPE, UNIFORM, ResponseCurve
from crfnet_core.response.metrics import estimation_error, shape_error
from training.data.families import with_headroom
from training.data.scenes import LUMINANCE
from training.evaluation.baselines import constant_curves, nearest_power, oracle_curves, with_best_headroom
from training.evaluation.test_sets import LIGHTS_FOLDER, bundled_test_set, read_light


def test_baselines_against_gamma_2_2():
    true = ResponseCurve.gamma(2.2)
    curves = constant_curves() | oracle_curves(true)
    errors = {name: estimation_error(true, curve) for name, curve in curves.items()}
    expected = {
        "gamma 2.2": 0.0,
        "mean curve": 1.1841,
        "oracle: best gamma": 0.0,
        "oracle: EMoR, 3 components": 0.1736,
        "oracle: EMoR, 11 components": 0.0056,
    }
    assert list(errors) == list(expected)
    assert errors == pytest.approx(expected, abs=1e-3)


def test_the_nearest_power_of_an_s_curve_is_the_least_of_a_grid():
    true = ResponseCurve.from_samples(UNIFORM**0.4 * (2 - UNIFORM**0.4))
    grid = [np.linalg.norm(true.brightness - UNIFORM**p) for p in np.linspace(0.05, 2, 2000)]
    assert estimation_error(true, nearest_power(true)) == pytest.approx(min(grid), abs=2e-3)


def test_the_oracle_chooses_the_headroom_and_keeps_the_shape():
    mean = ResponseCurve.from_samples(1 - (1 - UNIFORM**0.6) ** 2)
    for stops in (1.0, -0.4):
        true = with_headroom(mean, stops)
        best = with_best_headroom(mean, true)
        assert estimation_error(true, best) < 0.05 < estimation_error(true, mean)
        assert shape_error(mean, best) < 0.01


def test_the_bundled_responses_are_strict_and_far_from_each_other():
    test_set = bundled_test_set()
    assert (np.diff(test_set.curves, axis=1) >= 0.9 * LEAST_SLOPE / 1024).all()
    distances = np.linalg.norm(test_set.curves[:, None] - test_set.curves, axis=2)
    assert distances[~np.eye(13, dtype=bool)].min() > 0.15
    assert np.log2(test_set.exposures[:3]) == pytest.approx([-2.09, -2.55, -3.43], abs=0.01)


def test_a_studio_light_is_the_middle_of_its_panorama():
    scene = read_light(LIGHTS_FOLDER / "studio.exr")
    luminance = scene.pixels @ LUMINANCE
    assert scene.pixels.shape == (410, 1024, 3)
    assert np.exp(np.log(luminance[luminance > 0]).mean()) == pytest.approx(1, rel=1e-3)
