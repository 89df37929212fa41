"""The table of an evaluation: one row for each photograph and estimator, in one file of JSON lines."""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError

#: The file of the table, in the folder of the evaluation.
TABLE_FILE = "photographs.jsonl"

#: A row: name of a column -> value. All rows have "protocol", "photograph", "estimator" and "model".
Row = dict[str, Any]

#: The columns that tell rows apart. "model" is the head of a model's hash, and empty for a baseline.
KEY = ("protocol", "photograph", "estimator", "model")

#: The code whose change makes earlier rows doubtful, from the project's root.
MEASURING_CODE = (
    "crfnet_core/**/*.py",
    "crfnet_core/data/*.npz",
    "crfnet_core/data/priors/*.json",
    "training/data/*.py",
    "training/data/real_kinds.csv",
    "training/synthesis/camera.py",
    "training/synthesis/unusual/*.py",
    "training/evaluation/baselines.py",
    "training/evaluation/plan.py",
    "training/evaluation/test_sets.py",
    "training/evaluation/measure/*.py",
)


class Table:
    """Rows on disk: each is written as soon as it is measured, and read again by the next run.

    The file is made where absent. Its first line holds the settings that all rows depend on.
    """

    def __init__(self, path: Path, settings: dict[str, Any]) -> None:
        self.path, code = path, code_digest()
        self._rows: dict[tuple[str, ...], Row] = {}
        path.parent.mkdir(parents=True, exist_ok=True)
        header, *rows = _lines(path) or [settings | {"code": code}]
        if {name: header.get(name) for name in settings} != settings:
            raise CRFNetError(f"{path}: was measured with other settings ({header}); take another folder")
        self.is_of_other_code = header["code"] != code
        self._remember(rows)
        if not path.exists():
            self._append([header])

    def add(self, rows: Iterable[Row]) -> None:
        """Add rows, and write them at once."""
        rows = list(rows)
        self._append(rows)
        self._remember(rows)

    def lacks(self, protocol: str, photograph: str, estimator: str, model: str = "") -> bool:
        """Return whether this row has to be measured."""
        return (protocol, photograph, estimator, model) not in self._rows

    def baselines(self, protocol: str) -> dict[str, str]:
        """Return the names of the baselines of a protocol, in the order of measuring, each with its empty model."""
        rows = self._rows.values()
        return {row["estimator"]: "" for row in rows if row["protocol"] == protocol and not row["model"]}

    def rows(self, protocol: str, estimators: dict[str, str], photographs: Iterable[str]) -> dict[str, list[Row]]:
        """Return estimator -> its rows on `photographs`, all measured, in their order.

        `estimators`: name of an estimator -> head of its model's hash, empty for baselines.
        """
        names = list(photographs)
        return {
            estimator: [self._rows[protocol, name, estimator, model] for name in names]
            for estimator, model in estimators.items()
        }

    def _remember(self, rows: Iterable[Row]) -> None:
        self._rows |= {tuple(row[name] for name in KEY): row for row in rows}

    def _append(self, rows: Iterable[Row]) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.writelines(json.dumps(row) + "\n" for row in rows)


def code_digest() -> str:
    """Return a short hash of the measuring code, in a checkout of the repository."""
    root, digest = Path(__file__).parents[3], hashlib.sha256()
    for path in sorted(path for pattern in MEASURING_CODE for path in root.glob(pattern)):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _lines(path: Path) -> list[Row]:
    """Return the lines of a table; a last line that was cut off is removed from the file."""
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole, encoding="utf-8")
    return [json.loads(line) for line in whole.splitlines()]
