"""What was done to a config, written down in a folder of our own beside it, and the backup of what it was before."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path

from crfnet_core.files import atomic_write_text, file_sha256, read_json

from ..defaults import CONFIG_NAME
from ..errors import ConfigError
from .undo import as_before_on_failure

#: The folder of our own beside a config called `CONFIG_NAME`, and the record in it.
FOLDER, RECORD_NAME = "camera_response", "installed.json"

#: Name of the copy of an earlier config, and of further copies, after the config's own name without its suffix.
BACKUP_NAME, NUMBERED_BACKUP = "{}.before-camera-response.ocio", "{}.before-camera-response-{}.ocio"

#: Most backups of one config.
MAX_BACKUPS = 999


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
    files : tuple of str
        The files in these folders, relative to the config; records of old versions have none.
    """

    sha256: str
    backup: str | None
    folders: tuple[str, ...]
    plates: Mapping[str, str] = field(default_factory=dict)
    files: tuple[str, ...] = ()


def own_folder(config: Path) -> Path:
    """Return the folder of our own beside a config, for LUTs and the record; every config has another one."""
    return config.parent / (FOLDER if config.name == CONFIG_NAME else f"{config.stem}_{FOLDER}")


def read_record(config: Path) -> InstallationRecord | None:
    """Return what was done to a config, or None if nothing was or the record is damaged."""
    try:
        entries = read_json(record_file(config))
        folders, plates = tuple(entries["folders"]), dict(entries.get("plates", {}))
        files, backup = tuple(entries.get("files", ())), entries["backup"]
        if not all(Path(name).name == name not in ("", "..") for name in (*folders, *([backup] if backup else []))):
            return None  # what leads elsewhere was not written by us, and might be removed
        return InstallationRecord(entries["sha256"], backup, folders, plates, files)
    except (OSError, KeyError, OverflowError, TypeError, ValueError):
        return None


def write_record(config: Path, record: InstallationRecord) -> None:
    """Write down what was done to a config.

    Raises
    ------
    ConfigError
        If the record cannot be written.
    """
    text = json.dumps(asdict(record), indent=1) + "\n"
    atomic_write_text(record_file(config), text, overwrite=True, error=ConfigError)


def record_file(config: Path) -> Path:
    """Return the file of the record beside a config."""
    return own_folder(config) / RECORD_NAME


def remove_record(config: Path) -> None:
    """Remove the record beside a config, and our folder if nothing else is in it."""
    record_file(config).unlink(missing_ok=True)
    with suppress(OSError):
        own_folder(config).rmdir()


@contextmanager
def backed_up(config: Path, record: InstallationRecord | None) -> Iterator[str | None]:
    """Copy a config that somebody else wrote, and yield the copy's file name; if the block fails, remove the copy.

    If the config is as the record says, nothing is copied, and the name is that in the record. It is None if there is
    no earlier config. A ConfigError if there are `MAX_BACKUPS` copies.
    """
    if not config.exists():
        yield None
        return
    if record is not None and digest(config) == record.sha256:
        yield record.backup
        return
    numbered = (NUMBERED_BACKUP.format(config.stem, number) for number in range(2, MAX_BACKUPS + 1))
    names = (BACKUP_NAME.format(config.stem), *numbered)
    name = next((name for name in names if not config.with_name(name).exists()), None)
    if name is None:
        raise ConfigError(f"{config}: has {MAX_BACKUPS} backups already; move some elsewhere")
    with as_before_on_failure([config.with_name(name)]):
        shutil.copy2(config, config.with_name(name))
        yield name


def check_is_ours(folder: Path, record: InstallationRecord) -> None:
    """Raise a ConfigError if a config's folder, which is to be removed, holds a file that was neither copied nor made.

    Records of old versions do not name the copied files: all in the copied folders are taken for them.
    """
    ours = {CONFIG_NAME, *record.files, *files_in(folder, (FOLDER,) if record.files else (FOLDER, *record.folders))}
    for name in files_in(folder, (".",)):
        if name not in ours:
            raise ConfigError(f"{folder / name}: came neither from us nor with the config; move it elsewhere first")


def files_in(folder: Path, names: Iterable[str]) -> list[str]:
    """Return all files in some folders of a folder, relative to it, with slashes; sorted."""
    found = (path for name in names for path in (folder / name).rglob("*") if path.is_file())
    return sorted(path.relative_to(folder).as_posix() for path in found)


def digest(path: Path) -> str:
    """Return a file's SHA-256, or an empty text if there is no file."""
    return file_sha256(path) if path.is_file() else ""
