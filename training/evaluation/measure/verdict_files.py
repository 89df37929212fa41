"""The verdicts of one model on pictures without a true response, kept on disk so that P6 goes on."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crfnet_core.files import atomic_write_text
from crfnet_core.posterior import Verdict


@dataclass
class VerdictFile:
    """The verdicts of one model.

    Parameters
    ----------
    path : Path
        The file, FOLDER/cases/<model>/p6.json.
    settings : dict
        What the verdicts depend on, the code included; a file of other settings is not read but replaced.
    verdicts : dict
        Label of a picture -> verdict.
    """

    path: Path
    settings: dict[str, Any]
    verdicts: dict[str, Verdict] = field(default_factory=dict)

    @classmethod
    def opened(cls, path: Path, settings: dict[str, Any]) -> VerdictFile:
        """Return the verdicts kept under these settings, or none."""
        document = json.loads(path.read_text()) if path.is_file() else {}
        if document.get("settings") != settings:
            return cls(path, settings)
        return cls(path, settings, {label: Verdict(word) for label, word in document["verdicts"].items()})

    def save(self) -> None:
        """Write the file."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        document = {"settings": self.settings, "verdicts": self.verdicts}
        atomic_write_text(self.path, json.dumps(document, indent=1) + "\n", overwrite=True)
