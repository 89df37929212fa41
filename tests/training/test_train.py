import json

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.emor import EmorBasis
from training import train as training_run
from training.dataset import TARGET_STRIDE, read_shards
from training.model import NetworkConfig
from training.train import CurveLoss, TrainingConfig, train

SIZES = NetworkConfig(levels=4, grid=2, strides=(1,), width=32, dropout=0.1)
RECIPE = TrainingConfig(epochs=4, batch=32, learning_rate=3e-3)


@pytest.fixture(scope="module")
def shards(tmp_path_factory):
    """Statistics that hold the first two EMoR weights, hidden among noise."""
    folder = tmp_path_factory.mktemp("shards")
    rng, basis = np.random.default_rng(0), EmorBasis.load()
    for split, number in (("train", 0), ("train", 1), ("validation", 0)):
        weights = np.zeros((512, 11))
        weights[:, :2] = rng.normal(0, 2, (512, 2))
        statistics = rng.normal(0, 1, (512, SIZES.features)).astype(np.float16)
        for channel in range(3):
            start = channel * SIZES.level_features
            statistics[:, start : start + 2] = weights[:, :2]
        curves = basis.reconstruct(weights)[:, ::TARGET_STRIDE].astype(np.float32)
        np.savez(folder / f"{split}_{number:04d}.npz", statistics=statistics, curves=curves)
    return folder


def read_log(run):
    return [float(line.split(",")[2]) for line in (run / "log.csv").read_text().splitlines()]


def test_training_learns_and_logs(shards, tmp_path):
    best = train(shards, tmp_path / "run", TrainingConfig(epochs=12, batch=32, learning_rate=3e-3), SIZES)
    errors = read_log(tmp_path / "run")
    assert len(errors) == 12
    assert min(errors) < 0.7 * errors[0]
    assert best.exists()
    assert json.loads((tmp_path / "run" / "config.json").read_text())["network"]["width"] == 32


def test_a_stopped_run_goes_on_as_if_it_had_not_stopped(shards, tmp_path, monkeypatch):
    train(shards, tmp_path / "whole", RECIPE, SIZES)
    real, done = training_run._train_epoch, []

    def stopping(*arguments):
        if len(done) == 2:
            raise KeyboardInterrupt
        done.append(1)
        return real(*arguments)

    monkeypatch.setattr(training_run, "_train_epoch", stopping)
    with pytest.raises(KeyboardInterrupt):
        train(shards, tmp_path / "halves", RECIPE, SIZES)
    monkeypatch.setattr(training_run, "_train_epoch", real)
    train(shards, tmp_path / "halves", RECIPE, SIZES)
    assert read_log(tmp_path / "halves") == read_log(tmp_path / "whole")
    first, second = (torch.load(tmp_path / run / "last.pt", weights_only=True)["net"] for run in ("whole", "halves"))
    assert all(torch.equal(first[name], second[name]) for name in first)


def test_the_loss_is_the_estimation_error():
    weights = torch.zeros(1, 11)
    moved = weights.clone()
    moved[0, 0] = 1.0
    curve = torch.from_numpy(EmorBasis.load().reconstruct(moved.numpy())[:, ::TARGET_STRIDE]).float()
    loss = CurveLoss()
    assert float(loss.errors(moved, curve)) == pytest.approx(0, abs=2e-3)
    assert float(loss.errors(weights, curve)) == pytest.approx(1, abs=0.02)


def test_absent_shards_are_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="no shards of the split train"):
        read_shards(tmp_path, "train")
