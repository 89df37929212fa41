"""A plate's colour space in the config that a program reads at its start, and the way back.

Beside the config lies a folder of our own, `FOLDER`, with the LUTs and a record. A config that does not match the
record was written by somebody else: it is copied to a backup before the colour space is added to it.
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import PyOpenColorIO as OCIO

from ..defaults import CONFIG_NAME
from ..errors import ConfigError
from ..luts.files import write_lut
from ..luts.lut1d import Lut1D
from ..output_files import check_config_folder, distinct_names, output_folder
from .files import load_config, loaded_or_empty, write_config
from .installation_record import (
    FOLDER,
    InstallationRecord,
    backed_up,
    check_is_ours,
    digest,
    files_in,
    read_record,
    record_file,
    remove_record,
    write_record,
)
from .lut_folders import copied_lut_folders
from .plate_color_space import (
    FAMILY,
    PlateColorSpace,
    add_plate_color_space,
    without_plate_color_space,
    without_plate_rules,
)
from .reference_space import lut_file_of
from .undo import as_before_on_failure


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
        Whether the config or the LUT differs from before, so that programs have to read it again.
    backup : Path or None
        The copy of the config that was there before ours.
    """

    config: Path
    color_space: str
    is_changed: bool
    backup: Path | None


@dataclass(frozen=True)
class Restored:
    """What has become of a config after our colour spaces were taken out.

    Parameters
    ----------
    config : Path
        The config.
    is_removed : bool
        Whether it is gone, as there was none before ours; otherwise the earlier one is back.
    """

    config: Path
    is_removed: bool


def install(
    folder: Path, base: str | Path, space: PlateColorSpace, lut: Lut1D, *, plate: str, hint: str = ""
) -> Installed:
    """Write a plate's LUT, and its colour space into the config of `folder`.

    The colour space is added to the config in the folder. If there is none, the new config is `base` with the colour
    space added, and the LUT folders of `base` are copied, so that the folder is complete in itself.

    The config gets no file rule, and loses those of earlier versions: it holds for every project of its user, and rules
    know a file by its name alone. The program has to choose the colour space for the plate itself.

    Parameters
    ----------
    folder : Path
        The config's folder; it is made if need be.
    base : str or Path
        The config to build on if the folder has none.
    space : PlateColorSpace
        The colour space; its LUT goes into `FOLDER`. If the config has a space of this name for another plate, the
        hint or a number is added to the name.
    lut : Lut1D
        The inverse response.
    plate : str
        What the plate is known by, such as its full path: only a colour space of the same plate is replaced.
    hint : str
        What tells the plate from others of its name, such as its folder.

    Raises
    ------
    ConfigError, PlateError, LutError
        If the folder cannot be written to, or OpenColorIO refuses the config, which is then as it was.
    """
    check_config_folder(folder)
    config = folder / CONFIG_NAME
    record = read_record(config)
    plates = dict(record.plates) if record else {}
    try:
        is_new = not config.exists()
        source = without_plate_rules(load_config(base if is_new else config))
        space = replace(space.renamed(free_name(source, space.name, plates, plate, hint)), file_pattern=None)
        lut_file = folder / FOLDER / space.lut_file
        before = (digest(config), digest(lut_file))
        with (
            output_folder(folder / FOLDER),
            copied_lut_folders(source, folder, Path(base).parent if is_new else None) as copied,
            as_before_on_failure([lut_file, config, record_file(config)]),
            backed_up(config, record) as backup,
        ):
            write_lut(lut_file, lut, overwrite=True)
            added = add_plate_color_space(source, replace(space, lut_file=f"{FOLDER}/{space.lut_file}"))
            write_config(config, added, check={space.name: lut}, overwrite=True)
            folders = record.folders if record and not copied else copied
            files = record.files if record and not copied else tuple(files_in(folder, copied))
            write_record(
                config, InstallationRecord(digest(config), backup, folders, {**plates, space.name: plate}, files)
            )
    except OSError as problem:
        raise ConfigError(f"{folder}: cannot be written ({problem.strerror}); choose another folder") from problem
    is_changed = before != (digest(config), digest(lut_file))
    return Installed(config, space.name, is_changed, folder / backup if backup else None)


def restore(folder: Path) -> Restored:
    """Put back the config that was there before ours, or remove ours if there was none.

    Raises
    ------
    ConfigError
        If nothing was installed there, somebody else has changed the config since, or the folder has to go and holds a
        file of somebody else: a program that finds the folder without a config runs without any.
    """
    config = folder / CONFIG_NAME
    record = read_record(config)
    if record is None and _remove_if_empty(folder):
        return Restored(config, is_removed=True)
    if record is None:
        raise ConfigError(f"{folder}: holds no config with an installed camera response; there is nothing to restore")
    if config.exists() and digest(config) != record.sha256:
        raise ConfigError(f"{config}: was changed by another program since; edit or remove it yourself")
    if not record.backup:
        check_is_ours(folder, record)
    try:
        if record.backup:
            _put_back(config, folder / record.backup)
        else:
            config.unlink(missing_ok=True)
            for name in (FOLDER, *record.folders):
                shutil.rmtree(folder / name, ignore_errors=True)
            _remove_if_empty(folder)
    except OSError as problem:
        raise ConfigError(f"{config}: cannot be restored ({problem.strerror}); check the folder") from problem
    return Restored(config, is_removed=not record.backup)


def _put_back(config: Path, backup: Path) -> None:
    """Put an earlier config back, without our colour spaces; then remove our record, and LUTs that it does not name."""
    replaced, earlier = map(loaded_or_empty, (config, backup))
    if ours := _installed_luts(earlier):
        for name in ours:
            earlier = without_plate_color_space(earlier, name)
        write_config(config, earlier, check={}, overwrite=True)
        backup.unlink()
    else:
        backup.replace(config)
    named = config.read_bytes()
    for lut in _installed_luts(replaced).values():
        if lut.encode() not in named:
            (config.parent / lut).unlink(missing_ok=True)
    remove_record(config)


def _installed_luts(config: OCIO.Config) -> dict[str, str]:
    """Return the LUT of each colour space of ours in a config, by its name, in its order."""
    return {space.getName(): lut for space in config.getColorSpaces() if (lut := _installed_lut(space))}


def installed_color_spaces(folder: Path) -> tuple[str, ...]:
    """Return the names of the colour spaces that were installed into the config of `folder`, in its order.

    They are those whose LUT lies in `FOLDER`. There are none if nothing was installed there.

    Raises
    ------
    ConfigError
        If OpenColorIO refuses the config.
    """
    config = folder / CONFIG_NAME
    if read_record(config) is None or not config.exists():
        return ()
    return tuple(_installed_luts(load_config(config)))


def missing_color_spaces(folder: Path, base: Path) -> tuple[str, ...]:
    """Return the colour spaces of a program's own config, `base`, that are missing in the config that replaces it.

    There are some after the program has been updated: the config in `folder` was built on that of its earlier
    version. There are none if nothing was installed there, or the folder had a config of somebody else's before.

    Raises
    ------
    ConfigError
        If OpenColorIO refuses one of the configs.
    """
    config = folder / CONFIG_NAME
    record = read_record(config)
    if record is None or record.backup or not config.exists():
        return ()
    wanted, there = ([space.getName() for space in load_config(file).getColorSpaces()] for file in (base, config))
    return tuple(name for name in wanted if name not in there)


def uninstall(folder: Path, name: str) -> None:
    """Take an installed colour space, its file rules and its LUT out of the config of `folder`.

    After the last one has been taken out, the config is as before the first: see `restore`.

    Raises
    ------
    ConfigError
        If no such colour space was installed there, somebody else has changed the config since, or it cannot be
        written.
    """
    config = folder / CONFIG_NAME
    record = read_record(config)
    names = installed_color_spaces(folder)
    if record is None or name not in names:
        raise ConfigError(f"{config}: has no installed colour space {name!r}; check the name")
    if digest(config) != record.sha256:
        raise ConfigError(f"{config}: was changed by another program since; edit it yourself")
    if names == (name,):
        restore(folder)
        return
    loaded = load_config(config)
    lut_file = _installed_lut(loaded.getColorSpace(name))
    plates = {space: plate for space, plate in record.plates.items() if space != name}
    try:
        with as_before_on_failure([config, record_file(config)]):
            write_config(config, without_plate_color_space(loaded, name), check={}, overwrite=True)
            write_record(config, replace(record, sha256=digest(config), plates=plates))
        (folder / lut_file).unlink(missing_ok=True)
    except OSError as problem:
        raise ConfigError(f"{folder}: cannot be changed ({problem.strerror}); check the folder") from problem


def _installed_lut(space: OCIO.ColorSpace) -> str:
    """Return the LUT file of a colour space that was installed, relative to the config; else an empty text."""
    file = lut_file_of(space)
    return file if space.getFamily() == FAMILY and file.startswith(f"{FOLDER}/") else ""


def free_name(config: OCIO.Config, name: str, plates: Mapping[str, str], plate: str, hint: str) -> str:
    """Return a name for a plate's colour space that the config does not use for another plate."""

    def is_free(candidate: str) -> bool:
        found = config.getColorSpace(candidate)
        return found is None or found.getFamily() != FAMILY or plates.get(found.getName()) == plate

    return next(filter(is_free, distinct_names(name, hint)))


def _remove_if_empty(folder: Path) -> bool:
    """Remove a folder if it is empty, and return whether it was.

    Blender takes an empty folder for the user's, finds no config in it, and runs without AgX.
    """
    try:
        folder.rmdir()
    except OSError:
        return False
    return True
