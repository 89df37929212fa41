"""Turn a checkpoint into a model folder: ``python -m training.export --run DIR --data DIR --out DIR --golden FILE``."""

from __future__ import annotations

import argparse
import hashlib
import json
import subprocess
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from scipy.optimize import nnls
from tqdm import tqdm

from crfnet_core.emor import COMPONENTS
from crfnet_core.estimate import estimate_response
from crfnet_core.files import written_whole
from crfnet_core.metrics import estimation_error
from crfnet_core.network import Calibration, ModelConfig, ResponseNetwork
from crfnet_core.photo import read_photo
from crfnet_core.response import SAMPLES, ResponseCurve
from crfnet_core.windows import WINDOW_SIZE, cut_windows, select_windows
from training.dataset import window_source
from training.evaluate import synthetic_photo
from training.model import NetworkConfig, ResponseNet, WindowNetwork, WindowStatistics
from training.synthesis import Capture, automatic_exposure

OPSET = 18

#: Largest difference allowed between torch and onnxruntime, in weights (units of E_est) and log errors.
PARITY = 2e-4

#: Photographs of each validation scene for the calibration.
CALIBRATION_PHOTOS = 50

#: Knots of the band's profile over irradiance.
BAND_KNOTS = 33

UNCALIBRATED = Calibration(base=0.0, of_predicted=1.0, of_spread=0.0, band_profile=(0.0,) * BAND_KNOTS)


def load_network(run: Path) -> WindowNetwork:
    """Return the best network of a run, ready to infer."""
    network = NetworkConfig(**json.loads((run / "config.json").read_text())["network"])
    network = replace(network, strides=tuple(network.strides))
    net = ResponseNet(network)
    net.load_state_dict(torch.load(run / "best.pt", weights_only=True)["net"])
    return WindowNetwork(WindowStatistics(network), net).eval()


def export_onnx(network: WindowNetwork, path: Path) -> None:
    """Write the graph, from windows to weights and log errors, with a free number of windows."""
    example = torch.rand(2, WINDOW_SIZE, WINDOW_SIZE, 3)
    program = torch.onnx.export(
        network,
        (example,),
        input_names=["windows"],
        output_names=["weights", "log_errors"],
        dynamic_shapes=({0: torch.export.Dim("windows")},),
        opset_version=OPSET,
        dynamo=True,
    )
    with written_whole(path, overwrite=True) as temporary:
        program.save(temporary)


def write_config(folder: Path, calibration: Calibration) -> None:
    """Write model.json for the model.onnx in `folder`, whose name is the model's; `training.card` adds the figures."""
    config = ModelConfig(
        name=folder.name,
        sha256=hashlib.sha256((folder / "model.onnx").read_bytes()).hexdigest(),
        basis="emor",
        components=COMPONENTS,
        window_size=WINDOW_SIZE,
        input_name="windows",
        output_names=("weights", "log_errors"),
        normalisation="code values divided by the largest code, never rescaled",
        opset=OPSET,
        training_commit=_commit(),
        calibration=calibration,
        accuracy={},
    )
    config.write(folder / "model.json")


def write_golden(network: WindowNetwork, plate: Path, path: Path) -> None:
    """Write windows of the bundled plate with what torch says of them, for the tests."""
    pixels = read_photo(plate).pixels
    windows = cut_windows(pixels, select_windows(pixels, count=3))
    with torch.inference_mode():
        weights, log_errors = network(torch.from_numpy(windows))
    with written_whole(path, overwrite=True) as temporary:
        codes = np.rint(windows * 255).astype(np.uint8)
        np.savez_compressed(temporary, windows=codes, weights=weights.numpy(), log_errors=log_errors.numpy())


def assert_parity(folder: Path, golden: Path) -> float:
    """Return the largest difference between onnxruntime and the golden torch figures; fail above `PARITY`."""
    with np.load(golden) as expected:
        found = ResponseNetwork.load(folder).predict(expected["windows"] / np.float32(255))
        difference = max(
            np.abs(found.weights - expected["weights"]).max(),
            np.abs(np.log(found.expected_errors) - expected["log_errors"]).max(),
        )
    if difference > PARITY:
        raise SystemExit(f"onnxruntime differs from torch by {difference:.2e}, more than {PARITY:.0e}")
    return float(difference)


def calibration_rows(data: Path, folder: Path, number: int) -> np.ndarray:
    """Return (E_est, expected error, spread, |residual| ...) of photographs of one validation scene."""
    source, network = window_source(data, "validation"), ResponseNetwork.load(folder, threads=1)
    rng, rows = np.random.default_rng([7, number]), []
    for _ in range(CALIBRATION_PHOTOS):
        curve = source.curves.draw(rng)
        exposure = automatic_exposure(curve, source.luminance) * rng.uniform(0.5, 1.6)
        photo = synthetic_photo(source.scenes[number], curve, exposure, rng, Capture.draw(rng))
        estimate = estimate_response(photo, network=network)
        true = ResponseCurve.from_samples(curve)
        residual = np.abs(true.brightness - estimate.curve.brightness)
        rows.append([estimation_error(true, estimate.curve), estimate.uncertainty, estimate.spread, *residual])
    return np.array(rows)


def calibrated(data: Path, folder: Path, *, workers: int) -> Calibration:
    """Return the calibration of an uncalibrated model on the validation scenes.

    The uncertainty is the non-negative least squares fit of the error; the band's half-width is the 90 % quantile of
    the residual in units of the uncertainty, at every irradiance.
    """
    scenes = range(len(window_source(data, "validation").scenes))
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(calibration_rows, data, folder, number) for number in scenes]
        rows = np.concatenate([job.result() for job in tqdm(jobs, desc="calibration", unit="scene")])
    error, features = rows[:, 0], np.column_stack([np.ones(len(rows)), rows[:, 1], rows[:, 2]])
    parts, _ = nnls(features, error)
    quantiles = np.quantile(rows[:, 3:] / (features @ parts)[:, None], 0.9, axis=0)
    knots = np.interp(np.linspace(0, 1, BAND_KNOTS), np.linspace(0, 1, SAMPLES), quantiles)
    base, of_predicted, of_spread = (round(float(part), 4) for part in parts)
    return Calibration(base, of_predicted, of_spread, tuple(round(float(knot), 5) for knot in knots))


def _commit() -> str:
    """Return the commit that the training ran from."""
    return subprocess.run(["git", "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()


def main() -> None:
    """Export, check the parity, calibrate, and write the model folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--run", type=Path, required=True, help="folder written by training.train")
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves and linear")
    parser.add_argument("--out", type=Path, required=True, help="the model's folder, named as the model")
    parser.add_argument("--plate", type=Path, default=Path("tests/data/plate.jpg"))
    parser.add_argument("--golden", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    network = load_network(options.run)
    export_onnx(network, options.out / "model.onnx")
    write_config(options.out, UNCALIBRATED)
    write_golden(network, options.plate, options.golden)
    print(f"torch and onnxruntime differ by at most {assert_parity(options.out, options.golden):.1e}")
    calibration = calibrated(options.data, options.out, workers=options.workers)
    write_config(options.out, calibration)
    print(f"wrote {options.out}: {calibration}")


if __name__ == "__main__":
    main()
