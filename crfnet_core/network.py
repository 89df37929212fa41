"""Load and run a trained network: a folder with model.onnx, model.json and a model card."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
from numpy.typing import NDArray

from crfnet_core.emor import COMPONENTS
from crfnet_core.errors import ModelError
from crfnet_core.windows import WINDOW_SIZE

#: The packaged model that is used unless another is asked for.
DEFAULT_MODEL = Path(__file__).with_name("models") / "window-statistics"

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Calibration:
    """How window estimates become an uncertainty; fitted on validation photographs by training.

    Parameters
    ----------
    base, of_predicted, of_spread : float
        The uncertainty, in units of E_est, is base + of_predicted * (mean error that the network expects of the kept
        windows) + of_spread * (RMS distance of the kept windows' estimates from their mean).
    band_profile : tuple of float
        The shape of the 90 % band: its half-width per unit of uncertainty at uniform irradiances from 0 to 1.
    """

    base: float
    of_predicted: float
    of_spread: float
    band_profile: tuple[float, ...]


@dataclass(frozen=True)
class ModelConfig:
    """What model.json says of the network beside it.

    Parameters
    ----------
    name : str
        The model's name, that of its folder.
    sha256 : str
        Of model.onnx; checked at load.
    basis : str
        The response model of the outputs: "emor".
    components : int
        Weights per window.
    window_size : int
        Side of a window in samples.
    input_name : str
        Windows, float32 (N, 227, 227, 3).
    output_names : tuple of str
        EMoR weights (N, 11) and the logarithm of the expected E_est (N,).
    normalisation : str
        What the input holds, in words.
    opset : int
        Of the ONNX graph.
    training_commit : str
        The commit of this project that trained it.
    calibration : Calibration
        From window estimates to an uncertainty.
    accuracy : dict
        Figures of the model card.
    """

    name: str
    sha256: str
    basis: str
    components: int
    window_size: int
    input_name: str
    output_names: tuple[str, ...]
    normalisation: str
    opset: int
    training_commit: str
    calibration: Calibration
    accuracy: dict[str, Any]

    @classmethod
    def read(cls, path: Path) -> ModelConfig:
        """Return the configuration in a model.json.

        Raises
        ------
        ModelError
            If the file is absent, is no JSON, lacks an entry, or describes a network of another kind.
        """
        entries = _read_json(path)
        missing = [field.name for field in fields(cls) if field.name not in entries]
        if missing:
            raise ModelError(f"{path}: lacks {', '.join(missing)}; export the model again")
        config = cls(**{field.name: entries[field.name] for field in fields(cls)})
        if (config.basis, config.components, config.window_size) != ("emor", COMPONENTS, WINDOW_SIZE):
            raise ModelError(
                f"{path}: is for {config.components} weights of {config.basis} and windows of {config.window_size};"
                f" this version needs {COMPONENTS} of emor and {WINDOW_SIZE}"
            )
        return config

    def __post_init__(self) -> None:
        """Turn JSON's lists and objects into the types declared."""
        object.__setattr__(self, "output_names", tuple(self.output_names))
        if isinstance(self.calibration, dict):
            entries = dict(self.calibration)
            entries["band_profile"] = tuple(entries["band_profile"])
            object.__setattr__(self, "calibration", Calibration(**entries))

    @property
    def label(self) -> str:
        """The model's name and the head of its hash, for provenance."""
        return f"{self.name} {self.sha256[:12]}"


@dataclass(frozen=True)
class WindowPredictions:
    """What the network says of N windows: EMoR weights (N, 11) and the E_est it expects of each (N,)."""

    weights: Floats
    expected_errors: Floats


class ResponseNetwork:
    """An onnxruntime session, made once, and the configuration beside it."""

    def __init__(self, config: ModelConfig, session: onnxruntime.InferenceSession) -> None:
        self.config = config
        self._session = session

    @classmethod
    def load(cls, folder: str | Path | None = None, *, threads: int = 0) -> ResponseNetwork:
        """Return the network in `folder`, by default the packaged one, on the CPU.

        Parameters
        ----------
        folder : str or Path, optional
            Holds model.onnx and model.json.
        threads : int
            Threads of the CPU to use; 0 leaves the choice to onnxruntime.

        Raises
        ------
        ModelError
            If a file is absent or does not match the other.
        """
        folder = DEFAULT_MODEL if folder is None else Path(folder)
        config = ModelConfig.read(folder / "model.json")
        graph = _read_bytes(folder / "model.onnx")
        if hashlib.sha256(graph).hexdigest() != config.sha256:
            raise ModelError(f"{folder}: model.onnx is not the file that model.json describes; restore the pair")
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        return cls(config, onnxruntime.InferenceSession(graph, options, providers=["CPUExecutionProvider"]))

    def predict(
        self, windows: NDArray[np.float32], *, progress: Callable[[int, int], None] | None = None
    ) -> WindowPredictions:
        """Return the predictions for `windows`, float32 (N, 227, 227, 3), code values in [0, 1].

        Windows run one by one: their working set then stays in the processor's cache.

        Parameters
        ----------
        windows : ndarray
            At least one window; not changed.
        progress : callable, optional
            Called with (done, total) after every window.
        """
        rows = []
        for number, window in enumerate(windows, start=1):
            feed = {self.config.input_name: np.ascontiguousarray(window[None], dtype=np.float32)}
            rows.append(self._session.run(list(self.config.output_names), feed))
            if progress is not None:
                progress(number, len(windows))
        weights, log_errors = (np.concatenate(column).astype(np.float64) for column in zip(*rows, strict=True))
        return WindowPredictions(weights, np.exp(log_errors))


def _read_bytes(path: Path) -> bytes:
    """Return a model file's bytes, or say which file is absent."""
    try:
        return path.read_bytes()
    except OSError as problem:
        raise ModelError(f"{path}: cannot be read ({problem.strerror}); a model is a folder with both files") from None


def _read_json(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file."""
    try:
        entries = json.loads(_read_bytes(path))
    except ValueError:
        raise ModelError(f"{path}: is not JSON; restore it") from None
    if not isinstance(entries, dict):
        raise ModelError(f"{path}: holds no JSON object; restore it")
    return entries
