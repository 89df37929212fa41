import json
import shutil
from dataclasses import asdict

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")
onnx = pytest.importorskip("onnx", reason="training needs the train extra")
pytest.importorskip("onnxscript", reason="training needs the train extra")

from crfnet_core.network import ModelConfig, ResponseNetwork
from training.export.model_folder import PARITY, assert_parity, load_network, write_config, write_golden
from training.export.onnx_graph import POOLING, export_onnx
from training.network.average import average
from training.network.model import NetworkConfig, PhotographNet
from training.network.start import start_from, start_record

CONFIG = NetworkConfig(width=64)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """A run with random weights, its model folder and golden file."""
    folder = tmp_path_factory.mktemp("export")
    (folder / "run").mkdir()
    (folder / "model").mkdir()
    torch.manual_seed(0)
    torch.save({"network": PhotographNet(CONFIG).state_dict()}, folder / "run" / "last.pt")
    record = {"commit": "0" * 40, "dirty": True, "recipe": {"training": {}, "network": asdict(CONFIG)}}
    (folder / "run" / "run.json").write_text(json.dumps(record))
    network = load_network(folder / "run")
    export_onnx(network, POOLING, folder / "model" / "model.onnx")
    write_config(folder / "model", POOLING, record)
    write_golden(network, POOLING, folder / "golden.npz")
    return folder


def test_onnxruntime_agrees_with_torch(exported, tolerance):
    assert tolerance.parity == PARITY
    assert assert_parity(exported / "model", exported / "golden.npz") < PARITY


@pytest.mark.parametrize("name", POOLING.output_names)
def test_a_disagreement_stops_the_export(exported, tmp_path, name):
    with np.load(exported / "golden.npz") as arrays:
        spoiled = dict(arrays) | {name: arrays[name] + 0.01 * np.abs(arrays[name]).max()}
    np.savez(tmp_path / "golden.npz", **spoiled)
    with pytest.raises(SystemExit, match="differs from torch"):
        assert_parity(exported / "model", tmp_path / "golden.npz")


def test_the_exported_folder_loads(exported):
    network = ResponseNetwork.load(exported / "model")
    assert network.config.name == "model"
    found = network.predict(np.zeros((2, 227, 227, 3), np.float32))
    assert (len(found.windows), network.config.components) == (2, 5)
    assert network.config.training["held_out_curves"] == []
    assert network.config.training_commit == "0" * 40 + "-dirty"


def test_held_out_curves_stand_in_the_configuration(exported):
    record = {"commit": None, "recipe": {"training": {"without_held_out": True}}}
    write_config(exported / "model", POOLING, record)
    config = ModelConfig.read(exported / "model" / "model.json")
    assert len(config.training["held_out_curves"]) == 40
    assert config.training_commit == "unknown"


def test_a_training_starts_from_an_exported_folder(exported):
    expected, net = load_network(exported / "run").net, PhotographNet(CONFIG)
    start_from(net, exported / "model")
    found = dict(net.named_parameters())
    for name, parameter in expected.named_parameters():
        torch.testing.assert_close(found[name], parameter, rtol=0, atol=0)
    assert torch.equal(
        net.embedding.edges.normalization.running_var, expected.embedding.edges.normalization.running_var
    )
    assert start_record(exported / "model").startswith("model/model.onnx, SHA-256 ")


def test_an_exported_network_of_another_size_is_refused(exported):
    with pytest.raises(SystemExit, match="is not a network of this kind and size"):
        start_from(PhotographNet(NetworkConfig(width=32)), exported / "model")


def test_a_run_is_averaged_with_the_model_that_it_began_from(exported, tmp_path):
    model, run = tmp_path / "model", tmp_path / "run"
    shutil.copytree(exported / "model", model)
    record = {"commit": "0" * 40, "recipe": {"network": asdict(CONFIG)}, "data": {"files": 0, "sha256": ""}}
    (model / "run.json").write_text(json.dumps(record | {"start": "random weights"}))
    run.mkdir()
    (run / "run.json").write_text(json.dumps(record | {"start": start_record(model)}))
    net = load_network(exported / "run").net
    state, name = net.state_dict(), next(name for name, _ in net.named_parameters())
    torch.save({"network": state | {name: state[name] + 2}}, run / "last.pt")
    found = torch.load(average([run, model], [1, 1], tmp_path / "mean"), weights_only=True)["network"]
    torch.testing.assert_close(found[name], state[name] + 1)
    parts = json.loads((tmp_path / "mean" / "run.json").read_text())["average"]
    assert parts[1]["checkpoint"] == start_record(model)
