"""A graph in onnxruntime, its outputs checked."""

from pathlib import Path
from threading import Timer
from typing import Any

import numpy as np

from crfnet_core.errors import ModelError
from crfnet_core.network.graph import check_graph
from crfnet_core.network.model import ModelConfig
from crfnet_core.network.runtime import onnxruntime
from crfnet_core.posterior.families import UNUSUAL
from crfnet_core.types import Float32Array

#: The errors that onnxruntime raises.
_NAMES = vars(onnxruntime.capi.onnxruntime_pybind11_state).values()
_PROBLEMS: tuple[type[Exception], ...] = (
    *(RuntimeError, ValueError, MemoryError),
    *(kind for kind in _NAMES if isinstance(kind, type) and issubclass(kind, Exception)),
)

#: Seconds after which a run ends at its next node, and bytes of the largest constant that is computed at load.
RUN_SECONDS, MOST_CONSTANT = 30, 2**24

_FATAL = 4  # the severity below which lines that onnxruntime writes to stderr are suppressed


class Session:
    """The network of a model folder on one thread of the CPU; threads may share it.

    Raise ModelError if the graph is not within the bounds of `check_graph` or cannot be loaded.
    """

    def __init__(self, folder: Path, graph: bytes, config: ModelConfig) -> None:
        self._folder, self._config = folder, config
        check_graph(folder, graph)
        try:
            self._session = onnxruntime.InferenceSession(
                graph, _options(config), providers=["CPUExecutionProvider"], enable_fallback=0
            )
            sizes = [size for node in self._session.get_inputs() for size in node.shape[1:2]]
        except _PROBLEMS as problem:  # also UnicodeDecodeError: sizes may have names
            raise ModelError("unloadable_graph", folder=folder, reason=problem) from None
        #: Columns of the input that the graph reads; None, in place of which it has a name, for all.
        self._columns = sizes[0] if sizes and isinstance(sizes[0], int) else None

    def run(self, inputs: Float32Array) -> list[Float32Array]:
        """Return the network's outputs for some rows: finite, and of the shapes of evidence.

        Of statistics it reads the first cues, as many as it was trained with. Raise ModelError if they are not, or
        onnxruntime fails.
        """
        options, names = onnxruntime.RunOptions(), list(self._config.output_names)
        options.log_severity_level = _FATAL
        end = Timer(RUN_SECONDS, setattr, (options, "terminate", True))
        end.start()
        try:
            read = {self._config.input_name: inputs[:, : self._columns]}
            outputs: list[Float32Array] = self._session.run(names, read, options)
        except _PROBLEMS as problem:
            raise ModelError("failing_graph", folder=self._folder, reason=problem) from None
        finally:
            end.cancel()
        self._check(outputs, len(inputs))
        return outputs

    def _check(self, outputs: list[Float32Array], rows: int) -> None:
        """Refuse outputs that are not evidence of each row and, of a network that pools them, of all rows together."""
        weights = self._config.components
        shapes = ((weights,), (weights, weights), (len(UNUSUAL),))  # of location, factor and log-odds
        for number, (name, output) in enumerate(zip(self._config.output_names, outputs, strict=True)):
            shape = (rows if number < 3 else 1, *shapes[number % 3])
            if output.shape != shape or not np.isfinite(output).all():
                raise ModelError("bad_output", folder=self._folder, name=name, shape=output.shape, needed=shape)


def _options(config: ModelConfig) -> Any:
    """Return the options of a session: one thread, and nothing on stderr."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    options.log_severity_level = _FATAL
    if config.reads_statistics:  # to optimize two thousand small operators takes longer than it saves
        options.graph_optimization_level = onnxruntime.GraphOptimizationLevel.ORT_DISABLE_ALL
    options.add_session_config_entry("session.load_model_format", "ONNX")  # not what its first bytes call it
    options.add_session_config_entry("session.use_env_allocators", "1")  # of bounded memory
    options.add_session_config_entry("optimization.constant_folding_max_output_size_in_bytes", str(MOST_CONSTANT))
    return options
