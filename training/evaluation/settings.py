"""What an evaluation is asked for: models, protocols, and how many photographs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.network import ModelConfig, model_folder, packaged_models
from training.evaluation.plan import CONDITIONS, QUERIES, STRESS_PHOTOGRAPHS, Condition, Query
from training.evaluation.report.content import MeasuredModel

#: P5, the reliability of the uncertainty, comes with P0, P2 and P4.
PROTOCOLS = ("p0", "p1", "p2", "p3", "p4", "p6")

#: Photographs of P0: every response with every test scene.
ALL_PHOTOGRAPHS = 4020


@dataclass(frozen=True)
class Model:
    """A model folder.

    Parameters
    ----------
    name : str
        The name in the report: that of the folder.
    folder : Path
        The folder.
    measured : MeasuredModel
        What the report says of the model.
    """

    name: str
    folder: Path
    measured: MeasuredModel

    @classmethod
    def find(cls, wanted: str) -> Model:
        """Return the model of this name in crfnet_core/models, or in the folder of this path.

        Raises
        ------
        CRFNetError
            If there is neither, or the folder is no model.
        """
        folder = model_folder(wanted)
        if not (folder / "model.json").is_file():
            names = ", ".join(folder.name for folder in packaged_models())
            raise CRFNetError(f"{wanted}: is no model folder; give its path, or one of {names}")
        config = ModelConfig.read(folder / "model.json")
        kinds, held_out = config.training.get("scene_kinds"), config.training.get("held_out_curves")
        measured = MeasuredModel(config.sha256, None if kinds is None else tuple(kinds), tuple(held_out or ()))
        return cls(folder.resolve().name, folder, measured)

    def lacks(self, held_out: Sequence[int]) -> bool:
        """Return whether model.json says that these responses were kept out of its training."""
        return set(held_out) <= set(self.measured.held_out_curves)


@dataclass(frozen=True)
class Settings:
    """What is measured.

    Parameters
    ----------
    out : Path
        The folder of the report.
    models : tuple of Model
        All are measured on the same photographs.
    protocols : tuple of str
        Some of `PROTOCOLS`.
    photographs : int
        The most photographs in P0 and P2.
    workers : int
        Processes; 1 measures in this one.
    seed : int
        Of the choice of photographs, of dither, noise and bootstrap.
    stress_photographs : int
        The most photographs in P3 under each condition; also limited by `photographs`.
    conditions, queries : tuple
        Those of P3.
    """

    out: Path
    models: tuple[Model, ...]
    protocols: tuple[str, ...] = PROTOCOLS
    photographs: int = ALL_PHOTOGRAPHS
    workers: int = 2
    seed: int = 2017
    stress_photographs: int = STRESS_PHOTOGRAPHS
    conditions: tuple[Condition, ...] = CONDITIONS
    queries: tuple[Query, ...] = QUERIES

    @property
    def names(self) -> list[str]:
        """The models' names."""
        return [model.name for model in self.models]
