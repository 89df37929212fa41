"""The models that an evaluation measures."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Self

from crfnet_core.errors import CRFNetError
from crfnet_core.network import ModelConfig, ResponseNetwork, model_folder, packaged_models


@dataclass(frozen=True)
class Model:
    """A model folder."""

    name: str
    folder: Path
    sha256: str  # of model.onnx
    held_out_curves: tuple[int, ...] = ()  # DoRF curves that model.json lists as kept out of training

    @classmethod
    def find(cls, wanted: str) -> Self:
        """Return the model of a name in crfnet_core/models, or in a folder; CRFNetError if there is neither."""
        folder = model_folder(wanted)
        if not (folder / "model.json").is_file():
            names = ", ".join(folder.name for folder in packaged_models())
            raise CRFNetError(f"{wanted}: not a model folder; give its path, or one of {names}")
        config = ModelConfig.read(folder / "model.json")
        return cls(folder.resolve().name, folder, config.sha256, tuple(config.training.get("held_out_curves") or ()))

    @property
    def key(self) -> str:
        """The head of the hash, as in the table."""
        return self.sha256[:12]

    def lacks(self, held_out: Sequence[int]) -> bool:
        """Return whether these responses were kept out of training."""
        return set(held_out) <= set(self.held_out_curves)


@cache
def load_network(model: Model, *, threads: int = 0) -> ResponseNetwork:
    """Return the network of a model, loaded once in a process; `threads` as in `ResponseNetwork.load`."""
    return ResponseNetwork.load(model.folder, threads=threads)
