"""A model folder: model.onnx, model.json, the model card, and run.json of the training run that it came from."""

import hashlib
import json
import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from crfnet_core.errors import ModelError
from crfnet_core.files import atomic_write_text, read_bytes, read_json
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from crfnet_core.response.emor import COMPONENTS
from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import typed_value

#: The packaged models, and the one that is used unless another is asked for.
MODELS = Path(__file__).parents[1] / "models"
DEFAULT_MODEL = MODELS / "photograph-statistics-2.4"

MAX_GRAPH_SIZE = 64 * 2**20  # size in bytes of the largest model.onnx that is read

#: Basis and side of the windows that every network is made for, the numbers of weights that its evidence may be about,
#: and the inputs that it may read.
KIND = ("emor", WINDOW_SIZE)
WEIGHTS = (EVIDENCE_WEIGHTS, COMPONENTS)
INPUTS = ("windows", "statistics")


@dataclass(frozen=True)
class ModelConfig:
    """The entries of model.json."""

    name: str  # the model's and its folder's
    sha256: str  # of model.onnx; checked at load
    basis: str  # the response model of the outputs: "emor"
    components: int  # number K of its first weights that the evidence is about; 11 are a whole response: the answer
    window_size: int  # side of a window in samples
    #: "windows", float32 (N, 227, 227, 3), or "statistics" of them, float32 (N, LENGTH): see `crfnet_core.statistics`.
    input_name: str
    #: Evidence (`crfnet_core.posterior.Evidence`) of each window: locations (N, K), factors (N, K, K) and log-odds (N,
    #: 3); of a network that pools its windows, then the same of all of them together, (1, ...).
    output_names: tuple[str, ...]
    normalization: str  # the scale of the input, in words
    opset: int  # of the ONNX graph
    training_commit: str  # the commit of this project that the training run began from; see run.json
    #: "scene_kinds" that it was trained on, and "held_out_curves", the DoRF curves that it has not seen.
    training: dict[str, Any]
    accuracy: dict[str, Any]  # figures of the model card

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Return the configuration in a model.json.

        Raise ModelError if the file is absent or is not JSON, lacks an entry, or describes a network of another kind.
        """
        path = Path(path)
        try:
            config: Self = typed_value(_read_object(path), cls)
        except (TypeError, ValueError) as problem:
            raise ModelError("bad_model_config", path=path, problem=problem) from None
        kind, names = (config.basis, config.window_size), config.output_names
        is_evidence = len(set(names)) == len(names) in (3, 6)  # of windows, and of all of them together if it pools
        if kind != KIND or config.components not in WEIGHTS or config.input_name not in INPUTS or not is_evidence:
            raise ModelError("other_kind_of_model", path=path, found=kind, needed=KIND)
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

    A folder of that path comes first. Another text is returned as a path, for an error that names it.
    """
    if wanted is None:
        return DEFAULT_MODEL
    if os.path.isdir(wanted):  # noqa: PTH112 - unlike `Path.is_dir`, it takes names that are too long
        return Path(wanted)
    named = [folder for folder in packaged_models() if str(wanted) in (folder.name, folder.name.rpartition("-")[0])]
    return max(named, key=lambda folder: [*map(int, folder.name.rpartition("-")[2].split("."))], default=Path(wanted))


def read_graph(folder: Path, config: ModelConfig) -> bytes:
    """Return the content of model.onnx; a ModelError if it cannot be read or model.json describes another."""
    path = folder / "model.onnx"
    try:
        graph = read_bytes(path, most=MAX_GRAPH_SIZE)
    except OSError as problem:
        raise ModelError("unreadable_model", path=path, reason=problem.strerror) from None
    if hashlib.sha256(graph).hexdigest() != config.sha256:
        raise ModelError("altered_model", folder=folder)
    return graph


def _read_object(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file."""
    try:
        entries = read_json(path)
    except OSError as problem:
        raise ModelError("unreadable_model", path=path, reason=problem.strerror) from None
    except ValueError:
        entries = None
    if not isinstance(entries, dict):
        raise ModelError("bad_model_json", path=path)
    return entries
