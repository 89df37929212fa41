"""The figures of every estimator on every photograph, kept on disk so that an interrupted evaluation goes on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from training.evaluation.measure.figures import PhotographFigures

#: The code whose change makes kept figures doubtful, from the project's root.
MEASURING_CODE = (
    "crfnet_core/**/*.py",
    "crfnet_core/data/responses.npz",
    "crfnet_core/data/priors/*.json",
    "crfnet_core/data/emor.npz",
    "training/data/**/*.py",
    "training/synthesis/camera.py",
    "training/synthesis/unusual/*.py",
    "training/evaluation/baselines.py",
    "training/evaluation/plan.py",
    "training/evaluation/test_sets.py",
    "training/evaluation/measure/*.py",
)

#: What a case file says of its code when not all figures in it come from the same.
MIXED = "mixed"


def code_digest(root: Path = Path(__file__).parents[3]) -> str:
    """Return a short hash of the code that figures come from, in a checkout of the repository."""
    digest = hashlib.sha256()
    for pattern in MEASURING_CODE:
        for path in sorted(root.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@dataclass
class CaseFile:
    """The figures of one model, or of all baselines, in one protocol.

    Parameters
    ----------
    path : Path
        The file, FOLDER/cases/<model>/<protocol>.json.
    settings : dict
        What the figures depend on; a file of other settings is not read but replaced.
    code : str
        See `code_digest`.
    rows : dict
        Label of a photograph -> name of an estimator -> its figures.
    is_of_other_code : bool
        Whether some figures were measured before the code changed.
    """

    path: Path
    settings: dict[str, Any]
    code: str
    rows: dict[str, dict[str, PhotographFigures]] = field(default_factory=dict)
    is_of_other_code: bool = False

    @classmethod
    def opened(cls, path: Path, settings: dict[str, Any], code: str) -> CaseFile:
        """Return the figures kept under these settings, or none."""
        cases = cls(path, settings, code)
        document = json.loads(path.read_text()) if path.is_file() else {}
        if document.get("settings") != settings or document.get("figures") != list(PhotographFigures.names()):
            return cases
        cases.is_of_other_code = document["code"] != code
        for name, columns in document["estimators"].items():
            for label, *values in zip(document["photographs"], *columns.values(), strict=True):
                figures = PhotographFigures.of_values(dict(zip(columns, values, strict=True)))
                cases.rows.setdefault(label, {})[name] = figures
        return cases

    def save(self) -> None:
        """Write the file: for each estimator a column of every figure that it has."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        document = {
            "settings": self.settings,
            "code": MIXED if self.is_of_other_code else self.code,
            "figures": PhotographFigures.names(),
            "photographs": list(self.rows),
            "estimators": {name: self._columns(name) for name in next(iter(self.rows.values()), {})},
        }
        atomic_write_text(self.path, json.dumps(document) + "\n", overwrite=True)

    def _columns(self, estimator: str) -> dict[str, list[Any]]:
        """Return name of a figure -> its values on all photographs, without the figures that the estimator lacks."""
        rows = [row[estimator] for row in self.rows.values()]
        columns = {name: [getattr(row, name) for row in rows] for name in PhotographFigures.names()}
        return {name: column for name, column in columns.items() if column[0] is not None}

    def figures(self, labels: Sequence[str]) -> dict[str, list[PhotographFigures]]:
        """Return estimator -> its figures on the photographs of these labels, in their order.

        Raises
        ------
        CRFNetError
            If one was not measured.
        """
        absent = [label for label in labels if label not in self.rows]
        if absent:
            raise CRFNetError(f"{self.path}: {len(absent)} photographs are absent, the first: {absent[0]}; go on first")
        rows = [self.rows[label] for label in labels]
        return {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}
