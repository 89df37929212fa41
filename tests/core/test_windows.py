import numpy as np
import pytest

from crfnet_core.statistics.windows import WINDOW_SIZE, Window, cut_windows, filled_bins, sampling_step, select_windows


def noise(height, width, *, codes=256, seed=0):
    return np.random.default_rng(seed).integers(0, codes, (height, width, 3)).astype(np.float32) / np.float32(255)


@pytest.fixture(scope="module")
def half_flat():
    """A photograph whose left half is flat: only windows that reach into the right half cover the range."""
    pixels = noise(500, 1000)
    pixels[:, :500] = 0.5
    return pixels


def test_windows_that_cover_the_range_are_preferred(half_flat):
    windows = select_windows(half_flat)
    assert len(windows) == 10
    assert all(window.covers_range for window in windows)
    assert all(window.x + window.extent > 500 for window in windows)


def test_any_window_will_do_when_no_coverage_is_asked_for_and_a_seed_gives_the_same_windows(half_flat):
    windows = select_windows(half_flat, count=20, coverage=0)
    assert not all(window.covers_range for window in windows)
    assert windows[:3] == select_windows(half_flat, count=3, coverage=0)
    assert windows[:3] != select_windows(half_flat, count=3, coverage=0, seed=4)


def test_filled_counts_the_bins_of_all_channels_together():
    pixels = np.zeros((4, 4, 3), np.float32)
    pixels[0, 0] = [1 / 255, 2 / 255, 1]
    assert (filled_bins(pixels), filled_bins(noise(100, 100))) == (4, 256)


def test_a_poor_photograph_gets_the_best_windows_there_are():
    pixels = noise(454, 454, codes=100)
    pixels[:, 300:] = 0
    windows = select_windows(pixels, count=5)
    assert len(windows) == 5
    assert not any(window.covers_range for window in windows)
    assert min(window.filled for window in windows) >= 99


@pytest.mark.parametrize(
    ("height", "width", "step"), [(227, 227, 1), (907, 2000, 1), (908, 908, 2), (4000, 6000, 8), (8000, 6000, 13)]
)
def test_large_photographs_are_point_sampled(height, width, step):
    assert sampling_step(height, width) == step


def test_a_window_takes_every_step_th_pixel():
    pixels = noise(700, 900)
    window = Window(x=10, y=20, step=3, filled=0)
    samples = cut_windows(pixels, [window])
    assert samples.shape == (1, WINDOW_SIZE, WINDOW_SIZE, 3)
    np.testing.assert_array_equal(samples[0, 5, 7], pixels[20 + 15, 10 + 21])
    assert window.extent == 226 * 3 + 1


@pytest.mark.parametrize(("height", "width"), [(500, 1000), (910, 1300), (240, 240)])
def test_windows_begin_at_even_rows_and_columns(height, width):
    windows = select_windows(noise(height, width), count=20)
    assert len({(window.x, window.y) for window in windows}) == 20
    assert all(window.x % 2 == 0 and window.y % 2 == 0 for window in windows)
