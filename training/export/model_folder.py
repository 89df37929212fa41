"""Turn a checkpoint into a model folder: ``python -m training.export.model_folder --run DIR --data DIR --out DIR --golden FILE``."""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from scipy.optimize import nnls
from torch import nn
from tqdm import tqdm

from crfnet_core.emor import COMPONENTS
from crfnet_core.estimate import estimate_response
from crfnet_core.files import atomic_write
from crfnet_core.image_io import read_photo
from crfnet_core.metrics import estimation_error
from crfnet_core.network import ModelConfig, ResponseNetwork, UncertaintyModel
from crfnet_core.response import SAMPLES, ResponseCurve
from crfnet_core.statistics import STATISTICS, window_statistics
from crfnet_core.windows import WINDOW_SIZE, cut_windows, select_windows
from training.data.splits import SPLITS_FILE
from training.network.model import NetworkConfig, PhotographNet, ShippedNetwork
from training.network.shards import photograph_source
from training.synthesis.camera import Capture, automatic_exposure
from training.synthesis.capture import synthetic_photo

OPSET = 18

#: Largest difference allowed between torch and onnxruntime, in weights (units of E_est) and log errors.
PARITY = 2e-4

#: Photographs of each validation scene for the calibration.
CALIBRATION_PHOTOS = 50

#: Knots of the band's profile over irradiance.
BAND_KNOTS = 33

#: Windows of the bundled plate and their statistics; written by tests/data/make_golden_statistics.py.
GOLDEN_STATISTICS = Path(__file__).parents[2] / "tests" / "data" / "golden_statistics.npz"

Network = TypeVar("Network", bound=nn.Module)

UNCALIBRATED = UncertaintyModel(base=0.0, of_predicted=1.0, of_spread=0.0, band_profile=(0.0,) * BAND_KNOTS)


@dataclass(frozen=True)
class Signature:
    """What a network reads and says; see `crfnet_core.network.ModelConfig`."""

    input_name: str
    input_shape: tuple[int, ...]
    output_names: tuple[str, ...]


#: A network of the statistics of windows, which pools them.
POOLING = Signature("statistics", (STATISTICS,), ("weights", "log_errors", "pooled_weights", "pooled_log_error"))

#: A network of windows, each for itself.
WINDOWED = Signature("windows", (WINDOW_SIZE, WINDOW_SIZE, 3), ("weights", "log_errors"))


def load_network(run: Path) -> ShippedNetwork:
    """Return the network of a run, ready to infer, with the half-precision parameters that it ships with."""
    settings = json.loads((run / "config.json").read_text())
    net = PhotographNet(NetworkConfig(**settings["network"]))
    net.load_state_dict(torch.load(run / "last.pt", weights_only=True)["net"])
    return rounded(ShippedNetwork(net).eval())


def rounded(network: Network) -> Network:
    """Return the network itself, its matrices rounded to half precision in place."""
    with torch.no_grad():
        for parameter in network.parameters():
            if parameter.ndim > 1:
                parameter.copy_(parameter.half().float())
    return network


def export_onnx(network: nn.Module, signature: Signature, path: Path) -> None:
    """Write the graph of a `rounded` network, with a free number of windows and matrices in half precision."""
    program = torch.onnx.export(
        network,
        (torch.rand(2, *signature.input_shape),),
        input_names=[signature.input_name],
        output_names=list(signature.output_names),
        dynamic_shapes=({0: torch.export.Dim("windows")},),
        opset_version=OPSET,
        dynamo=True,
    )
    model = program.model_proto
    halve(model.graph)
    with atomic_write(path, overwrite=True) as temporary:
        onnx.save(model, temporary)


def halve(graph: onnx.GraphProto) -> None:
    """Keep the graph's matrices, which half precision represents, in it, and cast them up when they are loaded."""
    for initializer in graph.initializer:
        values = numpy_helper.to_array(initializer)
        if values.dtype == np.float32 and values.ndim > 1 and (values == values.astype(np.float16)).all():
            name = initializer.name
            initializer.CopyFrom(numpy_helper.from_array(values.astype(np.float16), f"{name}_half"))
            graph.node.insert(0, helper.make_node("Cast", [f"{name}_half"], [name], to=TensorProto.FLOAT))


def write_config(
    folder: Path, signature: Signature, uncertainty_model: UncertaintyModel, *, without_held_out: bool = False
) -> None:
    """Write model.json for the model.onnx in `folder`, whose name is the model's; `training.export.model_card` adds the figures."""
    splits = json.loads(SPLITS_FILE.read_text())
    config = ModelConfig(
        name=folder.name,
        sha256=hashlib.sha256((folder / "model.onnx").read_bytes()).hexdigest(),
        basis="emor",
        components=COMPONENTS,
        window_size=WINDOW_SIZE,
        input_name=signature.input_name,
        output_names=signature.output_names,
        normalization="code values divided by the largest code, never rescaled",
        opset=OPSET,
        training_commit=_commit(),
        training={
            "scene_kinds": ["panorama", "photograph"],
            "held_out_curves": splits["held_out_curves"] if without_held_out else [],
        },
        uncertainty_model=uncertainty_model,
        accuracy={},
    )
    config.write(folder / "model.json")


def write_golden(network: nn.Module, signature: Signature, plate: Path, path: Path) -> None:
    """Write what torch says of windows of the bundled plate, those of `GOLDEN_STATISTICS`, for the tests."""
    pixels = read_photo(plate).pixels
    windows = cut_windows(pixels, select_windows(pixels, count=3))
    read = np.stack([window_statistics(window) for window in windows]) if signature is POOLING else windows
    with torch.inference_mode():
        outputs = [output.numpy() for output in network(torch.from_numpy(read))]
    with atomic_write(path, overwrite=True) as temporary:
        np.savez_compressed(temporary, **dict(zip(signature.output_names, outputs, strict=True)))


def assert_parity(folder: Path, golden: Path) -> float:
    """Return the largest difference between onnxruntime and the golden torch figures; fail above `PARITY`."""
    with np.load(GOLDEN_STATISTICS) as statistics, np.load(golden) as expected:
        network = ResponseNetwork.load(folder)
        found = network.predict(network.inputs(statistics["windows"] / np.float32(255)))
        differences = [
            np.abs(found.weights - expected["weights"]).max(),
            np.abs(np.log(found.expected_errors) - expected["log_errors"]).max(),
        ]
        if found.pooled:
            differences.append(np.abs(found.pooled.weights - expected["pooled_weights"]).max())
            differences.append(np.abs(np.log(found.pooled.expected_error) - expected["pooled_log_error"]).max())
    if max(differences) > PARITY:
        raise SystemExit(f"onnxruntime differs from torch by {max(differences):.2e}, more than {PARITY:.0e}")
    return float(max(differences))


def calibration_rows(data: Path, folder: Path, number: int) -> np.ndarray:
    """Return (E_est, expected error, spread, |residual| ...) of photographs of one validation scene."""
    source, network = photograph_source(data, "validation"), ResponseNetwork.load(folder, threads=1)
    rng, rows = np.random.default_rng([7, number]), []
    for _ in range(CALIBRATION_PHOTOS):
        curve, _ = source.draw_curve(rng)
        exposure = automatic_exposure(curve, source.luminance) * rng.uniform(0.5, 1.6)
        photo = synthetic_photo(source.scenes[number], curve, exposure, rng, Capture.draw(rng))
        estimate = estimate_response(photo, network=network)
        true = ResponseCurve.from_samples(curve)
        residual = np.abs(true.brightness - estimate.curve.brightness)
        rows.append([estimation_error(true, estimate.curve), estimate.uncertainty, estimate.spread, *residual])
    return np.array(rows)


def calibrated(data: Path, folder: Path, *, workers: int) -> UncertaintyModel:
    """Return the calibration of an uncalibrated model on the validation scenes.

    The uncertainty is the non-negative least squares fit of the error; the band's half-width is the 90 % quantile of
    the residual in units of the uncertainty, at every irradiance.
    """
    scenes = range(len(photograph_source(data, "validation").scenes))
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(calibration_rows, data, folder, number) for number in scenes]
        rows = np.concatenate([job.result() for job in tqdm(jobs, desc="calibration", unit="scene")])
    error, features = rows[:, 0], np.column_stack([np.ones(len(rows)), rows[:, 1], rows[:, 2]])
    parts, _ = nnls(features, error)
    quantiles = np.quantile(rows[:, 3:] / (features @ parts)[:, None], 0.9, axis=0)
    knots = np.interp(np.linspace(0, 1, BAND_KNOTS), np.linspace(0, 1, SAMPLES), quantiles)
    base, of_predicted, of_spread = (round(float(part), 4) for part in parts)
    return UncertaintyModel(base, of_predicted, of_spread, tuple(round(float(knot), 5) for knot in knots))


def _commit() -> str:
    """Return the commit that the training ran from."""
    return subprocess.run(["git", "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()


def write_model(
    network: nn.Module, signature: Signature, options: argparse.Namespace, *, without_held_out: bool = False
) -> None:
    """Write the model folder: graph, golden figures, checked parity, and the calibration."""
    options.out.mkdir(parents=True, exist_ok=True)
    export_onnx(network, signature, options.out / "model.onnx")
    write_config(options.out, signature, UNCALIBRATED, without_held_out=without_held_out)
    write_golden(network, signature, options.plate, options.golden)
    print(f"torch and onnxruntime differ by at most {assert_parity(options.out, options.golden):.1e}")
    calibration = calibrated(options.data, options.out, workers=options.workers)
    write_config(options.out, signature, calibration, without_held_out=without_held_out)
    print(f"wrote {options.out}: {calibration}")


def export_options(description: str | None) -> argparse.ArgumentParser:
    """Return the parser of the options that every export needs."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--run", type=Path, required=True, help="folder written by the training")
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves and linear")
    parser.add_argument("--out", type=Path, required=True, help="the model's folder, named as the model")
    parser.add_argument("--plate", type=Path, default=Path("tests/data/plate.jpg"))
    parser.add_argument("--golden", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=2)
    return parser


def main() -> None:
    """Export, check the parity, calibrate, and write the model folder."""
    options = export_options(__doc__).parse_args()
    settings = json.loads((options.run / "config.json").read_text())
    write_model(load_network(options.run), POOLING, options, without_held_out=settings["training"]["without_held_out"])


if __name__ == "__main__":
    main()
