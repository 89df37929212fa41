"""Turn a run into a model folder: ``python -m training.export.model_folder --run DIR --out DIR ...``.

The steps: the graph (`onnx_graph`), the golden predictions and the parity with them (`golden`), model.json, and the
record of the run beside it.
"""

import argparse
import json
from pathlib import Path

import torch
from torch import nn

from crfnet_core.files import file_sha256
from crfnet_core.network import ModelConfig
from crfnet_core.statistics.windows import WINDOW_SIZE
from training.data.splits import SPLITS_FILE
from training.export.golden import assert_parity, write_golden
from training.export.onnx_graph import OPSET, POOLING, Signature, export_onnx, rounded
from training.network.model import NetworkConfig, PhotographNet, ShippedNetwork
from training.network.train import CHECKPOINT
from training.provenance import RUN_FILE, Record, read_run, training_commit, write_json


def load_network(run: Path) -> ShippedNetwork:
    """Return the network of a run, ready to infer, with the half-precision matrices that it ships with."""
    net = PhotographNet(NetworkConfig(**read_run(run)["recipe"]["network"]))
    net.load_state_dict(torch.load(run / CHECKPOINT, weights_only=True)["net"])
    return rounded(ShippedNetwork(net).eval())


def write_config(folder: Path, signature: Signature, record: Record) -> None:
    """Write model.json for the model.onnx in `folder`, whose name is the model's, from the record of the run.

    `training.export.model_card` adds the figures later.
    """
    is_without_held_out = record["recipe"].get("training", {}).get("without_held_out", False)
    config = ModelConfig(
        name=folder.name,
        sha256=file_sha256(folder / "model.onnx"),
        basis="emor",
        components=signature.weights,
        window_size=WINDOW_SIZE,
        input_name=signature.input_name,
        output_names=signature.output_names,
        normalization="code values divided by the largest code, never rescaled",
        opset=OPSET,
        training_commit=training_commit(record),
        training={
            "scene_kinds": ["panorama", "photograph"],
            "held_out_curves": json.loads(SPLITS_FILE.read_text())["held_out_curves"] if is_without_held_out else [],
        },
        accuracy={},
    )
    config.write(folder / "model.json")


def write_model(network: nn.Module, signature: Signature, options: argparse.Namespace) -> None:
    """Write the model folder of a `rounded` network that is ready to infer, with the options of `export_options`.

    It writes the graph, run.json and golden predictions, compares onnxruntime with PyTorch, and then writes model.json.
    """
    record = read_run(options.run)
    options.out.mkdir(parents=True, exist_ok=True)
    export_onnx(network, signature, options.out / "model.onnx")
    write_config(options.out, signature, record)
    write_golden(network, signature, options.golden)
    print(f"torch and onnxruntime differ by at most {assert_parity(options.out, options.golden):.1e}")
    write_json(options.out / RUN_FILE, record)
    print(f"wrote {options.out}")


def export_options(description: str | None) -> argparse.ArgumentParser:
    """Return the parser of the options that every export needs."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--run", type=Path, required=True, help="folder written by the training")
    parser.add_argument("--out", type=Path, required=True, help="the model's folder, named as the model")
    parser.add_argument("--golden", type=Path, required=True, help="file of the golden predictions")
    return parser


def main() -> None:
    """Export the network of a run."""
    options = export_options((__doc__ or "").splitlines()[0]).parse_args()
    write_model(load_network(options.run), POOLING, options)


if __name__ == "__main__":
    main()
