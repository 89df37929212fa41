"""A new config: another one, a studio's, a built-in or Blender's, with plates added.

Everything else of the base stays: its profile version, roles, displays, views, looks and rules. Its files are found
where they lie: the search path of the new config names the folders of the base in full. The LUTs of the new plates lie
next to the new config. Nothing of the base is changed, nothing is deleted.
"""

import copy
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import PyOpenColorIO as OCIO

from crfnet_core.locks import locked_folder

from ..defaults import CONFIG_NAME
from ..errors import ConfigError
from ..luts.files import write_lut
from ..luts.lut1d import Lut1D
from ..luts.rgb_lut import lut_identity
from ..output_files import all_or_none, check_targets, distinct_names, folded
from .file_rules import plate_of_rule
from .files import write_config
from .looks import Look
from .plate_color_space import PlateColorSpace, PlateInConfig, add_plate_color_spaces, lost_plates, plates_in_config
from .sources import ConfigSource


@dataclass(frozen=True)
class DerivedConfig:
    """A config that was written with plates added: its path, all files written, and the plates.

    `without_rule` holds the file names, or patterns, to which rules give no space of their own: many cameras give such
    a name, or several plates have it, or the base has no space for it. `dropped` holds the plates of an
    earlier config of this path that are not in it.
    """

    path: Path
    files: tuple[Path, ...]
    plates: tuple[PlateInConfig, ...]
    without_rule: tuple[str, ...]
    dropped: tuple[str, ...]


def write_derived_config(
    base: ConfigSource,
    folder: Path,
    looks: Sequence[Look],
    *,
    others: Mapping[str, Lut1D] | None = None,
    overwrite: bool = False,
) -> DerivedConfig:
    """Write `CONFIG_NAME` and LUTs to `folder`, which is not the base's: a base with plates' color spaces and rules.

    A plate whose name the base has already gets the name of its folder, too: "CRF plate01 (s020)". `others` are further
    LUT files, by their names. Raise a CRFNetError, and leave the folder as it was, if a file exists and may not be
    replaced or cannot be written, or OpenColorIO refuses the config or converts otherwise than the LUTs.
    """
    homes = [path.parent for path in (base.path, base.path and base.path.resolve()) if path]
    if folder.is_dir() and any(map(folder.samefile, homes)):
        raise ConfigError("base_would_change", path=folder)
    config, target = _relocated(base), folder / CONFIG_NAME
    spaces = list[PlateColorSpace]()
    for look in looks:
        spaces.append(_free_space(base, look, spaces, others or {}))
    without = add_plate_color_spaces(config, spaces, has_counters=False)
    check = {space.name: look.lut for space, look in zip(spaces, looks, strict=True)}
    luts = {**(others or {}), **{space.lut_file: check[space.name] for space in spaces}}
    files = (target, *(folder / name for name in luts))
    check_targets(folder, files[1:], configs=[target], overwrite=overwrite)
    plates = plates_in_config(config)
    with ExitStack() as until_named, all_or_none(files, overwrite=overwrite) as staged:
        for name, lut in luts.items():
            write_lut(staged / name, lut)
        try:
            write_config(staged / CONFIG_NAME, config, check=check)
        except ConfigError:
            _check_valid(base)
            raise
        until_named.enter_context(locked_folder(folder))
        dropped = lost_plates(target, [plate.name for plate in plates])
    new = tuple(plate for plate in plates if plate.name in check)
    return DerivedConfig(target, files, new, without, tuple(dropped))


def _check_valid(base: ConfigSource) -> None:
    """Raise a ConfigError if OpenColorIO finds the base itself not valid."""
    try:
        base.config.validate()
    except OCIO.Exception as problem:
        raise ConfigError("config_refused", path=base.name, reason=problem) from problem


def _free_space(
    base: ConfigSource, look: Look, spaces: Sequence[PlateColorSpace], others: Collection[str]
) -> PlateColorSpace:
    """Return a plate's color space under a name, and with a LUT file, that neither the base nor `spaces` have."""
    file, config = Path(look.space.lut_file), base.config
    if base.path:  # its folders come first, and may get a file of any name later: none of this name has another table
        file = file.with_stem(f"{file.stem} ({lut_identity(look.lut)[-8:]})")
    taken = {folded(name) for name in (*(space.name for space in spaces), *_other_names(config))}
    aliases = tuple(alias for alias in look.space.aliases if folded(alias) not in taken)
    used = {folded(name) for name in (*others, *(space.lut_file for space in spaces))}
    stems = (f"{stem}{file.suffix}" for stem in distinct_names(file.stem, look.folder))
    lut_file = next(name for name in stems if folded(name) not in used)
    free = (name for name in distinct_names(look.space.name, look.folder) if folded(name) not in taken)
    name = next(name for name in free if config.getColorSpace(name) is None)
    return replace(look.space, name=name, lut_file=lut_file, aliases=aliases)


def _other_names(config: OCIO.Config) -> Iterator[str]:
    """Yield the names that a color space may not have besides the names of color spaces and roles."""
    yield from map(str.strip, config.getInactiveColorSpaces().split(","))
    for name in config.getNamedTransformNames(OCIO.NAMEDTRANSFORM_ALL):
        yield from (name, *config.getNamedTransform(name).getAliases())
    rules = config.getFileRules()
    yield from (plate_of_rule(rules.getName(index)) for index in range(rules.getNumEntries()))


def _relocated(base: ConfigSource) -> OCIO.Config:
    """Return a copy of a config that finds the files of its base, and then those of its new folder."""
    config = copy.deepcopy(base.config)
    config.setEnvironmentMode(base.config.getEnvironmentMode())  # which a copy has lost
    folders = [folder for folder in config.getSearchPaths() if folder] or ["."]
    config.clearSearchPaths()
    if base.path is not None:
        home = base.path.parent
        is_split = ":" in str(home) and config.getMajorVersion() < 2
        if is_split or "$" in str(home) or str(home).count("%") > 1:
            raise ConfigError("base_folder_is_misread", path=home)
        for folder in folders:
            config.addSearchPath(str(home / folder))
            if folder.startswith(("$", "%")):  # a variable, whose value may be an absolute path
                config.addSearchPath(folder)
    config.addSearchPath(".")
    return config
