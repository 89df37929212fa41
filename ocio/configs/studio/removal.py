"""Take plates out of a config."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import PyOpenColorIO as OCIO

from ...errors import ConfigError
from ..files import loaded_or_empty, write_config
from ..installation_record import (
    InstallationRecord,
    backed_up,
    digest,
    own_folder,
    read_record,
    record_file,
    remove_record,
    write_record,
)
from ..plate_color_space import without_plate_color_space
from ..undo import as_before_on_failure
from .plates import Changed, PlateInConfig, checked_target, plates_in_config
from .sources import ConfigSource, is_blender_config


def remove_plates(source: ConfigSource, names: Sequence[str]) -> Changed:
    """Take plates' colour spaces, their rules, views and LUTs out of a config.

    After the last one, a config that nobody else has changed since is put back from its backup, byte for byte.

    Raises
    ------
    ConfigError
        If the config has no such plate, or cannot be changed.
    """
    target = checked_target(source, None)
    record, config, plates = read_record(target), source.config, []
    known = {plate.name.casefold(): plate for plate in plates_in_config(config)}
    for name in names:
        plate = known.get(name.casefold())
        if plate is None:
            listed = ", ".join(each.name for each in known.values()) or "none"
            raise ConfigError(f"{target}: has no plate {name!r}; its plates are: {listed}")
        config = without_plate_color_space(config, plate.name)
        plates.append(plate)
    try:
        backup = _write_less(target, config, plates, record)
    except OSError as problem:
        raise ConfigError(f"{target}: cannot be changed ({problem.strerror}); check the folder") from problem
    return Changed(target, tuple(plates), True, target.with_name(backup) if backup else None)


def _write_less(
    target: Path, config: OCIO.Config, plates: Sequence[PlateInConfig], record: InstallationRecord | None
) -> str | None:
    """Write a config after plates were taken out, or put its backup back; return the backup's name if one remains."""
    folder, kept = own_folder(target), plates_in_config(config)
    earlier = record.backup if record and digest(target) == record.sha256 and not kept else None
    if earlier is not None and _is_without_plates(target.with_name(earlier)):
        target.with_name(earlier).replace(target)
        backup, is_recorded = None, False
    else:
        is_ours = bool(kept) or is_blender_config(target)
        backup, is_recorded = _write_config(target, config, plates, record, is_ours=is_ours)
    unused = {plate.lut_file for plate in plates} - {plate.lut_file for plate in kept}
    for lut_file in unused:
        if lut_file.startswith(f"{folder.name}/"):
            (target.parent / lut_file).unlink(missing_ok=True)
    if not is_recorded:
        remove_record(target)
    return backup


def _write_config(
    target: Path,
    config: OCIO.Config,
    plates: Sequence[PlateInConfig],
    record: InstallationRecord | None,
    *,
    is_ours: bool,
) -> tuple[str | None, bool]:
    """Write a config without plates; return the backup's name, and whether there is a record: ours and backups have."""
    with as_before_on_failure([target, record_file(target)]), backed_up(target, record) as backup:
        write_config(target, config, check={}, overwrite=True)
        is_recorded = is_ours or backup is not None
        if is_recorded:
            names = {plate.name for plate in plates}
            identities = {name: plate for name, plate in (record.plates if record else {}).items() if name not in names}
            own_folder(target).mkdir(exist_ok=True)
            folders = record.folders if record else ()
            write_record(target, InstallationRecord(digest(target), backup, folders, identities))
    return backup, is_recorded


def _is_without_plates(backup: Path) -> bool:
    """Return whether a backup is there and has no plates: one of a config that was ours, and was changed, has some."""
    return backup.is_file() and not plates_in_config(loaded_or_empty(backup))
