"""Write fixed_model/: a network of a few bytes that knows one answer, for tests of everything around a network.

    python tests/data/make_fixed_model.py         (needs onnx, which comes with the train extra)

It answers the true response of plate.jpg, moved along the first component by the mean brightness of the window, so that
windows differ; the error that it expects is always the same.
"""

import hashlib
import json
from pathlib import Path

import numpy as np
from onnx import TensorProto, helper, numpy_helper

from crfnet_core.emor import COMPONENTS, EmorBasis
from crfnet_core.windows import WINDOW_SIZE

ASSETS = Path(__file__).parent
OPSET, IR_VERSION = 17, 8
EXPECTED_ERROR = 0.5

#: First weight per unit of mean brightness, and the brightness at which the answer is true.
MOVE, MIDDLE = 0.5, 0.4


def make_graph() -> bytes:
    """Return the serialised network: windows (N, 227, 227, 3) to weights (N, 11) and the log of the error (N,)."""
    true = np.loadtxt(ASSETS / "plate_response.csv", delimiter=",", skiprows=1)[:, 1]
    slope = np.eye(COMPONENTS)[:1] * MOVE
    start = EmorBasis.load().project(true) - slope * MIDDLE
    constants = {
        "slope": slope.astype(np.float32),
        "start": start.astype(np.float32),
        "column": np.array([1], dtype=np.int64),
        "zero": np.float32(0),
        "level": np.float32(np.log(EXPECTED_ERROR)),
    }
    nodes = [
        helper.make_node("ReduceMean", ["windows"], ["mean"], axes=[1, 2, 3], keepdims=0),
        helper.make_node("Unsqueeze", ["mean", "column"], ["means"]),
        helper.make_node("Mul", ["means", "slope"], ["moved"]),
        helper.make_node("Add", ["moved", "start"], ["weights"]),
        helper.make_node("Mul", ["mean", "zero"], ["zeros"]),
        helper.make_node("Add", ["zeros", "level"], ["log_error"]),
    ]
    windows = helper.make_tensor_value_info("windows", TensorProto.FLOAT, ["n", WINDOW_SIZE, WINDOW_SIZE, 3])
    weights = helper.make_tensor_value_info("weights", TensorProto.FLOAT, ["n", COMPONENTS])
    log_error = helper.make_tensor_value_info("log_error", TensorProto.FLOAT, ["n"])
    initial = [numpy_helper.from_array(np.asarray(values), name) for name, values in constants.items()]
    graph = helper.make_graph(nodes, "fixed", [windows], [weights, log_error], initial)
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
        "components": COMPONENTS,
        "window_size": WINDOW_SIZE,
        "input_name": "windows",
        "output_names": ["weights", "log_error"],
        "normalization": "code value / largest code, in [0, 1]",
        "opset": OPSET,
        "training_commit": "none",
        "training": {},
        "uncertainty_model": {
            "base": 0.1,
            "of_predicted": 0.9,
            "of_spread": 0.5,
            "band_profile": [0, 0.05, 0.07, 0.05, 0],
        },
        "accuracy": {},
    }
    (folder / "model.onnx").write_bytes(graph)
    (folder / "model.json").write_text(json.dumps(config, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
