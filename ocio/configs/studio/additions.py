"""Put plates into a config: their colour spaces, rules and views.

Everything else of the config stays: its profile version, roles, displays, views, looks, rules and search paths. Beside
it lie a folder of our own with the LUTs and a record (`crfnet.configs.installation_record`), and a backup.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import PyOpenColorIO as OCIO

from ...errors import ConfigError
from ...luts.files import read_lut, write_lut
from ...luts.lut1d import Lut1D
from ...output_files import output_folder
from ..file_rules import LINEAR_SUFFIX, add_file_rule
from ..files import write_config
from ..installation_record import (
    InstallationRecord,
    backed_up,
    digest,
    own_folder,
    read_record,
    record_file,
    write_record,
)
from ..installed import free_name
from ..plate_color_space import PlateColorSpace, add_plate_color_space
from ..plate_views import add_plate_views, plate_views, view_names
from ..undo import as_before_on_failure
from .aces_check import check_in_ap0
from .looks import Look
from .plates import Changed, checked_target, plate_in_config, plates_in_config
from .rules import PlateRules
from .sources import ConfigSource, is_blender_config


@dataclass(frozen=True, kw_only=True)
class AdditionOptions:
    """How plates are put into a config.

    Parameters
    ----------
    patterns : tuple of str
        The names of a plate's files (`crfnet.configs.file_rules.rule_regex`); none for those of its photographs.
    linear_patterns : tuple of str
        The names of its linear files; none for those that `crfnet estimate` has written.
    has_rules : bool
        Whether the plates get file rules. Without patterns, a config of Blender's gets none: it holds for every
        project.
    has_views : bool
        Whether the plates get views (`crfnet.configs.plate_views`). Views that are there stay.
    overwrite : bool
        Whether another config may be replaced.
    """

    patterns: tuple[str, ...] = ()
    linear_patterns: tuple[str, ...] = ()
    has_rules: bool = True
    has_views: bool = False
    overwrite: bool = False


def add_looks(source: ConfigSource, target: Path | None, looks: Sequence[Look], options: AdditionOptions) -> Changed:
    """Write a config with plates' colour spaces, and their LUTs beside it; the same again changes no byte.

    Parameters
    ----------
    source : ConfigSource
        The config to build on.
    target : Path or None
        The file to be written; None for the source itself.
    looks : sequence of Look
        The plates. One that is in the config already is replaced; one of the same name, but of another folder, gets the
        folder's name.
    options : AdditionOptions
        Rules, views, and whether another file may be replaced.

    Raises
    ------
    ConfigError, PlateError, LutError
        If the source cannot be changed, the target is another config that may not be replaced, or OpenColorIO refuses
        the result or converts otherwise than the LUTs, which is checked in ACES2065-1, too. Nothing changes then.
    """
    target = checked_target(source, target)
    record = read_record(source.path) if source.path else None
    identities = dict(record.plates) if record else {}
    config, notes, added = _moved(source, target), list[str](), dict[str, Look]()
    is_shared = is_blender_config(source.path) or is_blender_config(target)
    for look in looks:
        space = own_space(config, look, target, identities)
        config, more = _with_look(config, look, space, options, is_shared=is_shared)
        identities[space.name], added[space.name] = str(look.source), look
        notes += [note for note in more if note not in notes]
    plates = tuple(plate for plate in plates_in_config(config) if plate.name in added)
    files = {target.parent / plate.lut_file: added[plate.name].lut for plate in plates}
    if _is_same(target, config.serialize(), files):
        return Changed(target, plates, False, None, tuple(notes))
    if target != source.path and target.exists() and not options.overwrite:
        raise ConfigError(f"{target}: exists and differs; to add to it, name it as --base, or replace it: --overwrite")
    backup, more = _write(target, config, added, files, identities)
    return Changed(target, plates, True, target.with_name(backup) if backup else None, (*notes, *more))


def _moved(source: ConfigSource, target: Path) -> OCIO.Config:
    """Return a copy of a config that finds its files from the target's folder."""
    config = OCIO.Config.CreateFromStream(source.config.serialize())
    if source.path is None or source.path.parent == target.parent:
        return config
    folders = [folder for folder in config.getSearchPaths() if folder] or [""]
    config.clearSearchPaths()
    for folder in folders:
        config.addSearchPath(folder if folder.startswith(("$", "%")) else str((source.path.parent / folder).resolve()))
    return config


def own_space(config: OCIO.Config, look: Look, target: Path, identities: dict[str, str]) -> PlateColorSpace:
    """Return a look's colour space under a name that is free or its own, with its LUT in our folder."""
    name = free_name(config, look.space.name, identities, str(look.source), look.source.parent.name)
    space = look.space.renamed(name)
    return replace(space, lut_file=f"{own_folder(target).name}/{space.lut_file}", file_pattern=None)


def _with_look(
    config: OCIO.Config, look: Look, space: PlateColorSpace, options: AdditionOptions, *, is_shared: bool
) -> tuple[OCIO.Config, list[str]]:
    """Return a config with a plate's space, rules and views, and notes; the same config if it has all of it."""
    added = add_plate_color_space(config, space)
    has_rules = options.has_rules and not (is_shared and not options.patterns + options.linear_patterns)
    rules = PlateRules.of(added, look, options.patterns, options.linear_patterns, is_shared=is_shared)
    add_file_rule(added, space.name + LINEAR_SUFFIX, rules.linear_space, rules.linear if has_rules else ())
    add_file_rule(added, space.name, space.name, rules.encoded if has_rules else ())
    if options.has_views and not plate_views(added, space.name):
        added = add_plate_views(added, [space.name])
    is_same = _state(added, space.name) == _state(config, space.name)
    return (config if is_same else added), list(rules.notes) if options.has_rules else []


def _state(config: OCIO.Config, name: str) -> tuple[object, ...]:
    """Return all that a config has of a plate, whatever its place in the lists."""
    space = config.getColorSpace(name)
    transforms = [str(config.getViewTransform(view)) for view in view_names(name)]
    return str(space), space and plate_in_config(config, space), transforms, set(config.getSearchPaths())


def _is_same(target: Path, text: str, files: dict[Path, Lut1D]) -> bool:
    """Return whether the config and the LUTs are there already."""
    return (
        target.is_file()
        and target.read_bytes() == text.encode()
        and all(path.is_file() and read_lut(path) == lut for path, lut in files.items())
    )


def _write(
    target: Path,
    config: OCIO.Config,
    added: dict[str, Look],
    files: dict[Path, Lut1D],
    identities: dict[str, str],
) -> tuple[str | None, list[str]]:
    """Write the LUTs, check the config, and write it, its backup and its record; return the backup's name and notes."""
    record = read_record(target)
    try:
        with (
            output_folder(own_folder(target)),
            as_before_on_failure([*files, target, record_file(target)]),
            backed_up(target, record) as backup,
        ):
            for path, lut in files.items():
                write_lut(path, lut, overwrite=True)
            notes = check_in_ap0(config, target.parent, added)
            write_config(target, config, check={name: look.lut for name, look in added.items()}, overwrite=True)
            folders = record.folders if record else ()
            write_record(target, InstallationRecord(digest(target), backup, folders, identities))
    except OSError as problem:
        raise ConfigError(f"{target}: cannot be written ({problem.strerror}); choose another place") from problem
    return backup, notes
