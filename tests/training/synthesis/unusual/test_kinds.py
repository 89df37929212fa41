import numpy as np
import pytest

from crfnet_core.statistics.windows import WINDOW_SIZE
from training.synthesis.unusual import RENDERINGS, UnusualKind, random_exposure, unusual_photo, unusual_windows


@pytest.fixture
def light(scene):
    return np.stack([scene.pixels[:WINDOW_SIZE, x : x + WINDOW_SIZE] for x in (0, 200)])


def windows(kind, light, seed=1):
    return unusual_windows(kind, light, 0.3, np.random.default_rng(seed))


@pytest.mark.parametrize("kind", UnusualKind)
def test_windows_are_codes_that_depend_on_seed_and_light(kind, light):
    before = light.copy()
    codes = windows(kind, light)
    assert (codes.shape, codes.dtype) == (light.shape, np.uint8)
    assert np.ptp(codes) > 40
    np.testing.assert_array_equal(light, before)
    np.testing.assert_array_equal(codes, windows(kind, light))
    assert (codes != windows(kind, light, seed=2)).any()
    if kind is not UnusualKind.LINE_ART:  # it shows no light
        assert (codes != windows(kind, light[:, ::-1])).any()


@pytest.mark.parametrize("kind", UnusualKind)
def test_a_rendering_stays_in_range_in_darkness_and_in_the_sun(kind, light, rng):
    harsh = np.concatenate([np.zeros_like(light[:1]), light[:1] * 1e5])
    encoded = RENDERINGS[kind](harsh, rng)
    assert np.isfinite(encoded).all()
    assert encoded.min() >= -1e-6
    assert encoded.max() <= 1 + 1e-6


@pytest.mark.parametrize("kind", UnusualKind)
def test_a_photograph_is_a_whole_frame_that_can_be_analyzed(kind, scene):
    photo = unusual_photo(kind, scene, np.random.default_rng(3))
    assert min(photo.pixels.shape[:2]) >= WINDOW_SIZE
    if kind is not UnusualKind.MESSENGER:  # it scales
        assert photo.pixels.shape == scene.pixels.shape


def test_limited_range_leaves_out_black_and_white(light, rng):
    encoded = RENDERINGS[UnusualKind.LIMITED_RANGE](light * np.float32(3), rng)
    assert encoded.min() >= 16 / 255
    assert encoded.max() == pytest.approx(235 / 255)


def test_the_exposure_saturates_a_few_percent(scene, rng):
    saturated = (scene.pixels.max(axis=-1) * random_exposure(scene.pixels, rng) > 1).mean()
    assert 0.003 < saturated < 0.16
