"""The plates of a config, what a change made of it, and whether it can be changed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import PyOpenColorIO as OCIO

from ...errors import ConfigError
from ...output_files import check_config_folder
from ..file_rules import LINEAR_SUFFIX, file_rules
from ..files import plate_exposure
from ..plate_color_space import FAMILY
from ..plate_views import plate_views
from ..reference_space import lut_file_of
from .sources import ConfigSource


@dataclass(frozen=True)
class PlateInConfig:
    """A plate's colour space in a config.

    Parameters
    ----------
    name : str
        The name of the space.
    lut_file : str
        Its LUT, as the config names it.
    exposure : float
        Stops added after the LUT.
    rules : dict of str to str
        The colour space that each of its file rules gives, by the rule's regular expression.
    views : tuple of str
        Its views.
    """

    name: str
    lut_file: str
    exposure: float
    rules: dict[str, str]
    views: tuple[str, ...]


@dataclass(frozen=True)
class Changed:
    """What has become of a config.

    Parameters
    ----------
    config : Path
        The config.
    plates : tuple of PlateInConfig
        The plates that were put in or taken out.
    is_changed : bool
        Whether a file differs from before.
    backup : Path or None
        The copy of the config that was there before ours.
    notes : tuple of str
        What the user should know, such as names that got no rule.
    """

    config: Path
    plates: tuple[PlateInConfig, ...]
    is_changed: bool
    backup: Path | None
    notes: tuple[str, ...] = ()


def plates_in_config(config: OCIO.Config) -> list[PlateInConfig]:
    """Return the plates of a config, in its order."""
    spaces = [space for space in config.getColorSpaces() if space.getFamily() == FAMILY]
    return [plate_in_config(config, space) for space in spaces]


def plate_in_config(config: OCIO.Config, space: OCIO.ColorSpace) -> PlateInConfig:
    """Return what a config has of a plate."""
    name = space.getName()
    rules = file_rules(config, (name, name + LINEAR_SUFFIX))
    return PlateInConfig(name, lut_file_of(space), plate_exposure(space), rules, plate_views(config, name))


def checked_target(source: ConfigSource, target: Path | None) -> Path:
    """Return the file to be written, after checking that it can be."""
    if target is None and source.path is None:
        raise ConfigError(f"{source.name}: is built into OpenColorIO and cannot be changed; add --out FILE.ocio")
    path = source.path if target is None or target.resolve() == source.path else target.resolve()
    assert path is not None
    if path == source.path and not (os.access(path, os.W_OK) and os.access(path.parent, os.W_OK)):
        raise ConfigError(f"{path}: is read-only; add --out FILE.ocio")
    if path.is_dir():
        raise ConfigError(f"{path}: is a folder; name a file")
    check_config_folder(path.parent)
    return path
