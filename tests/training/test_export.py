import json
from dataclasses import asdict

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")
onnx = pytest.importorskip("onnx", reason="training needs the train extra")
pytest.importorskip("onnxscript", reason="training needs the train extra")

from crfnet_core.network import ResponseNetwork
from training.export.model_folder import (
    PARITY,
    POOLING,
    UNCALIBRATED,
    assert_parity,
    export_onnx,
    load_network,
    write_config,
    write_golden,
)
from training.network.model import NetworkConfig, PhotographNet

CONFIG = NetworkConfig(width=64)


@pytest.fixture(scope="module")
def exported(tmp_path_factory, root):
    """A run with random weights, its model folder and golden file."""
    folder = tmp_path_factory.mktemp("export")
    (folder / "run").mkdir()
    (folder / "model").mkdir()
    torch.manual_seed(0)
    torch.save({"net": PhotographNet(CONFIG).state_dict()}, folder / "run" / "last.pt")
    (folder / "run" / "config.json").write_text(json.dumps({"network": asdict(CONFIG)}))
    network = load_network(folder / "run")
    export_onnx(network, POOLING, folder / "model" / "model.onnx")
    write_config(folder / "model", POOLING, UNCALIBRATED)
    write_golden(network, POOLING, root / "tests" / "data" / "plate.jpg", folder / "golden.npz")
    return folder


def test_onnxruntime_agrees_with_torch(exported):
    assert assert_parity(exported / "model", exported / "golden.npz") < PARITY


def test_a_disagreement_stops_the_export(exported, tmp_path):
    with np.load(exported / "golden.npz") as arrays:
        spoiled = dict(arrays) | {"weights": arrays["weights"] + 0.01}
    np.savez(tmp_path / "golden.npz", **spoiled)
    with pytest.raises(SystemExit, match="differs from torch"):
        assert_parity(exported / "model", tmp_path / "golden.npz")


def test_the_exported_folder_loads(exported):
    network = ResponseNetwork.load(exported / "model")
    assert network.config.name == "model"
    found = network.predict(np.zeros((2, 227, 227, 3), np.float32))
    assert np.isfinite(found.weights).all()
    assert np.isfinite(found.pooled.weights).all()
    assert found.weights.shape == (2, 11)
    assert found.pooled.weights.shape == (11,)
    assert network.config.training["held_out_curves"] == []


def test_matrices_are_kept_in_half_precision(exported):
    graph = onnx.load(exported / "model" / "model.onnx").graph
    kept = {tuple(tensor.dims): tensor.data_type for tensor in graph.initializer if len(tensor.dims) > 1}
    assert len(kept) > 5
    assert set(kept.values()) == {onnx.TensorProto.FLOAT16}
