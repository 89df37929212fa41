from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.statistics.windows import filled_bins
from training.crfnet2017.windows import (
    LinearWindows,
    WindowStream,
    code_table,
    draw_windows,
    render_windows,
    scene_pixels,
)
from training.data.scenes import Scene


@pytest.mark.parametrize(
    ("size", "shape"), [((460, 700), (230, 350)), ((453, 700), (453, 700)), ((690, 690), (230, 230))]
)
def test_scenes_are_averaged_to_just_above_a_window(size, shape):
    pixels = np.random.default_rng(0).random((*size, 3), np.float32)
    scaled = scene_pixels(Scene("made", pixels, False), 0)
    factor = size[0] // shape[0]
    assert scaled.shape == (*shape, 3)
    np.testing.assert_allclose(scaled[0, 0], pixels[:factor, :factor].mean(axis=(0, 1)), atol=1e-3)


def test_windows_meet_the_papers_rule(scenes):
    windows = render_windows(draw_windows(scenes, 6, np.random.default_rng(1)), torch.from_numpy(scenes.curves))
    assert windows.shape == (6, 3, 227, 227)
    assert min(filled_bins(window.numpy()) for window in windows) >= 220


def test_exposures_spread_evenly_around_that_of_the_response(scenes):
    batch = draw_windows(scenes, 60, np.random.default_rng(1))
    factors = batch.exposures.numpy() / scenes.exposures[batch.classes]
    assert 0.6 <= factors.min() < 0.68
    assert 1.32 < factors.max() <= 1.4
    assert len(np.unique(factors)) == 60


def test_dull_scenes_give_no_windows(scenes):
    dull = np.full((300, 300, 3), 0.5, np.float16)
    mixed = replace(scenes, pixels=(dull, scenes.pixels[0]))
    irradiance = draw_windows(mixed, 8, np.random.default_rng(1)).irradiance
    assert all(window.unique().numel() > 1 for window in irradiance)


def test_the_device_makes_the_codes_of_the_host(scenes):
    batch = draw_windows(scenes, 2, np.random.default_rng(2))
    codes = (render_windows(batch, torch.from_numpy(scenes.curves)) * 255).permute(0, 2, 3, 1).round().byte().numpy()
    for n, curve in enumerate(batch.classes):
        table = code_table(scenes.curves[curve], float(batch.exposures[n]))
        assert np.mean(codes[n] != table[batch.irradiance[n].numpy().view(np.uint16)]) < 1e-3


def test_a_known_irradiance_gets_a_known_code():
    irradiance = torch.full((1, 227, 227, 3), 0.5, dtype=torch.float16)
    square = torch.linspace(0, 1, 1024)[None] ** 2
    windows = render_windows(LinearWindows(irradiance, torch.tensor([0]), torch.tensor([1.2])), square)
    assert windows.unique().tolist() == pytest.approx([92 / 255])


def test_the_windows_of_a_step_do_not_depend_on_the_start(scenes):
    def irradiance(steps):
        return [batch.irradiance for batch in WindowStream(scenes, batch=2, steps=steps, seed=3)]

    assert torch.equal(irradiance(range(4))[3], irradiance(range(3, 4))[0])
