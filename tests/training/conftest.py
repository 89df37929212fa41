"""What several tests of the training share; PyTorch and SciPy are imported where they are used."""

import numpy as np
import pytest

from crfnet_core.response.curve import UNIFORM


@pytest.fixture(scope="session")
def scenes():
    """Smooth scenes from black to clipping, and four responses, as the paper's network trains on them."""
    import torch

    from training.crfnet2017.windows import TrainingScenes

    rng = np.random.default_rng(0)
    ramp = np.linspace(0, 1.2, 260 * 300 * 3).reshape(260, 300, 3).transpose(2, 0, 1)
    pixels = tuple(torch.from_numpy((ramp * rng.uniform(0.8, 1.2, ramp.shape)).astype(np.float16)) for _ in range(2))
    curves = UNIFORM ** np.array([[0.3], [0.45], [0.7], [1.0]])
    return TrainingScenes(pixels, torch.from_numpy(np.float32(curves)), torch.tensor([1, 1.1, 0.9, 1]))


@pytest.fixture(scope="session")
def model(fixed_model):
    """The fixed model, as an evaluation knows it."""
    from training.evaluation.models import Model

    return Model.find(str(fixed_model))


@pytest.fixture
def out(tmp_path):
    """The folder of imported scenes, which the import makes."""
    return tmp_path / "data" / "linear"


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.fixture
def scene(rng):
    """Smooth light over many stops, with texture."""
    from training.data.scenes import Scene

    y, x = np.mgrid[:300, :500] / 100
    light = np.exp(np.sin(3 * x) + np.cos(2 * y) + 0.3 * rng.standard_normal((300, 500)))
    return Scene("made", (light[:, :, None] * [1.0, 0.8, 0.6]).astype(np.float32), False)
