import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from training.model import NetworkConfig, ResponseNet, WindowNetwork, WindowStatistics

CONFIG = NetworkConfig(levels=16, grid=8, strides=(1, 4), width=32)


@pytest.fixture(scope="module")
def windows():
    """Two photographs of one random scene: linear, and through a square root."""
    rng = np.random.default_rng(0)
    coarse = rng.uniform(0, 1, (2, 3, 20, 20)).astype(np.float32)
    smooth = torch.nn.functional.interpolate(torch.from_numpy(coarse), size=227, mode="bilinear")
    return torch.cat([smooth[:1], smooth[:1].sqrt()])


@pytest.fixture(scope="module")
def statistics(windows):
    return WindowStatistics(CONFIG)(windows)


def test_shape_and_range(statistics):
    assert statistics.shape == (2, CONFIG.features)
    assert torch.isfinite(statistics).all()
    assert statistics.abs().max() < 30


def test_the_histogram_counts_levels():
    flat = torch.full((1, 3, 227, 227), 1.0)
    shares = WindowStatistics(CONFIG)._histogram((flat * 255).int()).exp() - 1e-2
    np.testing.assert_allclose(shares[0, 0, -1], CONFIG.levels, rtol=1e-5)
    np.testing.assert_allclose(shares[0, 0, :-1], 0, atol=1e-6)


def test_edges_of_a_linear_photograph_have_their_middle_in_the_middle(statistics):
    """A ramp mixes linearly, so b lies half-way on a linear photograph, and above after a concave response."""
    means = statistics[:, 3 * CONFIG.level_features :].unflatten(1, (2, 2, CONFIG.grid**2))[:, 1, 1].mean(dim=1)
    assert abs(float(means[0])) < 0.1
    assert float(means[1]) > float(means[0]) + 0.03


def test_a_row_of_known_triples():
    """One vertical edge of three grays in every row: a = 0, b = 128, c = 255."""
    picture = torch.zeros(1, 3, 227, 227)
    picture[:, :, :, 100] = 128 / 255
    picture[:, :, :, 101:] = 1
    a, b, c = (codes.int() for codes in _triples_of(picture))
    grid = WindowStatistics(CONFIG)._edge_grid(a, b, c)[0]
    counts, moments = grid.split(CONFIG.grid**2)
    edges = 3 * 227
    across, half = CONFIG.grid - 1, slice(3, 5)
    assert counts[across].exp() - 1 == pytest.approx(edges, rel=1e-3)
    assert moments[across] == pytest.approx(0, abs=1e-3)
    assert (counts[half].exp() - 1).sum() == pytest.approx(edges, rel=1e-3)
    assert (moments[half] < -1.9).all()


def _triples_of(picture):
    from training.model import _triples

    return _triples((picture * 255).round().int(), 1)


def test_channels_may_be_exchanged(windows):
    torch.manual_seed(0)
    network = WindowNetwork(WindowStatistics(CONFIG), ResponseNet(CONFIG)).eval()
    pixels = windows.permute(0, 2, 3, 1)
    with torch.inference_mode():
        np.testing.assert_allclose(network(pixels)[0], network(pixels[..., [2, 0, 1]])[0], atol=1e-5)


def test_windows_do_not_influence_each_other(windows, statistics):
    alone = WindowStatistics(CONFIG)(windows[1:])
    np.testing.assert_allclose(alone[0], statistics[1], atol=1e-5)
