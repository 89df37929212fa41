"""Golden predictions: what PyTorch answers for windows of the bundled plate, to compare onnxruntime with."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from torch import nn

from crfnet_core.files import atomic_write
from crfnet_core.network import ResponseNetwork
from crfnet_core.posterior import Evidence
from crfnet_core.statistics import window_statistics
from crfnet_core.types import Float32Array
from training.export.onnx_graph import OF_WINDOWS, POOLED, POOLING, Signature

#: Windows of the bundled plate and their statistics; written by tests/data/make_golden_statistics.py.
GOLDEN_STATISTICS = Path(__file__).parents[2] / "tests" / "data" / "golden_statistics.npz"

#: Largest difference allowed between PyTorch and onnxruntime: in locations (units of E_est), log-odds, and factors
#: relative to the largest.
PARITY = 1e-3


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
    """Return the largest difference between the golden outputs and onnxruntime for the model in `folder`.

    Raise SystemExit if it is above `PARITY`.
    """
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
