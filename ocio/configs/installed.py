"""Put a plate's colour space into the config that Blender reads at its start, and take everything back again.

Beside the config lies a folder of our own with the LUTs and a record of what was done. A config that is not as the
record says is somebody else's: it is kept as a backup before the colour space is added to it.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import PyOpenColorIO as OCIO

from crfnet_core.errors import ConfigError, one_line
from crfnet_core.files import atomic_write_text
from ocio.configs.plate_color_space import PlateColorSpace, add_plate_color_space, write_config
from ocio.luts.lut1d import Lut1D
from ocio.luts.spi1d import write_spi1d
from ocio.output_files import CONFIG_NAME, check_folder, output_folder

#: Our folder beside the config.
FOLDER = "camera_response"

RECORD_NAME = "installed.json"


@dataclass(frozen=True)
class Record:
    """What was done to a config.

    Parameters
    ----------
    sha256 : str
        Of the config as it was written.
    backup : str or None
        The name of the config that was there before.
    folders : tuple of str
        LUT folders of Blender that were copied beside the config.
    """

    sha256: str
    backup: str | None
    folders: tuple[str, ...]


@dataclass(frozen=True)
class Installed:
    """A colour space in a config.

    Parameters
    ----------
    config : Path
        The config.
    color_space : str
        The name of the space.
    is_changed : bool
        Whether anything differs from before, so that Blender has to be restarted.
    backup : Path or None
        The config that was there before ours.
    """

    config: Path
    color_space: str
    is_changed: bool
    backup: Path | None


def install(folder: Path, base: str, space: PlateColorSpace, lut: Lut1D) -> Installed:
    """Write a plate's LUT, and its colour space into the config of `folder`.

    A config that is there already gets the colour space added. Otherwise the new one is `base` with the colour space
    added, and the LUT folders of `base` are copied, so that the folder is complete in itself.

    Parameters
    ----------
    folder : Path
        The config's folder; made if need be.
    base : str
        The config to build on.
    space : PlateColorSpace
        The colour space; its LUT goes into a folder of our own.
    lut : Lut1D
        The inverse response.

    Raises
    ------
    ConfigError, PlateError, LutError
        If the folder cannot be written to, or OpenColorIO refuses the config; the config is then as it was.
    """
    check_folder(folder)
    config, lut_file = folder / CONFIG_NAME, folder / FOLDER / space.lut_file
    before = (_digest(config), _digest(lut_file))
    record = _record(folder)
    try:
        source = _loaded(str(config) if config.exists() else base)
        with (
            output_folder(folder / FOLDER),
            _copied_folders(source, folder, None if config.exists() else Path(base).parent) as copied,
            _removed_after_failure(lut_file),
        ):
            write_spi1d(lut_file, lut, overwrite=True)
            added = add_plate_color_space(source, replace(space, lut_file=f"{FOLDER}/{space.lut_file}"))
            backup = _backup(config, record)
            write_config(config, added, check={space.name: lut}, overwrite=True)
            folders = record.folders if record and not copied else copied
            _write_record(folder, Record(_digest(config), backup, folders))
    except OSError as problem:
        raise ConfigError(f"{folder}: cannot be written ({problem.strerror}); choose another folder") from problem
    is_changed = before != (_digest(config), _digest(lut_file))
    return Installed(config, space.name, is_changed, folder / backup if backup else None)


def restore(folder: Path) -> str:
    """Put back the config that was there before ours, or remove ours if there was none; return what was done.

    Raises
    ------
    ConfigError
        If nothing of ours is there, or the config was changed since by somebody else.
    """
    record, config = _record(folder), folder / CONFIG_NAME
    if record is None:
        raise ConfigError(f"{folder}: holds no config of this add-on; there is nothing to restore")
    if config.exists() and _digest(config) != record.sha256:
        raise ConfigError(f"{config}: was changed by another program since; edit or remove it yourself")
    try:
        if record.backup:
            (folder / record.backup).replace(config)
            (folder / FOLDER / RECORD_NAME).unlink()
            return f"{config} is again as it was; restart Blender"
        config.unlink(missing_ok=True)
        for name in (*record.folders, FOLDER):
            shutil.rmtree(folder / name, ignore_errors=True)
    except OSError as problem:
        raise ConfigError(f"{config}: cannot be restored ({problem.strerror}); check the folder") from problem
    return f"{config} is removed, so Blender uses its own again; restart Blender"


def _loaded(config: str) -> OCIO.Config:
    """Return a config from its file."""
    try:
        return OCIO.Config.CreateFromFile(config)
    except OCIO.Exception as problem:
        raise ConfigError(
            f"{config}: OpenColorIO refuses this config ({one_line(problem)}); mend it or choose a folder"
        ) from None


@contextmanager
def _copied_folders(config: OCIO.Config, folder: Path, home: Path | None) -> Iterator[tuple[str, ...]]:
    """Copy the LUT folders of a config from its home to a new one, for good if the block succeeds; yield their names.

    What cannot be copied along will be looked for where it is. None stands for a config that is at home in `folder`.
    """
    copied: list[str] = []
    try:
        names = [] if home is None else [name for name in config.getSearchPaths() if name != "."]
        if names:
            config.clearSearchPaths()
        for name in names:
            is_ours = Path(name).name == name and (home / name).is_dir() and not (folder / name).exists()
            config.addSearchPath(name if is_ours else str(home / name))
            if is_ours:
                copied.append(name)
                shutil.copytree(home / name, folder / name)
        yield tuple(copied)
    except BaseException:
        for name in copied:
            shutil.rmtree(folder / name, ignore_errors=True)
        raise


@contextmanager
def _removed_after_failure(path: Path) -> Iterator[None]:
    """Take away a file that was not there before, if the block fails."""
    was_there = path.exists()
    try:
        yield
    except BaseException:
        if not was_there:
            path.unlink(missing_ok=True)
        raise


def _backup(config: Path, record: Record | None) -> str | None:
    """Return the name under which the config before ours is kept, after keeping it if that is not done yet."""
    if not config.exists():
        return None
    if record is not None and _digest(config) == record.sha256:
        return record.backup
    names = ("config.before-camera-response.ocio", *(f"config.before-camera-response-{n}.ocio" for n in range(2, 1000)))
    name = next(name for name in names if not config.with_name(name).exists())
    shutil.copy2(config, config.with_name(name))
    return name


def _digest(path: Path) -> str:
    """Return a file's SHA-256, or nothing if there is none."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""


def _record(folder: Path) -> Record | None:
    """Return what was done in a folder, or None if nothing was or the record is damaged."""
    try:
        entries = json.loads((folder / FOLDER / RECORD_NAME).read_text(encoding="utf-8"))
        return Record(entries["sha256"], entries["backup"], tuple(entries["folders"]))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _write_record(folder: Path, record: Record) -> None:
    """Write down what was done."""
    text = json.dumps(asdict(record), indent=1) + "\n"
    atomic_write_text(folder / FOLDER / RECORD_NAME, text, overwrite=True, error=ConfigError)


def role_name(config: str, role: str) -> str:
    """Return the name of the space that has a role in a config.

    Raises
    ------
    ConfigError
        If none has, or the config does not load.
    """
    space = _loaded(config).getColorSpace(role)
    if space is None:
        raise ConfigError(f"{config}: has no role {role}; use another config")
    return str(space.getName())
