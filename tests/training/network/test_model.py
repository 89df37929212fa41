import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.statistics import window_statistics
from training.network.features import (
    CANDIDATE_FEATURES,
    EDGE_FEATURES,
    EQUATION_FEATURES,
    LEVEL_FEATURES,
    conjugate_gradients,
    features_of,
)
from training.network.model import (
    LARGEST_RAW,
    WEIGHT_UNITS,
    Head,
    KindLayer,
    NetworkConfig,
    PhotographNet,
    ShippedNetwork,
)

CONFIG = NetworkConfig(width=32)


@pytest.fixture(scope="module")
def statistics():
    """Of three windows of smooth random scenes, one through a square root."""
    coarse = torch.from_numpy(np.random.default_rng(0).uniform(0, 1, (3, 3, 20, 20)).astype(np.float32))
    windows = torch.nn.functional.interpolate(coarse, size=227, mode="bilinear").permute(0, 2, 3, 1).numpy()
    windows[2] = np.sqrt(windows[2])
    return torch.from_numpy(np.stack([window_statistics(window) for window in windows]))


@pytest.fixture(scope="module")
def network():
    torch.manual_seed(0)
    return PhotographNet(CONFIG).eval()


def test_features_are_finite_and_of_the_sizes_named(statistics):
    levels, edges, equations, candidates = features_of(statistics)
    assert levels.shape == (3, 3, LEVEL_FEATURES)
    assert edges.shape == (3, EDGE_FEATURES)
    assert equations.shape == (3, EQUATION_FEATURES)
    assert candidates.shape == (3, CANDIDATE_FEATURES)
    assert all(part.isfinite().all() and part.abs().max() < 30 for part in (levels, edges, equations, candidates))


def test_training_leaves_out_kinds_of_features_of_some_rows_only():
    torch.manual_seed(0)
    layer = KindLayer(5, NetworkConfig(width=8, kind_dropout=0.5))
    left_out = [(layer.drop_kind(torch.ones(400, 3, 5)) == 0) for _ in range(2)]
    assert all((rows.all(-1).all(-1) == rows.any(-1).any(-1)).all() for rows in left_out)
    assert left_out[0].float().mean() == pytest.approx(0.5, abs=0.1)
    assert not (layer.eval().drop_kind(torch.ones(400, 5)) == 0).any()


def test_conjugate_gradients_solve():
    generator = torch.Generator().manual_seed(1)
    root, right = torch.randn(4, 20, 20, generator=generator), torch.randn(4, 20, generator=generator)
    matrix = root @ root.mT + 5 * torch.eye(20)
    np.testing.assert_allclose(
        conjugate_gradients(matrix, right, steps=40), torch.linalg.solve(matrix, right), atol=1e-4
    )
    assert not conjugate_gradients(matrix, torch.zeros(4, 20), steps=40).any()


def test_windows_that_are_not_present_change_nothing(network, statistics):
    present = torch.tensor([[True, True, False]])
    with torch.inference_mode():
        found = network(statistics[None], present)
        alone = network(statistics[None, :2], present[:, :2])
    for part, own in zip(found[1], alone[1], strict=True):
        np.testing.assert_allclose(part, own, atol=1e-5)
    for part, own in zip(found[0], alone[0], strict=True):
        np.testing.assert_allclose(part[0, :2], own[0], atol=1e-5)


def test_the_order_of_windows_and_of_channels_does_not_matter(network, statistics):
    shipped = ShippedNetwork(network)
    with torch.inference_mode():
        expected = shipped(statistics)
        turned = shipped(statistics[[2, 0, 1]])
    for windows, turned_windows in zip(expected[:3], turned[:3], strict=True):
        np.testing.assert_allclose(turned_windows, windows[[2, 0, 1]], atol=1e-5)
    for pooled, turned_pooled in zip(expected[3:], turned[3:], strict=True):
        np.testing.assert_allclose(turned_pooled, pooled, atol=1e-5)
    assert [tuple(part.shape) for part in expected] == [(3, 5), (3, 5, 5), (3, 3), (1, 5), (1, 5, 5), (1, 3)]
    levels = features_of(statistics)[0]
    assert not torch.allclose(levels[:, 0], levels[:, 1])


def test_factors_are_triangular_with_a_bounded_positive_diagonal():
    torch.manual_seed(2)
    head = Head(8, CONFIG).eval()
    with torch.inference_mode():
        _, factors, _ = head(1000 * torch.randn(50, 8))
    in_units = factors * torch.tensor(WEIGHT_UNITS)[:, None]
    assert not torch.triu(factors, 1).any()
    diagonal = in_units.diagonal(dim1=1, dim2=2).log()
    assert diagonal.abs().max() == pytest.approx(LARGEST_RAW, rel=1e-4)
    assert in_units.abs().max() <= np.exp(LARGEST_RAW) * 1.001
