"""A graph in onnxruntime: what it may hold, takes and answers is checked, since a model folder is untrusted input."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core.errors import ModelError, one_line
from crfnet_core.network.graph import check_graph
from crfnet_core.network.model import ModelConfig
from crfnet_core.network.runtime import onnxruntime
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from crfnet_core.posterior.families import UNUSUAL
from crfnet_core.statistics.layout import LENGTH
from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array

#: Shape of a row of each input, and of the outputs: location, factor and log-odds, once or twice.
INPUT_SHAPES = {"windows": (WINDOW_SIZE, WINDOW_SIZE, 3), "statistics": (LENGTH,)}
OUTPUT_SHAPES = ((EVIDENCE_WEIGHTS,), (EVIDENCE_WEIGHTS, EVIDENCE_WEIGHTS), (len(UNUSUAL),))

#: Largest number in an output: those of the packaged ones are below 10, and the square of this one has room in float64.
MOST = 1e9

#: What onnxruntime raises, beside Python's own errors.
_PROBLEMS: tuple[type[Exception], ...] = (
    RuntimeError,
    ValueError,
    MemoryError,
    *(
        kind
        for kind in vars(onnxruntime.capi.onnxruntime_pybind11_state).values()
        if isinstance(kind, type) and issubclass(kind, Exception)
    ),
)

#: onnxruntime's own lines on stderr are suppressed below this severity: fatal.
_FATAL = 4


class Session:
    """The network of a model folder on one thread of the CPU; threads may share it.

    Parameters
    ----------
    folder : Path
        What errors name.
    graph : bytes
        The content of model.onnx.
    config : ModelConfig
        What model.json says of it.

    Raises
    ------
    ModelError
        If the graph holds what is refused, cannot be loaded, or takes or answers something else than model.json says.
    """

    def __init__(self, folder: Path, graph: bytes, config: ModelConfig) -> None:
        self._folder, self._config = folder, config
        try:
            check_graph(graph)
        except ValueError as problem:
            raise ModelError(f"{folder}: model.onnx {problem}; restore it") from None
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = 1
        options.log_severity_level = _FATAL
        if config.reads_statistics:  # to optimize two thousand small operators takes longer than it saves
            options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL
        options.add_session_config_entry("session.load_model_format", "ONNX")  # not what its first bytes call it
        try:
            self._session = onnxruntime.InferenceSession(
                graph, options, providers=["CPUExecutionProvider"], enable_fallback=0
            )
            self._check_signature()
        except _PROBLEMS as problem:
            raise ModelError(
                f"{folder}: onnxruntime cannot load model.onnx; restore it or update ({one_line(problem)})"
            ) from None

    def run(self, inputs: Float32Array) -> list[Float32Array]:
        """Return the network's outputs for some rows: finite, and of the shapes of evidence.

        Raises
        ------
        ModelError
            If they are not, or onnxruntime fails.
        """
        options = onnxruntime.RunOptions()
        options.log_severity_level = _FATAL
        names = list(self._config.output_names)
        try:
            outputs = self._session.run(names, {self._config.input_name: inputs}, options)
        except _PROBLEMS as problem:
            raise self._error(f"fails ({one_line(problem)})") from None
        for number, (name, output) in enumerate(zip(names, outputs, strict=True)):
            row = OUTPUT_SHAPES[number % 3]
            expected = (len(inputs) if number < 3 else 1, *row)
            if output.shape != expected:
                raise self._error(f"answers with {name} of shape {output.shape}, needed is {expected}")
            if not (np.abs(output) <= MOST).all():
                raise self._error(f"answers with {name} that is not finite or above {MOST:g}")
        return list(outputs)

    def _check_signature(self) -> None:
        """Check the names, types and shapes of inputs and outputs, as far as the graph declares them."""
        name = self._config.input_name
        inputs = {node.name: node for node in self._session.get_inputs()}
        outputs = {node.name: node for node in self._session.get_outputs()}
        if absent := sorted({*self._config.output_names} - outputs.keys() | {name} - inputs.keys()):
            raise self._error(f"has no {', '.join(absent)}")
        if len(inputs) > 1:
            raise self._error(f"has {len(inputs)} inputs, needed is {name} alone")
        if (count := len(self._config.output_names)) not in (3, 6):
            raise self._error(f"has {count} outputs, needed are 3, or 6 if it pools its windows")
        nodes = [inputs[name], *(outputs[output] for output in self._config.output_names)]
        for node, row in zip(nodes, [INPUT_SHAPES[name], *OUTPUT_SHAPES * (count // 3)], strict=True):
            if node.type != "tensor(float)" or not _fits(node.shape, row):
                raise self._error(f"has {node.name} of {node.type} {node.shape}, needed is float {('N', *row)}")

    def _error(self, problem: str) -> ModelError:
        """Return the error of a network that cannot be used."""
        return ModelError(f"{self._folder}: model.onnx {problem}; export the model again")


def _fits(declared: list[Any], row: tuple[int, ...]) -> bool:
    """Return whether a declared shape, whose free sizes are names or None, is that of rows of a shape."""
    sizes = declared[1:]
    return len(sizes) == len(row) and all(
        size == wanted for size, wanted in zip(sizes, row, strict=True) if isinstance(size, int)
    )
