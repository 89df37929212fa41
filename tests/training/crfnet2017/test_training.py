import os
import socket
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")
pytest.importorskip("onnxscript", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.network import MODELS, ResponseNetwork
from crfnet_core.response.emor import EmorBasis
from training.crfnet2017.checkpoints import TrainingState, fold_normalization, start_from
from training.crfnet2017.export import ShippedCRFNet, load_network
from training.crfnet2017.likelihood import Likelihood
from training.crfnet2017.network import CRFNet
from training.crfnet2017.recipes import RECIPES, Recipe, RunConfig, learning_rate, make_optimizer
from training.crfnet2017.stages import StageTask
from training.crfnet2017.train import train
from training.crfnet2017.trainer import ProcessContext, Trainer
from training.crfnet2017.windows import WindowStream, draw_windows, render_windows
from training.export.golden import PARITY, assert_parity, write_golden
from training.export.model_folder import write_config
from training.export.onnx_graph import WINDOWED, export_onnx, rounded
from training.network.moving_average import moving_average
from training.provenance import read_run

CPU = torch.device("cpu")

#: What an answer may be worth.
LIKELIHOOD = Likelihood(np.linspace(0.2, 0.9, 5), np.linspace(-1, 1, 5), np.tril(np.full((5, 5), 0.5)), -2.0)

EXACT = Recipe(batch=2, mixed=False, channels_last=False, averaged_steps=2.0)
PLAIN = Recipe("sgd", 0.01, batch=2, mixed=False, channels_last=False, clip=0.0)
REGRESSION = RunConfig("regress", EXACT, steps=2, validate_every=2)

#: One process of two: a step, a checkpoint, and its own weights beside it.
ONE_OF_TWO = """
import sys
from pathlib import Path
import torch
from training.crfnet2017.recipes import Recipe, RunConfig
from training.crfnet2017.train import train
from training.crfnet2017.trainer import join_processes
torch.set_num_threads(1)
work_folder, recipe = Path(sys.argv[1]), Recipe("sgd", 0.01, batch=2, mixed=False, channels_last=False, clip=0.0)
config = RunConfig("regress", recipe, 2, validate_every=2)
state = train(work_folder / "pack", work_folder / "two", config, validation_windows=3, stop=1)
torch.save(state.network.state_dict(), work_folder / f"rank{join_processes().rank}.pt")
"""


@pytest.fixture(scope="module")
def run(work_folder):
    """A run of two steps that was not stopped."""
    train(work_folder / "pack", work_folder / "whole", REGRESSION, validation_windows=3)
    return work_folder / "whole"


@pytest.fixture(scope="module")
def model(work_folder, run):
    """The model folder of the run, with a likelihood by hand and its golden file beside it."""
    model = work_folder / "crfnet2017"
    model.mkdir()
    network = ShippedCRFNet(rounded(load_network(run)), LIKELIHOOD).eval()
    export_onnx(network, WINDOWED, model / "model.onnx")
    write_config(model, WINDOWED, read_run(run))
    write_golden(network, WINDOWED, work_folder / "golden.npz")
    return model


def weights_of(path):
    return torch.load(path, weights_only=True)["network"]


def head_gradient(pack, rank):
    """The gradient of the head at the first step of a process."""
    torch.manual_seed(1)
    network, task = CRFNet(), StageTask("regress", pack.curves, squared=False, device=CPU)
    (batch,) = WindowStream(pack, batch=2, steps=range(1), seed=1, rank=rank)
    task.loss(network(render_windows(batch, torch.from_numpy(pack.curves))), batch.classes).backward()
    return network.head.weight.grad


def equal(first, second):
    return first.keys() == second.keys() and all(torch.equal(first[name], second[name]) for name in first)


def test_the_network_has_the_papers_parameters():
    counts = [sum(parameter.numel() for parameter in CRFNet(outputs).parameters()) for outputs in (11, 201)]
    assert counts == [3_864_203, 3_864_203 + 190 * (23 * 23 * 512 + 1)]


def test_the_network_begins_with_the_mean_response():
    outputs = CRFNet()(torch.rand(2, 3, 227, 227))
    assert outputs.shape == (2, 11)
    assert not outputs.any()


def test_the_stages_measure_what_they_say():
    curves = EmorBasis.load().reconstruct(np.eye(3, 11))
    classify = StageTask("classify", curves, squared=False, device=CPU)
    regress = StageTask("regress", curves, squared=False, device=CPU)
    classes = torch.tensor([0, 2])
    assert (classify.outputs, regress.outputs) == (3, 11)
    assert classify.figures(torch.eye(3)[[0, 1]], classes).tolist() == [1, 0]
    assert float(classify.loss(torch.zeros(2, 3), classes)) == pytest.approx(np.log(3))
    assert regress.figures(torch.zeros(2, 11), classes).tolist() == pytest.approx([1, 1], abs=1e-5)
    assert float(regress.loss(torch.zeros(2, 11), classes)) == pytest.approx(1, abs=1e-5)
    halved = StageTask("regress", curves, squared=True, device=CPU)
    assert float(halved.loss(torch.zeros(2, 11), classes)) == pytest.approx(0.5, abs=1e-5)
    assert classify.is_better(0.2, [0.1])
    assert not regress.is_better(0.2, [0.1])


def test_the_learning_rate_follows_the_recipe():
    paper, default = RECIPES["paper"], RECIPES["default"]
    assert [learning_rate(paper, step, 30) for step in (0, 10, 29)] == pytest.approx([1e-2, 1e-3, 1e-4])
    assert [learning_rate(default, step, 100) for step in (0, 10, 55)] == pytest.approx([5e-5, 1e-3, 5e-4])


def test_the_first_stage_learns(pack):
    config = RunConfig("classify", Recipe(batch=2, learning_rate=2e-3, head_factor=0.01), steps=3)
    task = StageTask("classify", pack.curves, squared=False, device=CPU)
    torch.manual_seed(0)
    network = CRFNet(task.outputs)
    averaged = moving_average(network, config.recipe.averaged_steps)
    state = TrainingState(network, averaged, make_optimizer(network, config.recipe))
    batch = draw_windows(pack, 2, np.random.default_rng(5))
    trainer = Trainer(config, task, state, ProcessContext(CPU), pack, batch)
    losses = [float(trainer.step(batch)) for _ in range(3)]
    assert losses[0] == pytest.approx(np.log(4), abs=1e-3)
    assert min(losses) < 0.8 * losses[0]


def test_a_run_logs_and_draws(run):
    header, row = (run / "log.csv").read_text().splitlines()
    assert header == "step,train_loss,validation,windows_per_s,fraction_waiting"
    assert row.startswith("2,")
    assert (run / "curves.png").read_bytes().startswith(b"\x89PNG")
    assert read_run(run)["recipe"]["recipe"]["batch"] == 2


def test_a_stopped_run_goes_on_as_if_it_had_not_stopped(work_folder, run):
    train(work_folder / "pack", work_folder / "halves", REGRESSION, validation_windows=3, stop=1)
    state = train(work_folder / "pack", work_folder / "halves", REGRESSION, validation_windows=3)
    assert state.step == 2
    assert equal(weights_of(work_folder / "halves" / "last.pt"), weights_of(run / "last.pt"))


def test_a_run_yields_the_moving_average_of_its_weights(work_folder):
    train(work_folder / "pack", work_folder / "averaged", REGRESSION, validation_windows=3, stop=1)
    first = torch.load(work_folder / "averaged" / "last.pt", weights_only=True)
    train(work_folder / "pack", work_folder / "averaged", REGRESSION, validation_windows=3)
    second = torch.load(work_folder / "averaged" / "last.pt", weights_only=True)
    assert equal(first["network"], first["moving"])
    assert not torch.equal(second["network"]["head.weight"], second["moving"]["head.weight"])
    trained = [name for name, _ in CRFNet().named_parameters()]
    for name in trained:
        mean = (second["moving"][name] + first["moving"][name]) / 2
        assert torch.allclose(second["network"][name], mean, rtol=1e-5, atol=1e-7)
    assert equal(weights_of(work_folder / "averaged" / "best.pt"), second["network"])


def test_another_configuration_is_refused(work_folder, run):
    with pytest.raises(SystemExit, match="another seed"):
        train(work_folder / "pack", run, replace(REGRESSION, seed=2))


def test_the_second_stage_takes_all_but_the_head(tmp_path):
    first, second = CRFNet(3), CRFNet()
    torch.nn.init.ones_(first.head.weight)
    torch.save({"network": first.state_dict()}, tmp_path / "best.pt")
    assert not start_from(second, tmp_path, torch.empty(0))
    assert equal(first.body.state_dict(), second.body.state_dict())
    assert not second.head.weight.any()


def test_two_processes_move_the_weights_by_the_mean_gradient(work_folder, pack):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    shared = os.environ | {"WORLD_SIZE": "2", "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": port, "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", ONE_OF_TWO, str(work_folder)]
    processes = [subprocess.Popen(command, env=shared | {"RANK": rank, "LOCAL_RANK": rank}) for rank in ("0", "1")]
    assert [process.wait(100) for process in processes] == [0, 0]
    first, second = (torch.load(work_folder / f"rank{rank}.pt", weights_only=True) for rank in (0, 1))
    trained = [name for name, _ in CRFNet().named_parameters()]
    assert all(torch.equal(first[name], second[name]) for name in trained)

    gradients = torch.stack([head_gradient(pack, rank) for rank in (0, 1)])
    config = RunConfig("regress", PLAIN, 2, validate_every=2)
    rate = learning_rate(PLAIN, 0, 2) * PLAIN.head_factor
    assert torch.allclose(first["head.weight"], -rate * gradients.mean(dim=0), rtol=1e-3, atol=1e-9)
    assert not torch.allclose(gradients[0], gradients[1], rtol=0.1)
    alone = train(work_folder / "pack", work_folder / "two", config, validation_windows=3)
    assert (alone.step, len(alone.rows)) == (2, 1)


def test_the_model_folder_says_what_torch_says(model, work_folder):
    assert assert_parity(model, work_folder / "golden.npz") < PARITY
    assert 7.7e6 < (model / "model.onnx").stat().st_size < 7.9e6
    found = ResponseNetwork.load(model).predict(np.random.default_rng(0).random((3, 227, 227, 3), np.float32))
    assert np.stack([evidence.location for evidence in found.windows]).std(axis=0).min() > 0
    for evidence in found.windows:
        np.testing.assert_allclose(evidence.factor, LIKELIHOOD.factor, rtol=1e-6)
        np.testing.assert_allclose(evidence.log_odds, LIKELIHOOD.log_odds)


def test_locations_are_the_answers_without_slope_and_offset(model, run):
    windows = np.random.default_rng(0).random((2, 227, 227, 3), np.float32)
    with torch.inference_mode():
        answers = rounded(load_network(run))(torch.from_numpy(windows)).numpy()[:, :5]
    found = np.stack([evidence.location for evidence in ResponseNetwork.load(model).predict(windows).windows])
    np.testing.assert_allclose(found, (answers - LIKELIHOOD.intercepts) / LIKELIHOOD.slopes, atol=1e-3)


def test_training_goes_on_from_a_model_folder(model, run):
    torch.manual_seed(4)
    windows = torch.rand(4, 3, 227, 227)
    network, exported = CRFNet(), load_network(run)
    assert start_from(network, model, windows)
    with torch.inference_mode():
        expected = rounded(exported)(windows.permute(0, 2, 3, 1))
        assert torch.allclose(network.eval()(windows), expected, atol=1e-4)
        normal = network.train().body[:2](windows * 2 - 1)
    assert normal.mean(dim=(0, 2, 3)).tolist() == pytest.approx(network.body[1].bias.tolist(), abs=1e-4)


def test_training_goes_on_from_the_packaged_model():
    (folder,) = MODELS.glob("crfnet2017*")
    network, windows = CRFNet(), torch.rand(2, 3, 227, 227, generator=torch.Generator().manual_seed(0))
    assert start_from(network, folder, windows)
    with torch.inference_mode():
        weights = network.eval()(windows).double().numpy()[:, :5]
    found = ResponseNetwork.load(folder).predict(windows.permute(0, 2, 3, 1).contiguous().numpy()).windows
    locations = np.stack([evidence.location for evidence in found])
    slopes = (weights[0] - weights[1]) / (locations[0] - locations[1])
    np.testing.assert_allclose(weights, locations * slopes + (weights[0] - locations[0] * slopes), atol=1e-2)
    assert (slopes > 0).all()


def test_folding_changes_nothing():
    torch.manual_seed(0)
    network, windows = CRFNet(), torch.rand(2, 3, 227, 227)
    torch.nn.init.normal_(network.head.weight, std=1e-3)
    with torch.inference_mode():
        network(windows)
        expected = network.eval()(windows)
        assert torch.allclose(fold_normalization(network)(windows), expected, rtol=1e-3, atol=1e-3)


def test_a_run_of_the_first_stage_is_not_exported(tmp_path):
    torch.save({"network": CRFNet(3).state_dict(), "rows": []}, tmp_path / "best.pt")
    with pytest.raises(SystemExit, match="stage classify"):
        load_network(tmp_path)
