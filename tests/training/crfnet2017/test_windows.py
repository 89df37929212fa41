from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.statistics.windows import filled_bins
from training.crfnet2017.windows import augmented, draw_windows, render, scene_pixels
from training.data.scenes import Scene
from training.synthesis.camera import apply_response


@pytest.mark.parametrize(
    ("size", "shape"), [((460, 700), (230, 350)), ((453, 700), (453, 700)), ((690, 690), (230, 230))]
)
def test_scenes_are_averaged_to_just_above_a_window(size, shape):
    pixels = np.random.default_rng(0).random((*size, 3), np.float32)
    scaled = scene_pixels(Scene("made", pixels, False), 0)
    factor = size[0] // shape[0]
    assert scaled.shape == (3, *shape)
    np.testing.assert_allclose(scaled[:, 0, 0], pixels[:factor, :factor].mean(axis=(0, 1)), atol=1e-3)


@pytest.mark.parametrize("augment", [False, True])
def test_windows_meet_the_papers_rule(scenes, augment):
    (windows,) = draw_windows(scenes, 6, seed=1, augment=augment).inputs()
    assert windows.shape == (6, 3, 227, 227)
    assert min(filled_bins(window.numpy()) for window in windows) >= 220


def test_exposures_spread_evenly_around_that_of_the_response(scenes):
    factors = draw_windows(scenes, 60, seed=1).exposures
    assert 0.6 <= factors.min() < 0.68
    assert 1.32 < factors.max() <= 1.4
    assert len(factors.unique()) == 60


def test_dull_scenes_give_no_windows(scenes):
    dull = torch.full((3, 300, 300), 0.5, dtype=torch.float16)
    mixed = replace(scenes, pixels=(dull, scenes.pixels[0]))
    assert all(window.unique().numel() > 1 for window in draw_windows(mixed, 8, seed=1).codes)


def test_scenes_without_range_are_refused(scenes, monkeypatch):
    monkeypatch.setattr("training.crfnet2017.windows.TRIED", 2)
    dull = torch.full((3, 300, 300), 0.5, dtype=torch.float16)
    with pytest.raises(ValueError, match="give other scenes"):
        draw_windows(replace(scenes, pixels=(dull,)), 2, seed=1)


def test_light_is_rendered_as_the_simulated_camera_does(scenes):
    light = torch.rand(2, 3, 40, 40, generator=torch.Generator().manual_seed(0)) * 1.4
    classes, exposures = torch.tensor([2, 0]), torch.tensor([0.7, 1.3])
    found = render(light, scenes, classes, exposures).numpy().astype(int)
    for row, curve in enumerate(classes):
        factor = np.float32(exposures[row] * scenes.exposures[curve])
        codes = np.rint(apply_response(light[row].numpy() * factor, scenes.curves[curve].numpy()) * 255)
        assert np.abs(found[row] - codes).max() <= 1
        assert np.mean(found[row] != codes) < 1e-2


def test_the_windows_of_a_seed_are_the_same(scenes):
    first, again, other = (draw_windows(scenes, 2, seed=seed, augment=True).codes for seed in (3, 3, 4))
    assert torch.equal(first, again)
    assert not torch.equal(first, other)


def test_augmentation_of_neutral_light_only_scales_its_channels():
    """Color matrices keep neutrals, and the gains are one for each channel."""
    light = torch.linspace(0.1, 1, 227).expand(1, 3, 227, 227)
    found = augmented(light, light, torch.Generator().manual_seed(2))[0].flatten(1)
    correlation = np.corrcoef(found.numpy())
    np.testing.assert_allclose(correlation, 1, atol=1e-3)
