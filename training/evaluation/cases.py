"""The errors of every estimator on every photograph, kept on disk so that an interrupted evaluation goes on."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from crfnet_core.metrics import estimation_error, linearization_error
from crfnet_core.response import ResponseCurve

#: Share of the irradiance that a partial response covers (CRF-net paper, Fig. 9).
PARTIAL = 0.8

#: Decimals of the figures on disk.
DECIMALS = 6

#: The code whose change makes kept cases doubtful, from the project's root.
MEASURING_CODE = (
    "crfnet_core/*.py",
    "training/data/scenes.py",
    "training/synthesis/camera.py",
    "training/data/studio_lights.py",
    "training/evaluation/measure.py",
    "training/evaluation/cases.py",
)

CODES = np.arange(256) / 255

Row = dict[str, Any]


def errors(true: ResponseCurve, estimated: ResponseCurve, counts: np.ndarray) -> Row:
    """Return the errors of one response on one photograph.

    Parameters
    ----------
    true, estimated : ResponseCurve
        The responses.
    counts : ndarray, int, shape (256,)
        How often each code occurs in the photograph.

    Returns
    -------
    dict
        "estimation" E_est, "partial" E_est over the samples with E <= 0.8, both curves as they are, and
        "linearisation" E_lin.
    """
    lower = round(PARTIAL * (len(true.brightness) - 1)) + 1
    return {
        "estimation": round(estimation_error(true, estimated), DECIMALS),
        "partial": round(float(np.linalg.norm((true.brightness - estimated.brightness)[:lower])), DECIMALS),
        "linearisation": round(linearization_error(CODES, true, estimated, counts=counts), DECIMALS),
    }


def code_digest() -> str:
    """Return a short hash of the code that cases come from."""
    root = Path(__file__).parents[2]
    digest = hashlib.sha256()
    for pattern in MEASURING_CODE:
        for path in sorted(root.glob(pattern)):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@dataclass
class CaseFile:
    """The cases of one model, or of the baselines, in one protocol.

    Parameters
    ----------
    path : Path
        The file, FOLDER/cases/<model>/<protocol>.json.
    settings : dict
        What the cases depend on; a file of other settings is not read but replaced.
    code : str
        See `code_digest`.
    rows : dict
        Label of a photograph -> name of an estimator -> its row of figures.
    is_of_other_code : bool
        Whether some cases were measured before the code changed.
    """

    path: Path
    settings: dict[str, Any]
    code: str
    rows: dict[str, dict[str, Row]] = field(default_factory=dict)
    is_of_other_code: bool = False

    @classmethod
    def opened(cls, path: Path, settings: dict[str, Any], code: str) -> CaseFile:
        """Return the cases kept under these settings, or none."""
        cases = cls(path, settings, code)
        document = json.loads(path.read_text()) if path.is_file() else {}
        if document.get("settings") != settings:
            return cases
        cases.is_of_other_code = document["code"] != code
        for name, columns in document["estimators"].items():
            for row in zip(document["photographs"], *columns.values(), strict=True):
                cases.rows.setdefault(row[0], {})[name] = dict(zip(columns, row[1:], strict=True))
        return cases

    def save(self) -> None:
        """Write the file: a column of figures for each estimator."""
        labels = list(self.rows)
        names = list(self.rows[labels[0]]) if labels else []
        estimators = {
            name: {key: [self.rows[label][name][key] for label in labels] for key in self.rows[labels[0]][name]}
            for name in names
        }
        code = "mixed" if self.is_of_other_code else self.code
        document = {"settings": self.settings, "code": code, "photographs": labels, "estimators": estimators}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        atomic_write_text(self.path, json.dumps(document) + "\n", overwrite=True)

    def columns(self, labels: list[str]) -> dict[str, dict[str, np.ndarray]]:
        """Return estimator -> figure -> array (N,) for the photographs of these labels, in their order.

        Raises
        ------
        CRFNetError
            If one was not measured.
        """
        absent = [label for label in labels if label not in self.rows]
        if absent:
            raise CRFNetError(f"{self.path}: {len(absent)} photographs are absent, the first: {absent[0]}; go on first")
        rows = [self.rows[label] for label in labels]
        return {
            name: {key: np.array([row[name][key] for row in rows]) for key in row}
            for name, row in (rows[0].items() if rows else ())
        }
