"""A model folder: model.onnx, model.json, the model card, and run.json of the training run that it came from."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from crfnet_core.errors import ModelError
from crfnet_core.files import atomic_write_text, read_bytes, read_json
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from crfnet_core.statistics.windows import WINDOW_SIZE

#: The packaged models, and the one that is used unless another is asked for.
MODELS = Path(__file__).parents[1] / "models"
DEFAULT_MODEL = MODELS / "photograph-statistics-2.4"

#: Size in bytes of the largest model.onnx that is read, and characters of the longest text in a model.json.
MAX_GRAPH_SIZE = 256 * 2**20
MAX_TEXT = 200


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
        How many of its first weights the evidence is about.
    window_size : int
        Side of a window in samples.
    input_name : str
        "windows", float32 (N, 227, 227, 3), or "statistics" of them, float32 (N, LENGTH): see
        `crfnet_core.statistics`.
    output_names : tuple of str
        Evidence (`crfnet_core.posterior.Evidence`) of each window: locations (N, 5), factors (N, 5, 5) and log-odds
        (N, 3); of a network that pools its windows, then the same of all of them together, (1, ...).
    normalization : str
        What the input holds, in words.
    opset : int
        Of the ONNX graph.
    training_commit : str
        The commit of this project that the training run began from; see run.json.
    training : dict
        What it has seen: "scene_kinds", and "held_out_curves", the DoRF curves that it has not.
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
    normalization: str
    opset: int
    training_commit: str
    training: dict[str, Any]
    accuracy: dict[str, Any]

    @classmethod
    def read(cls, path: str | Path) -> ModelConfig:
        """Return the configuration in a model.json.

        Raises
        ------
        ModelError
            If the file is absent, is no JSON, lacks an entry or has one of another type, or describes a network of
            another kind.
        """
        path = Path(path)
        entries = _read_json(path)
        missing = [field.name for field in fields(cls) if field.name not in entries]
        if missing:
            raise ModelError(f"{path}: lacks {', '.join(missing)}; export the model again")
        if unfit := [name for name, is_fit in _FIT.items() if not is_fit(entries[name])]:
            raise ModelError(f"{path}: {', '.join(unfit)} cannot be what a model has; export the model again")
        entries["output_names"] = tuple(entries["output_names"])
        config = cls(**{field.name: entries[field.name] for field in fields(cls)})
        if (config.basis, config.components, config.window_size) != ("emor", EVIDENCE_WEIGHTS, WINDOW_SIZE):
            raise ModelError(
                f"{path}: is for {config.components} weights of {config.basis} and windows of {config.window_size};"
                f" this version needs {EVIDENCE_WEIGHTS} of emor and {WINDOW_SIZE}"
            )
        return config

    def write(self, path: Path) -> None:
        """Write a model.json that `read` returns again; an existing one is replaced."""
        atomic_write_text(path, json.dumps(asdict(self), indent=2) + "\n", overwrite=True, error=ModelError)

    @property
    def reads_statistics(self) -> bool:
        """Whether the network reads the statistics of windows rather than their samples."""
        return self.input_name == "statistics"

    @property
    def label(self) -> str:
        """The model's name and the head of its hash, for provenance."""
        return f"{self.name} {self.sha256[:12]}"


def packaged_models() -> list[Path]:
    """Return the folders of the packaged models, sorted by name."""
    return sorted(config.parent for config in MODELS.glob("*/model.json"))


def model_folder(wanted: str | Path | None = None) -> Path:
    """Return the folder of a model: a path, or the name of a packaged model, of which the version may be left out.

    A folder of that path comes first. What is neither is returned as it is, for an error that names it.
    """
    if wanted is None:
        return DEFAULT_MODEL
    if Path(wanted).is_dir():
        return Path(wanted)
    named = [folder for folder in packaged_models() if str(wanted) in (folder.name, folder.name.rpartition("-")[0])]
    return max(named, key=_version, default=Path(wanted))


def _version(folder: Path) -> tuple[int, ...]:
    """Return the version at the end of a packaged model's name, such as (1, 0)."""
    return tuple(map(int, folder.name.rpartition("-")[2].split(".")))


def read_graph(path: Path) -> bytes:
    """Return a model.onnx's bytes, or say why it cannot be read."""
    try:
        return read_bytes(path, most=MAX_GRAPH_SIZE)
    except OSError as problem:
        raise _unreadable(path, problem) from None


def _read_json(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file."""
    try:
        entries = read_json(path)
    except OSError as problem:
        raise _unreadable(path, problem) from None
    except ValueError:
        raise ModelError(f"{path}: is not JSON; restore it") from None
    if not isinstance(entries, dict):
        raise ModelError(f"{path}: holds no JSON object; restore it")
    return entries


def _unreadable(path: Path, problem: OSError) -> ModelError:
    """Return the error of a model file that cannot be read."""
    return ModelError(f"{path}: cannot be read ({problem.strerror}); a model is a folder with both files")


def _is_text(value: object) -> bool:
    """Return whether a value can be printed on one line."""
    return isinstance(value, str) and 0 < len(value) <= MAX_TEXT and value.isprintable()


def _is_count(value: object) -> bool:
    """Return whether a value is an integer, which True is not."""
    return type(value) is int


def _are_outputs(value: object) -> bool:
    """Return whether a value is a list of different names."""
    return isinstance(value, list) and all(map(_is_text, value)) and 0 < len(value) == len({*value})


def _are_figures(value: object) -> bool:
    """Return whether a value holds numbers by protocol and name."""
    return isinstance(value, dict) and all(
        _is_text(protocol)
        and isinstance(figures, dict)
        and all(_is_text(name) and isinstance(figure, int | float) for name, figure in figures.items())
        for protocol, figures in value.items()
    )


#: Entry of model.json -> whether a value is fit for it. The file is untrusted input, whose texts are printed and drawn.
_FIT: dict[str, Callable[[Any], bool]] = {
    "name": _is_text,
    "sha256": lambda value: isinstance(value, str) and re.fullmatch("[0-9a-f]{64}", value) is not None,
    "basis": _is_text,
    "components": _is_count,
    "window_size": _is_count,
    "input_name": lambda value: value in ("windows", "statistics"),
    "output_names": _are_outputs,
    "normalization": _is_text,
    "opset": _is_count,
    "training_commit": _is_text,
    "training": lambda value: isinstance(value, dict),
    "accuracy": _are_figures,
}
