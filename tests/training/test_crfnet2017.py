import json
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

from crfnet_core.emor import EmorBasis
from crfnet_core.network import ResponseNetwork
from crfnet_core.windows import filled_bins
from training.crfnet2017 import pack as packing
from training.crfnet2017.checkpoints import Progress, fold_normalisation, start_from
from training.crfnet2017.export import load_network
from training.crfnet2017.network import CRFNet, parameter_count
from training.crfnet2017.pack import area_scaled, read_pack, write_scenes
from training.crfnet2017.recipes import RECIPES, Recipe, RunConfig, learning_rate, make_optimizer
from training.crfnet2017.stages import StageTask
from training.crfnet2017.train import Place, Trainer, train
from training.crfnet2017.windows import LinearWindows, WindowStream, code_table, draw_windows, render_windows
from training.export.model_folder import (
    PARITY,
    UNCALIBRATED,
    WINDOWED,
    assert_parity,
    export_onnx,
    rounded,
    write_config,
    write_golden,
)

CPU = torch.device("cpu")
EXACT = Recipe(batch=2, mixed=False, channels_last=False)
PLAIN = Recipe("sgd", 0.01, batch=2, mixed=False, channels_last=False, clip=0.0)
REGRESSION = RunConfig("regress", EXACT, steps=2, validate_every=2)

#: One process of two: a step, a checkpoint, and its own weights beside it.
ONE_OF_TWO = """
import sys
from pathlib import Path
import torch
from training.crfnet2017.recipes import Recipe, RunConfig
from training.crfnet2017.train import join_processes, train
torch.set_num_threads(1)
folder, recipe = Path(sys.argv[1]), Recipe("sgd", 0.01, batch=2, mixed=False, channels_last=False, clip=0.0)
config = RunConfig("regress", recipe, 2, validate_every=2)
progress = train(folder / "pack", folder / "two", config, validation_windows=3, stop=1)
torch.save(progress.network.state_dict(), folder / f"rank{join_processes().rank}.pt")
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A pack of two splits: smooth scenes from black to clipping, and four responses."""
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
def pack(folder):
    return read_pack(folder / "pack", "train")


@pytest.fixture(scope="module")
def run(folder):
    """A run of two steps that was not stopped."""
    train(folder / "pack", folder / "whole", REGRESSION, validation_windows=3)
    return folder / "whole"


@pytest.fixture(scope="module")
def model(folder, run, root):
    """The run's model folder, uncalibrated, with its golden file beside it."""
    model = folder / "crfnet2017"
    model.mkdir()
    network = rounded(load_network(run))
    export_onnx(network, WINDOWED, model / "model.onnx")
    write_config(model, WINDOWED, UNCALIBRATED)
    write_golden(network, WINDOWED, root / "tests" / "data" / "plate.jpg", folder / "golden.npz")
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
    assert parameter_count(CRFNet()) == 3_864_203
    assert parameter_count(CRFNet(201)) == 3_864_203 + 190 * (23 * 23 * 512 + 1)


def test_the_network_begins_with_the_mean_response():
    outputs = CRFNet()(torch.rand(2, 3, 227, 227))
    assert outputs.shape == (2, 11)
    assert not outputs.any()


def test_scenes_are_averaged_by_whole_factors():
    pixels = np.arange(800 * 802 * 3, dtype=np.float32).reshape(800, 802, 3)
    scaled = area_scaled(pixels)
    assert scaled.shape == (400, 401, 3)
    assert scaled[0, 0].tolist() == pixels[:2, :2].mean(axis=(0, 1)).tolist()
    assert area_scaled(pixels[:789]).shape == (789, 802, 3)


def test_a_pack_is_read_as_it_was_written(tmp_path, monkeypatch):
    monkeypatch.setattr(packing, "SHARD_SAMPLES", 700)
    scenes = [(str(n), np.full((10, 10 + n, 3), n, np.float16)) for n in range(4)]
    write_scenes(scenes, tmp_path, "train")
    np.savez(tmp_path / "curves.npz", curves=np.zeros((1, 1024)), exposures=np.ones(1))
    assert len(list(tmp_path.glob("train_*.npy"))) == 3
    for found, (_, pixels) in zip(read_pack(tmp_path, "train").scenes, scenes, strict=True):
        assert np.array_equal(found, pixels)


def test_an_absent_pack_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="no pack of the split train"):
        read_pack(tmp_path, "train")


def test_windows_meet_the_papers_rule(pack):
    windows = render_windows(draw_windows(pack, 6, np.random.default_rng(1)), torch.from_numpy(pack.curves))
    assert windows.shape == (6, 3, 227, 227)
    assert min(filled_bins(window.numpy()) for window in windows) >= 220


def test_dull_scenes_give_no_windows(pack):
    dull = np.full((300, 300, 3), 0.5, np.float16)
    mixed = replace(pack, scenes=(dull, pack.scenes[0]))
    irradiance = draw_windows(mixed, 8, np.random.default_rng(1)).irradiance
    assert all(window.unique().numel() > 1 for window in irradiance)


def test_a_photograph_gives_several_windows_if_asked(pack):
    batch = draw_windows(pack, 6, np.random.default_rng(1), per_photograph=3)
    assert batch.classes[:3].unique().numel() == 1
    assert batch.exposures[3:].unique().numel() == 1


def test_the_device_makes_the_codes_of_the_host(pack):
    batch = draw_windows(pack, 2, np.random.default_rng(2))
    codes = (render_windows(batch, torch.from_numpy(pack.curves)) * 255).permute(0, 2, 3, 1).round().byte().numpy()
    for n, curve in enumerate(batch.classes):
        table = code_table(pack.curves[curve], float(batch.exposures[n]))
        assert np.mean(codes[n] != table[batch.irradiance[n].numpy().view(np.uint16)]) < 1e-3


def test_a_known_irradiance_gets_a_known_code():
    irradiance = torch.full((1, 227, 227, 3), 0.5, dtype=torch.float16)
    square = torch.linspace(0, 1, 1024)[None] ** 2
    windows = render_windows(LinearWindows(irradiance, torch.tensor([0]), torch.tensor([1.2])), square)
    assert windows.unique().tolist() == pytest.approx([92 / 255])


def test_the_windows_of_a_step_do_not_depend_on_the_start(pack):
    def stream(steps, rank=0):
        return [batch.irradiance for batch in WindowStream(pack, batch=2, steps=steps, seed=3, rank=rank)]

    assert torch.equal(stream(range(4))[3], stream(range(3, 4))[0])
    assert not torch.equal(stream(range(3, 4))[0], stream(range(3, 4), rank=1)[0])


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
    progress = Progress(network, make_optimizer(network, config.recipe))
    batch = draw_windows(pack, 2, np.random.default_rng(5))
    trainer = Trainer(config, task, progress, Place(CPU), pack, batch)
    losses = [float(trainer.step(batch)) for _ in range(3)]
    assert losses[0] == pytest.approx(np.log(4), abs=1e-3)
    assert min(losses) < 0.8 * losses[0]


def test_a_run_logs_and_draws(run):
    header, row = (run / "log.csv").read_text().splitlines()
    assert header == "step,train_loss,validation,windows_per_s,share_waiting"
    assert row.startswith("2,")
    assert (run / "curves.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads((run / "config.json").read_text())["recipe"]["batch"] == 2


def test_a_stopped_run_goes_on_as_if_it_had_not_stopped(folder, run):
    train(folder / "pack", folder / "halves", REGRESSION, validation_windows=3, stop=1)
    progress = train(folder / "pack", folder / "halves", REGRESSION, validation_windows=3)
    assert progress.step == 2
    assert equal(weights_of(folder / "halves" / "last.pt"), weights_of(run / "last.pt"))


def test_another_configuration_is_refused(folder, run):
    with pytest.raises(SystemExit, match="another seed"):
        train(folder / "pack", run, replace(REGRESSION, seed=2))


def test_the_second_stage_takes_all_but_the_head(tmp_path):
    first, second = CRFNet(3), CRFNet()
    torch.nn.init.ones_(first.head.weight)
    torch.save({"network": first.state_dict()}, tmp_path / "best.pt")
    assert not start_from(second, tmp_path, torch.empty(0))
    assert equal(first.body.state_dict(), second.body.state_dict())
    assert not second.head.weight.any()


def test_two_processes_move_the_weights_by_the_mean_gradient(folder, pack):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    shared = os.environ | {"WORLD_SIZE": "2", "MASTER_ADDR": "127.0.0.1", "MASTER_PORT": port, "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-c", ONE_OF_TWO, str(folder)]
    processes = [subprocess.Popen(command, env=shared | {"RANK": rank, "LOCAL_RANK": rank}) for rank in ("0", "1")]
    assert [process.wait(100) for process in processes] == [0, 0]
    first, second = (torch.load(folder / f"rank{rank}.pt", weights_only=True) for rank in (0, 1))
    trained = [name for name, _ in CRFNet().named_parameters()]
    assert all(torch.equal(first[name], second[name]) for name in trained)

    gradients = torch.stack([head_gradient(pack, rank) for rank in (0, 1)])
    config = RunConfig("regress", PLAIN, 2, validate_every=2)
    rate = learning_rate(PLAIN, 0, 2) * PLAIN.head_factor
    assert torch.allclose(first["head.weight"], -rate * gradients.mean(dim=0), rtol=1e-3, atol=1e-9)
    assert not torch.allclose(gradients[0], gradients[1], rtol=0.1)
    alone = train(folder / "pack", folder / "two", config, validation_windows=3)
    assert (alone.step, len(alone.rows)) == (2, 1)


def test_the_model_folder_says_what_torch_says(model, folder):
    assert assert_parity(model, folder / "golden.npz") < PARITY
    assert 7.7e6 < (model / "model.onnx").stat().st_size < 7.9e6
    found = ResponseNetwork.load(model).predict(np.random.default_rng(0).random((3, 227, 227, 3), np.float32))
    assert found.weights.shape == (3, 11)
    assert found.weights.std() > 0
    assert np.ptp(found.expected_errors) == 0


def test_training_goes_on_from_a_model_folder(model, run):
    torch.manual_seed(4)
    windows = torch.rand(4, 3, 227, 227)
    network, exported = CRFNet(), load_network(run)
    assert start_from(network, model, windows)
    with torch.inference_mode():
        expected = rounded(exported)(windows.permute(0, 2, 3, 1))[0]
        assert torch.allclose(network.eval()(windows), expected, atol=1e-4)
        normal = network.train().body[:2](windows * 2 - 1)
    assert normal.mean(dim=(0, 2, 3)).tolist() == pytest.approx(network.body[1].bias.tolist(), abs=1e-4)


def test_folding_changes_nothing():
    torch.manual_seed(0)
    network, windows = CRFNet(), torch.rand(2, 3, 227, 227)
    torch.nn.init.normal_(network.head.weight, std=1e-3)
    with torch.inference_mode():
        network(windows)
        expected = network.eval()(windows)
        assert torch.allclose(fold_normalisation(network)(windows), expected, rtol=1e-3, atol=1e-3)


def test_a_run_of_the_first_stage_is_not_exported(tmp_path):
    torch.save({"network": CRFNet(3).state_dict(), "rows": []}, tmp_path / "best.pt")
    with pytest.raises(SystemExit, match="stage classify"):
        load_network(tmp_path)
