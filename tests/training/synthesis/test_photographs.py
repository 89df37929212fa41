import numpy as np
import pytest

from crfnet_core.response.curve import UNIFORM
from training.data.curves import CurveSource
from training.synthesis import augmentation
from training.synthesis.augmentation import composited, recolor
from training.synthesis.camera import reference_luminance
from training.synthesis.camera_draws import WINDOWS
from training.synthesis.photographs import LEAST_FILLED, ONE_CHANNEL, PhotographSource


@pytest.fixture
def source(scene):
    sets = [CurveSource(UNIFORM[None] ** power, (), camera_fraction=0, plain_fraction=1) for power in (0.3, 0.5)]
    return PhotographSource([scene], tuple(each.draw for each in sets), (0.25, 0.75), reference_luminance([scene]))


def test_photographs_cover_the_range_and_repeat_with_the_seed(source):
    first, second = (source.draw(np.random.default_rng(3)) for _ in range(2))
    assert first
    for one, other in zip(first, second, strict=True):
        assert one.windows.shape == (WINDOWS, 227, 227, 3)
        assert one.windows.dtype == np.uint8
        assert max(len(np.unique(window)) for window in one.windows) >= LEAST_FILLED
        np.testing.assert_array_equal(one.windows, other.windows)
        np.testing.assert_array_equal(one.curve, other.curve)


def test_curves_come_from_the_sets_in_the_given_fractions(source):
    rng = np.random.default_rng(0)
    drawn = [source.draw_curve(rng) for _ in range(400)]
    for curve, chosen in drawn:
        np.testing.assert_allclose(curve, UNIFORM ** (0.3, 0.5)[chosen])
    assert np.mean([chosen for _, chosen in drawn]) == pytest.approx(0.75, abs=0.06)


def test_augmentation_treats_all_windows_alike_and_leaves_them_unchanged(scene):
    light = np.stack([scene.pixels[:227, :227]] * 2)
    before = light.copy()
    for seed in range(20):
        turned = recolor(light, np.random.default_rng(seed))
        assert turned.shape == light.shape
        np.testing.assert_allclose(turned[0], turned[1], rtol=1e-5)
    np.testing.assert_array_equal(light, before)


def test_most_photographs_of_gray_scenes_have_equal_channels_also_with_noise(source, monkeypatch):
    monkeypatch.setattr(augmentation, "GRAY", 1.0)
    photos = [photo for seed in range(20) for photo in source.draw(np.random.default_rng(seed))]
    is_equal = [np.ptp(photo.windows, axis=-1).max() == 0 for photo in photos]
    assert ONE_CHANNEL - 0.1 < np.mean(is_equal) < 0.95


def test_a_composited_window_shows_both_and_mixes_them_at_the_border():
    ones, threes = (np.full((WINDOWS, 227, 227, 3), value, np.float32) for value in (1, 3))
    light = composited(ones, threes, np.random.default_rng(0))
    assert (light == 1).any(axis=(1, 2, 3)).all()
    assert (light.max(axis=(1, 2, 3)) == light.max()).all()
    between = (light > 1) & (light < light.max())
    assert 0 < between.mean() < 0.02
