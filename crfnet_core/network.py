"""Load and run a trained network: a folder with model.onnx, model.json and a model card."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
from numpy.typing import NDArray
from onnxruntime.capi import onnxruntime_pybind11_state as refusals

from crfnet_core.emor import COMPONENTS
from crfnet_core.errors import ModelError, one_line
from crfnet_core.files import write_text_whole
from crfnet_core.statistics import window_statistics
from crfnet_core.windows import WINDOW_SIZE

#: The packaged models, and the one that is used unless another is asked for.
MODELS = Path(__file__).with_name("models")
DEFAULT_MODEL = MODELS / "photograph-statistics"

#: What onnxruntime raises for a graph that it cannot load.
_UNLOADABLE = (
    refusals.Fail,
    refusals.InvalidArgument,
    refusals.InvalidGraph,
    refusals.InvalidProtobuf,
    refusals.NotImplemented,
)

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Calibration:
    """How window estimates become an uncertainty; fitted on validation photographs by training.

    Parameters
    ----------
    base, of_predicted, of_spread : float
        The uncertainty, in units of E_est, is base + of_predicted * (the error that the network expects of the whole,
        or without pooling the mean over the kept windows) + of_spread * (RMS distance of the kept windows' estimates
        from their mean).
    band_profile : tuple of float
        The shape of the 90 % band: its half-width per unit of uncertainty at uniform irradiances from 0 to 1.
    """

    base: float
    of_predicted: float
    of_spread: float
    band_profile: tuple[float, ...]

    def uncertainty(self, expected_error: float, spread: float) -> float:
        """Return the uncertainty in units of E_est."""
        return self.base + self.of_predicted * expected_error + self.of_spread * spread


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
        "windows", float32 (N, 227, 227, 3), or "statistics" of them, float32 (N, STATISTICS): see
        `crfnet_core.statistics.window_statistics`.
    output_names : tuple of str
        Of each window, EMoR weights (N, 11) and the logarithm of the expected E_est (N,); of a network that pools its
        windows, then the same of all of them together, (1, 11) and (1,).
    normalisation : str
        What the input holds, in words.
    opset : int
        Of the ONNX graph.
    training_commit : str
        The commit of this project that trained it.
    training : dict
        What it has seen: "scene_kinds", and "held_out_curves", the DoRF curves that it has not.
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
    training: dict[str, Any]
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
        entries["output_names"] = tuple(entries["output_names"])
        entries["calibration"] = _read_calibration(path, entries["calibration"])
        config = cls(**{field.name: entries[field.name] for field in fields(cls)})
        if (config.basis, config.components, config.window_size) != ("emor", COMPONENTS, WINDOW_SIZE):
            raise ModelError(
                f"{path}: is for {config.components} weights of {config.basis} and windows of {config.window_size};"
                f" this version needs {COMPONENTS} of emor and {WINDOW_SIZE}"
            )
        return config

    def write(self, path: Path) -> None:
        """Write a model.json that `read` returns again; an existing one is replaced."""
        write_text_whole(path, json.dumps(asdict(self), indent=2) + "\n", overwrite=True, error=ModelError)

    @property
    def reads_statistics(self) -> bool:
        """Whether the network reads the statistics of windows rather than their samples."""
        return self.input_name == "statistics"

    @property
    def label(self) -> str:
        """The model's name and the head of its hash, for provenance."""
        return f"{self.name} {self.sha256[:12]}"


@dataclass(frozen=True)
class Pooled:
    """What a network that pools says of all windows together: EMoR weights (11,) and the E_est it expects."""

    weights: Floats
    expected_error: float


@dataclass(frozen=True)
class WindowPredictions:
    """What the network says of N windows: EMoR weights (N, 11), the E_est it expects of each (N,), and of all."""

    weights: Floats
    expected_errors: Floats
    pooled: Pooled | None = None


class ResponseNetwork:
    """An onnxruntime session, made once, and the configuration beside it."""

    def __init__(self, config: ModelConfig, session: onnxruntime.InferenceSession, threads: int) -> None:
        self.config = config
        self._session = session
        self._threads = threads

    @classmethod
    def load(cls, folder: str | Path | None = None, *, threads: int = 0) -> ResponseNetwork:
        """Return the network in `folder`, by default the packaged one, on the CPU.

        Parameters
        ----------
        folder : str or Path, optional
            Holds model.onnx and model.json; or the name of a packaged model, such as "crfnet2017".
        threads : int
            Windows that run at the same time, in a network that reads windows; 0 takes the processor's number of cores.

        Raises
        ------
        ModelError
            If a file is absent or does not match the other, or the number of threads is negative.
        """
        if threads < 0:
            raise ModelError(f"the number of threads must be 0 (all cores) or more, found {threads}")
        folder = model_folder(folder)
        config = ModelConfig.read(folder / "model.json")
        graph = _read_bytes(folder / "model.onnx")
        if hashlib.sha256(graph).hexdigest() != config.sha256:
            raise ModelError(f"{folder}: model.onnx is not the file that model.json describes; restore the pair")
        return cls(config, _session(folder, graph, config), threads or os.cpu_count() or 1)

    def predict(
        self, windows: NDArray[np.float32], *, progress: Callable[[int, int], None] | None = None
    ) -> WindowPredictions:
        """Return the predictions for `windows`, float32 (N, 227, 227, 3), code values in [0, 1].

        Windows are prepared one by one, so that the working set stays in a core's cache. Networks of windows share them
        out to the threads; statistics are counted by one, since numpy's small steps wait for each other's interpreter
        lock: two threads take a quarter longer.

        Parameters
        ----------
        windows : ndarray
            At least one window; not changed.
        progress : callable, optional
            Called with (done, total) after every window; what it raises stops the run within a window's time.
        """
        of_window, threads = (window_statistics, 1) if self.config.reads_statistics else (self._run, self._threads)
        rows: list[Any] = []
        pool = ThreadPoolExecutor(threads)
        try:
            for number, row in enumerate(pool.map(of_window, windows), start=1):
                rows.append(row)
                if progress is not None:
                    progress(number, len(windows))
        finally:
            pool.shutdown(cancel_futures=True)
        if self.config.reads_statistics:
            outputs = self._run(*rows)
        else:
            outputs = [np.concatenate(column) for column in zip(*rows, strict=True)]
        weights, log_errors, *pooled = (output.astype(np.float64) for output in outputs)
        whole = Pooled(pooled[0][0], float(np.exp(pooled[1][0]))) if pooled else None
        return WindowPredictions(weights, np.exp(log_errors), whole)

    def _run(self, *rows: NDArray[np.float32]) -> list[NDArray[np.float32]]:
        """Return the network's outputs for windows or for their statistics."""
        feed = {self.config.input_name: np.stack(rows).astype(np.float32, copy=False)}
        outputs: list[NDArray[np.float32]] = self._session.run(list(self.config.output_names), feed)
        return outputs


def model_folder(wanted: str | Path | None = None) -> Path:
    """Return the folder of a model: that of a path where there is one, else of the packaged model of this name."""
    if wanted is None:
        return DEFAULT_MODEL
    is_packaged = not Path(wanted).is_dir() and (MODELS / wanted / "model.json").is_file()
    return MODELS / wanted if is_packaged else Path(wanted)


def _session(folder: Path, graph: bytes, config: ModelConfig) -> onnxruntime.InferenceSession:
    """Return the session of a graph on one thread of the CPU, or say why there is none."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    try:
        session = onnxruntime.InferenceSession(graph, options, providers=["CPUExecutionProvider"])
    except _UNLOADABLE as problem:
        raise ModelError(
            f"{folder}: onnxruntime cannot load model.onnx; restore it or update ({one_line(problem)})"
        ) from None
    found = {node.name for node in (*session.get_inputs(), *session.get_outputs())}
    absent = {config.input_name, *config.output_names} - found
    if absent:
        raise ModelError(f"{folder}: model.onnx has no {', '.join(sorted(absent))}; export the model again")
    return session


def _read_calibration(path: Path, entries: object) -> Calibration:
    """Return the calibration in a model.json, or say what it lacks."""
    names = [field.name for field in fields(Calibration)]
    if not isinstance(entries, dict) or set(entries) != set(names):
        raise ModelError(f"{path}: the calibration needs {', '.join(names)}; export the model again")
    return Calibration(**{**entries, "band_profile": tuple(entries["band_profile"])})


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
