import json
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.statistics import LENGTH, unpack
from crfnet_core.statistics.gradients import LEVELS
from training.network import train as training_run
from training.network.model import NetworkConfig
from training.network.shards import CurveSet, read_shards
from training.network.train import TrainingConfig, train

SIZES = NetworkConfig(width=32, dropout=0.1)
RECIPE = TrainingConfig(epochs=4, batch=32, learning_rate=3e-3, averaged_steps=2)


@pytest.fixture(scope="module")
def shards(tmp_path_factory):
    """Photographs whose histograms shift in proportion to the first EMoR weight."""
    folder = tmp_path_factory.mktemp("shards")
    rng = np.random.default_rng(0)
    for split, number in (("train", 0), ("train", 1), ("validation", 0)):
        weights = np.zeros((256, 11))
        weights[:, 0] = rng.normal(0, 2, 256)
        statistics = rng.uniform(0, 1, (256, 2, LENGTH)).astype(np.float16)
        parts = unpack(statistics)
        parts["channel_equations"][:] = 0  # gray: random numbers would be no normal equations
        parts["histogram"][:] = np.exp(np.outer(weights[:, 0], np.linspace(-1, 1, LEVELS)))[:, None, None]
        assert (statistics[0, 0, : 3 * LEVELS] == parts["histogram"][0, 0].ravel()).all()
        sets = (np.arange(256) % 3).astype(np.int8)
        path = folder / f"{split}_{number:04d}.npz"
        rows = {"statistics": statistics, "weights": weights.astype(np.float32)}
        np.savez(path, **rows, curve_sets=sets)
    return folder


def read_log(run):
    return [float(line.split(",")[3]) for line in (run / "log.csv").read_text().splitlines()]


def test_training_learns_and_logs(shards, tmp_path):
    last = train(shards, tmp_path / "run", replace(RECIPE, epochs=8), SIZES)
    errors = read_log(tmp_path / "run")
    assert len(errors) == 8
    assert errors[-1] < 0.7 * errors[0]
    assert last.exists()
    assert json.loads((tmp_path / "run" / "run.json").read_text())["recipe"]["network"]["width"] == 32


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
    first, second = (
        torch.load(tmp_path / run / "last.pt", weights_only=True)["network"] for run in ("whole", "halves")
    )
    assert all(torch.equal(first[name], second[name]) for name in first)


def test_held_out_curves_can_be_left_out(shards, tmp_path):
    train(shards, tmp_path / "p2", replace(RECIPE, epochs=1, without_held_out=True), SIZES)
    settings = json.loads((tmp_path / "p2" / "run.json").read_text())["recipe"]
    assert settings["photographs"] == sum(n % 3 != CurveSet.HELD_OUT for n in range(256)) * 2 == 342
    assert settings["training"]["without_held_out"]


def test_a_run_starts_from_the_weights_of_another(shards, tmp_path):
    first = train(shards, tmp_path / "first", replace(RECIPE, epochs=1), SIZES)
    rested = replace(RECIPE, epochs=1, learning_rate=1e-12)
    second = train(shards, tmp_path / "second", rested, SIZES, init=first)
    before, after = (dict(torch.load(run, weights_only=True)["network"]) for run in (first, second))
    for name in ("photograph.location.weight", "score.weight"):
        torch.testing.assert_close(after[name], before[name])
    start = json.loads((tmp_path / "second" / "run.json").read_text())["start"]
    assert start.startswith("last.pt, SHA-256 ")


def test_the_families_are_those_that_the_network_states(shards):
    photographs = read_shards(shards, "train")
    assert not photographs.families.any()
    every = replace(photographs.only(torch.arange(512) < 7), curve_sets=torch.arange(7, dtype=torch.int8))
    assert every.families.tolist() == [0, 0, 0, 0, 1, 2, 3]
