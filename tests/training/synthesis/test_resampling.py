import numpy as np
import pytest

from training.data.scenes import Scene
from training.synthesis.resampling import AffineResampling


@pytest.fixture
def scene():
    """A smooth ramp along rows, with columns of another color."""
    y, x = np.mgrid[:300, :500].astype(np.float32)
    return Scene("made", np.stack([1 + y, 1 + x, 2 + np.sin(y / 9) + np.cos(x / 9)], axis=-1), False)


def test_an_upright_window_shows_the_pixels(scene):
    light = AffineResampling(scene, np.eye(2), np.array([150.0, 200.0])).window()
    assert light.shape == (227, 227, 3)
    assert light.dtype == np.float32
    np.testing.assert_allclose(light[1:, 1:, 0] - light[:-1, 1:, 0], 1, atol=1e-4)
    np.testing.assert_allclose(light[113, 113, :2], [151, 201], atol=1)


def test_a_window_of_twice_the_scale_shows_more_and_turns(scene):
    quarter = np.array([[0.0, -2.0], [2.0, 0.0]])
    light = AffineResampling(scene, quarter, np.array([150.0, 250.0])).window()
    inner = light[100:130, 100:130]
    np.testing.assert_allclose(np.diff(inner[:, :, 0], axis=1), -2, atol=1e-3)
    np.testing.assert_allclose(np.diff(inner[:, :, 1], axis=0), 2, atol=1e-3)
