"""Turn a run into a model folder: ``python -m training.export.model_folder --run DIR --out DIR ...``.

The steps: the graph (`onnx_graph`); golden predictions, the answers of PyTorch for windows of the bundled plate, and
the parity of onnxruntime with them; model.json, and the record of the run beside it.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from torch import nn

from crfnet_core.files import atomic_write, file_sha256
from crfnet_core.network import ModelConfig, ResponseNetwork
from crfnet_core.posterior import Evidence
from crfnet_core.statistics import window_statistics
from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array
from training.data.splits import SPLITS
from training.export.onnx_graph import OF_WINDOWS, OPSET, POOLED, POOLING, Signature, export_onnx, rounded
from training.network.model import NetworkConfig, PhotographNet, ShippedNetwork
from training.network.train import CHECKPOINT
from training.provenance import RUN_FILE, Record, read_run, training_commit, write_json

#: Windows of the bundled plate and their statistics; written by tests/data/make_golden_statistics.py.
GOLDEN_STATISTICS = Path(__file__).parents[2] / "tests" / "data" / "golden_statistics.npz"

#: Largest difference allowed between PyTorch and onnxruntime: in locations (units of E_est), log-odds, and factors
#: relative to the largest.
PARITY = 1e-3


def load_network(run: Path) -> ShippedNetwork:
    """Return the network of a run, ready to infer, with the half-precision matrices that it ships with."""
    net = PhotographNet(NetworkConfig(**read_run(run)["recipe"]["network"]))
    net.load_state_dict(torch.load(run / CHECKPOINT, weights_only=True)["network"])
    return rounded(ShippedNetwork(net).eval())


def write_config(folder: Path, signature: Signature, record: Record) -> None:
    """Write model.json, still without figures, for the model.onnx in `folder`, whose name is the model's."""
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
            "held_out_curves": SPLITS["held_out_curves"] if is_without_held_out else [],
        },
        accuracy={},
    )
    config.write(folder / "model.json")


def golden_windows() -> Float32Array:
    """Return three windows of the bundled plate, float32 (3, 227, 227, 3)."""
    with np.load(GOLDEN_STATISTICS) as arrays:
        windows: Float32Array = arrays["windows"] / np.float32(255)
    return windows


def write_golden(network: nn.Module, signature: Signature, path: Path) -> None:
    """Write the outputs of a network for the golden windows, as NPZ."""
    windows = golden_windows()
    inputs = np.stack([window_statistics(window) for window in windows]) if signature is POOLING else windows
    with torch.inference_mode():
        outputs = [output.numpy() for output in network(torch.from_numpy(inputs))]
    with atomic_write(path, overwrite=True) as temporary:
        np.savez_compressed(temporary, **dict(zip(signature.output_names, outputs, strict=True)))


def assert_parity(folder: Path, golden: Path) -> float:
    """Return the largest difference between golden outputs and onnxruntime's; SystemExit if it is above `PARITY`."""
    network = ResponseNetwork.load(folder)
    predicted = network.predict(golden_windows())
    with np.load(golden) as expected:
        differences = [_difference(predicted.windows, [expected[name] for name in OF_WINDOWS])]
        if POOLED[0] in network.config.output_names:
            differences.append(_difference([predicted.pooled], [expected[name] for name in POOLED]))
    if max(differences) > PARITY:
        raise SystemExit(f"onnxruntime differs from torch by {max(differences):.2e}, more than {PARITY:.0e}")
    return max(differences)


def _difference(evidences: Sequence[Evidence], expected: Sequence[Float32Array]) -> float:
    """Return the largest difference of evidence from arrays (N, ...); of factors relative to the largest of them."""
    columns = zip(*((each.location, each.factor, each.log_odds) for each in evidences), strict=True)
    scales = (1.0, max(1.0, float(np.abs(expected[1]).max())), 1.0)
    rows = zip(columns, expected, scales, strict=True)
    return max(float(np.abs(np.stack(part) - wanted).max() / scale) for part, wanted, scale in rows)


def write_model(network: nn.Module, signature: Signature, options: argparse.Namespace) -> None:
    """Write the folder of a `rounded` network that is ready to infer, with the options of `export_options`."""
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
