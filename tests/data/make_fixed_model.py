"""Write fixed_model/: a network of a few bytes that knows one answer, for tests of everything around a network.

    python tests/data/make_fixed_model.py         (needs onnx, which comes with the train extra)

It answers the true response of plate.jpg, moved along the first component by the mean brightness of the window, so that
windows differ; its evidence is always as strong.
"""

import hashlib
import json
from pathlib import Path

import numpy as np
from onnx import TensorProto, helper, numpy_helper

from crfnet_core.posterior import UNUSUAL
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from crfnet_core.response.emor import EmorBasis
from crfnet_core.statistics.windows import WINDOW_SIZE

ASSETS = Path(__file__).parent
OPSET, IR_VERSION = 17, 8

#: Factor of the precision of every weight: the inverse of its standard deviation.
PRECISION_FACTOR = 3.0

#: Of the families that are not ordinary: clearly against them.
LOG_ODDS = -6.0

#: First weight per unit of mean brightness, and the brightness at which the answer is true.
MOVE, MIDDLE = 0.5, 0.4


def make_graph() -> bytes:
    """Return the serialised network: windows (N, 227, 227, 3) to evidence (N, 5), (N, 5, 5) and (N, 3)."""
    true = np.loadtxt(ASSETS / "plate_response.csv", delimiter=",", skiprows=1)[:, 1]
    slope = np.eye(EVIDENCE_WEIGHTS)[:1] * MOVE
    start = EmorBasis.load().project(true)[:EVIDENCE_WEIGHTS] - slope * MIDDLE
    constants = {
        "slope": slope.astype(np.float32),
        "start": start.astype(np.float32),
        "column": np.array([1], dtype=np.int64),
        "matrix": np.array([1, 2], dtype=np.int64),
        "zeros": np.zeros((1, len(UNUSUAL)), dtype=np.float32),
        "odds": np.float32(LOG_ODDS),
        "nothing": np.zeros((1, 1, 1), dtype=np.float32),
        "factor": (np.eye(EVIDENCE_WEIGHTS)[None] * PRECISION_FACTOR).astype(np.float32),
    }
    nodes = [
        helper.make_node("ReduceMean", ["windows"], ["mean"], axes=[1, 2, 3], keepdims=0),
        helper.make_node("Unsqueeze", ["mean", "column"], ["means"]),
        helper.make_node("Mul", ["means", "slope"], ["moved"]),
        helper.make_node("Add", ["moved", "start"], ["locations"]),
        helper.make_node("Mul", ["means", "zeros"], ["no_odds"]),
        helper.make_node("Add", ["no_odds", "odds"], ["log_odds"]),
        helper.make_node("Unsqueeze", ["mean", "matrix"], ["matrices"]),
        helper.make_node("Mul", ["matrices", "nothing"], ["no_matrices"]),
        helper.make_node("Add", ["no_matrices", "factor"], ["factors"]),
    ]
    windows = helper.make_tensor_value_info("windows", TensorProto.FLOAT, ["n", WINDOW_SIZE, WINDOW_SIZE, 3])
    shapes = {
        "locations": [EVIDENCE_WEIGHTS],
        "factors": [EVIDENCE_WEIGHTS, EVIDENCE_WEIGHTS],
        "log_odds": [len(UNUSUAL)],
    }
    outputs = [helper.make_tensor_value_info(name, TensorProto.FLOAT, ["n", *shape]) for name, shape in shapes.items()]
    initial = [numpy_helper.from_array(np.asarray(values), name) for name, values in constants.items()]
    graph = helper.make_graph(nodes, "fixed", [windows], outputs, initial)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION)
    return bytes(model.SerializeToString())


def main() -> None:
    """Write model.onnx and model.json."""
    folder = ASSETS / "fixed_model"
    folder.mkdir(exist_ok=True)
    graph = make_graph()
    config = {
        "name": "fixed",
        "sha256": hashlib.sha256(graph).hexdigest(),
        "basis": "emor",
        "components": EVIDENCE_WEIGHTS,
        "window_size": WINDOW_SIZE,
        "input_name": "windows",
        "output_names": ["locations", "factors", "log_odds"],
        "normalization": "code value / largest code, in [0, 1]",
        "opset": OPSET,
        "training_commit": "none",
        "training": {},
        "accuracy": {},
    }
    (folder / "model.onnx").write_bytes(graph)
    (folder / "model.json").write_text(json.dumps(config, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
