"""What was done to the config that a program reads at its start, written down beside it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

from crfnet_core.errors import ConfigError
from crfnet_core.files import atomic_write_text

#: The folder of our own beside the config, and the record in it.
FOLDER, RECORD_NAME = "camera_response", "installed.json"


@dataclass(frozen=True)
class InstallationRecord:
    """What was done to a config.

    Parameters
    ----------
    sha256 : str
        The hash of the config as it was written.
    backup : str or None
        The file name of the earlier config's copy.
    folders : tuple of str
        The LUT folders that were copied beside the config.
    plates : dict of str to str
        The plate of each colour space that was added, by the name of the space; records of old versions have none.
    """

    sha256: str
    backup: str | None
    folders: tuple[str, ...]
    plates: Mapping[str, str] = field(default_factory=dict)


def read_record(folder: Path) -> InstallationRecord | None:
    """Return what was done in the folder of a config, or None if nothing was or the record is damaged."""
    try:
        entries = json.loads((folder / FOLDER / RECORD_NAME).read_text(encoding="utf-8"))
        folders, plates = tuple(entries["folders"]), dict(entries.get("plates", {}))
        return InstallationRecord(entries["sha256"], entries["backup"], folders, plates)
    except (OSError, ValueError, KeyError, TypeError):
        return None


def write_record(folder: Path, record: InstallationRecord) -> None:
    """Write down what was done in the folder of a config.

    Raises
    ------
    ConfigError
        If the record cannot be written.
    """
    text = json.dumps(asdict(record), indent=1) + "\n"
    atomic_write_text(folder / FOLDER / RECORD_NAME, text, overwrite=True, error=ConfigError)


def digest(path: Path) -> str:
    """Return a file's SHA-256, or an empty text if there is no file."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
