"""Run a trained network on the CPU: windows in, evidence out."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Self, TypeVar

import numpy as np

from crfnet_core.errors import ModelError, check_kinds
from crfnet_core.network.model import ModelConfig, model_folder, read_graph
from crfnet_core.network.pooling import robust_mean
from crfnet_core.network.session import Session
from crfnet_core.posterior import Evidence
from crfnet_core.statistics import window_statistics
from crfnet_core.types import Float32Array, Progress, cores, is_number, show_progress

T = TypeVar("T")


@dataclass(frozen=True)
class Predictions:
    """The evidence that a network sees in one photograph."""

    windows: tuple[Evidence, ...]  # of each window by itself
    pooled: Evidence  # of all windows together: by the network, or their robust mean if it does not pool


class ResponseNetwork:
    """An onnxruntime session, made once, and its configuration; threads may share one, processes load their own."""

    def __init__(self, config: ModelConfig, session: Session, *, threads: int = 0) -> None:
        self.config = config
        self._session = session
        self._threads = threads

    @classmethod
    def load(cls, folder: str | Path | None = None, *, threads: int = 0) -> Self:
        """Return the network in `folder`, by default the packaged one, on the CPU.

        Parameters
        ----------
        folder : str or Path, optional
            Holds model.onnx and model.json; or the name of a packaged model, such as "crfnet2017".
        threads : int
            Windows that run at the same time, in a network that reads windows; 0 takes as many as the cores that this
            process may use.

        Raises
        ------
        ModelError
            If a file is absent or does not match the other, the graph cannot be used, or the number of threads is
            negative.
        """
        check_kinds(folder=(folder, str | Path | None))
        if not is_number(threads, int, least=0):
            raise ModelError("negative_threads", threads=threads)
        folder = model_folder(folder)
        config = ModelConfig.read(folder / "model.json")
        return cls(config, Session(folder, read_graph(folder, config), config), threads=threads)

    def predict(self, windows: Float32Array, *, progress: Progress | None = None) -> Predictions:
        """Return the evidence in the windows of one photograph, code values in [0, 1], shape (N, 227, 227, 3).

        `progress` is called with (done, total) after every window. Raise ModelError if the network fails, or answers
        with numbers that are not finite or of another shape than evidence.
        """
        if self.config.reads_statistics:
            # one thread, as numpy's small steps wait for each other's interpreter lock (two take a quarter longer), and
            # one window at a time, as that fits into a core's cache
            rows = _counted(map(window_statistics, windows), len(windows), progress)
            outputs = self._session.run(np.stack(rows))
        else:
            outputs = [np.concatenate(column) for column in zip(*self._run_each(windows, progress), strict=True)]
        evidences = _evidences(outputs[:3])
        return Predictions(evidences, _evidences(outputs[3:])[0] if outputs[3:] else robust_mean(evidences))

    def _run_each(self, windows: Float32Array, progress: Progress | None) -> list[list[Float32Array]]:
        """Return the network's outputs for each window; what `progress` raises stops it within a window's time."""
        pool = ThreadPoolExecutor(self._threads or cores())
        try:
            return _counted(pool.map(self._session.run, windows[:, None]), len(windows), progress)
        finally:
            pool.shutdown(cancel_futures=True)


def _counted(results: Iterable[T], total: int, progress: Progress | None) -> list[T]:
    """Return the results of `total` steps; `progress` is called after each of them."""
    done = []
    for number, result in enumerate(results, start=1):
        done.append(result)
        show_progress(progress, number, total)
    return done


def _evidences(outputs: Sequence[Float32Array]) -> tuple[Evidence, ...]:
    """Return the evidence in a network's locations (N, K), factors (N, K, K) and log-odds (N, 3)."""
    return tuple(Evidence(*parts) for parts in zip(*(output.astype(np.float64) for output in outputs), strict=True))
