"""What several tests of the training share; PyTorch and SciPy are imported where they are used."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def work_folder(tmp_path_factory):
    """A folder with a pack of two splits: smooth scenes from black to clipping, and four responses."""
    from training.crfnet2017.pack import write_scenes

    path = tmp_path_factory.mktemp("crfnet2017")
    (path / "pack").mkdir()
    rng = np.random.default_rng(0)
    ramp = np.linspace(0, 1.2, 260 * 300 * 3).reshape(260, 300, 3)
    scenes = [(name, (ramp * rng.uniform(0.8, 1.2, ramp.shape)).astype(np.float16)) for name in ("one", "two")]
    for split in ("train", "validation"):
        write_scenes(scenes, path / "pack", split)
    curves = np.linspace(0, 1, 1024) ** np.array([[0.3], [0.45], [0.7], [1.0]])
    np.savez(path / "pack" / "curves.npz", curves=curves.astype(np.float32), exposures=np.float32([1, 1.1, 0.9, 1]))
    return path


@pytest.fixture(scope="module")
def pack(work_folder):
    """The training split of the pack."""
    from training.crfnet2017.pack import read_pack

    return read_pack(work_folder / "pack", "train")


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
