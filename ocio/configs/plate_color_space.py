"""A plate's colour space, as plain data (`PlateColorSpace`) and as a part of any OpenColorIO config."""

from __future__ import annotations

import copy
import re
from dataclasses import dataclass, replace
from pathlib import PurePosixPath, PureWindowsPath

import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import REC709, Primaries, conversion_matrix
from crfnet_core.errors import one_line

from ..errors import ConfigError
from .file_rules import LINEAR_SUFFIX, add_file_rule, remove_file_rules
from .plate_views import add_plate_views, plate_views, remove_plate_views
from .reference_space import linear_space_name, matrix_transform, rec709_to_reference

#: The family of every plate's colour space, by which an earlier version of it is recognised.
FAMILY = "Camera Response"


@dataclass(frozen=True)
class PlateColorSpace:
    """The colour space of a plate: its camera's inverse response, an exposure, and its primaries.

    Parameters
    ----------
    name : str
        The name in menus, for example "CRF plate01".
    lut_file : str
        The LUT from brightness to irradiance; its name is relative to the config's folder.
    aliases : tuple of str
        Other names of the space. A config gets those that it does not use already.
    description : str
        What the response was estimated from.
    encoding : str
        OpenColorIO's name of the encoding.
    file_pattern : str or None
        The names of the plate's files with `*`, `?` and `#` for a number, for example "shot_plate01.#.png", for a file
        rule: see `crfnet.configs.file_rules.rule_regex`.
    exposure : float
        Stops added after the response. They stand in the config as a transform of their own, to be edited there.
    primaries : Primaries
        In which the plate is encoded.
    linear_patterns : tuple of str
        The names of the plate's linear OpenEXR files, for a file rule of their own.
    linear_primaries : Primaries or None
        In which those are. None if they are not known: then there is no rule. Nor is there one for linear Rec.709, or
        in a config without a space for them.

    Raises
    ------
    ConfigError
        If the name is empty, the exposure is not finite, the LUT lies outside the config's folder, or its name holds
        a character that OpenColorIO interprets as a variable.
    """

    name: str
    lut_file: str
    aliases: tuple[str, ...] = ()
    description: str = ""
    encoding: str = "sdr-video"
    file_pattern: str | None = None
    exposure: float = 0.0
    primaries: Primaries = REC709
    linear_patterns: tuple[str, ...] = ()
    linear_primaries: Primaries | None = None

    def __post_init__(self) -> None:
        lut_file = PureWindowsPath(self.lut_file)
        if not self.name.strip():
            raise ConfigError("a colour space needs a name, found an empty one")
        if not np.isfinite(self.exposure):
            raise ConfigError(f"{self.name}: the exposure must be a number of stops, found {self.exposure}")
        if not lut_file.name or lut_file.anchor or ".." in lut_file.parts:
            message = f"{self.lut_file!r} is no name within the config's folder; put the LUT beside the config"
            raise ConfigError(f"{self.name}: {message}")
        if set(self.lut_file) & set("$%"):
            raise ConfigError(f"{self.name}: OpenColorIO takes $ and % in {self.lut_file!r} for variables; rename it")

    def renamed(self, name: str) -> PlateColorSpace:
        """Return the same colour space under another name, which its aliases and its LUT file follow.

        The name has to begin with the present one: what comes after it is appended to the aliases and the LUT file.
        """
        if not name.startswith(self.name):
            raise ConfigError(f"{name}: does not begin with {self.name!r}; choose a name that does")
        added, lut_file = name[len(self.name) :], PurePosixPath(self.lut_file)
        plain = re.sub(r"\W+", "_", added).rstrip("_").lower()
        return replace(
            self,
            name=name,
            lut_file=str(lut_file.with_name(f"{lut_file.stem}{added}{lut_file.suffix}")),
            aliases=tuple(alias + plain for alias in self.aliases),
        )


def without_plate_rules(config: OCIO.Config) -> OCIO.Config:
    """Return a copy of `config` without the file rules that lead to a plate's colour space.

    A rule knows a file by its name alone, so in a config that many projects share it would also catch files of other
    cameras.
    """
    config = copy.deepcopy(config)
    if config.getMajorVersion() < 2:
        return config
    rules = config.getFileRules()
    for index in reversed(range(rules.getNumEntries() - 1)):  # the last one is the default, which cannot be removed
        space = config.getColorSpace(rules.getColorSpace(index))
        if space is not None and space.getFamily() == FAMILY:
            rules.removeRule(index)
    config.setFileRules(rules)
    return config


def add_plate_color_space(config: OCIO.Config, *spaces: PlateColorSpace) -> OCIO.Config:
    """Return a copy of `config` with plates' colour spaces, and with their file rules before all other rules.

    The profile version and everything else stay. After the response and the exposure, the plate is converted from its
    primaries to linear Rec.709, and from there to the config's reference space as the config's own linear Rec.709 space
    says, or else through its `aces_interchange` role. Profile version 1 has neither aliases nor file rules: they are
    left out there, and so is an exposure of 0.

    Parameters
    ----------
    config : PyOpenColorIO.Config
        Any config; it is not changed.
    *spaces : PlateColorSpace
        The plates' colour spaces. Each replaces an earlier one of the same name in the family `FAMILY`, whose views are
        renewed.

    Raises
    ------
    ConfigError
        If the config uses the name for something else, or cannot convert linear Rec.709 to its reference space.
    """
    viewed = [space.name for space in spaces if plate_views(config, space.name)]
    config = copy.deepcopy(config)
    for space in spaces:
        _add(config, space)
    folders = [folder for folder in config.getSearchPaths() if folder not in ("", ".")]
    config.clearSearchPaths()
    for folder in (*folders, "."):
        config.addSearchPath(folder)
    return add_plate_views(config, viewed) if viewed else config


def _add(config: OCIO.Config, space: PlateColorSpace) -> None:
    """Add a plate's colour space and its file rule to a config, in place."""
    modern = config.getMajorVersion() >= 2
    _remove_earlier(config, space)
    try:
        color_space = OCIO.ColorSpace(
            name=space.name,
            aliases=[alias for alias in space.aliases if modern and config.getColorSpace(alias) is None],
            family=FAMILY,
            encoding=space.encoding,
            description=space.description,
            bitDepth=OCIO.BIT_DEPTH_F32,
            toReference=_to_reference(config, space),
        )
        config.addColorSpace(color_space)
        linear = space.linear_primaries
        if linear and linear != REC709 and (name := linear_space_name(config, linear)):
            add_file_rule(config, space.name + LINEAR_SUFFIX, name, space.linear_patterns)
        add_file_rule(config, space.name, space.name, [space.file_pattern] if space.file_pattern else ())
    except OCIO.Exception as problem:
        raise ConfigError(f"{space.name}: cannot be added to the config ({one_line(problem)})") from problem


def without_plate_color_space(config: OCIO.Config, name: str) -> OCIO.Config:
    """Return a copy of `config` without a plate's colour space, its file rules and its views; all else stays."""
    config = copy.deepcopy(config)
    _remove(config, name)
    return config


def _remove_earlier(config: OCIO.Config, space: PlateColorSpace) -> None:
    """Remove an earlier version of a plate's space and its rule; raise a ConfigError if the name is used otherwise."""
    earlier = config.getColorSpace(space.name)
    if earlier is None:
        return
    if earlier.getFamily() != FAMILY or earlier.getName().casefold() != space.name.casefold():
        raise ConfigError(f"{space.name}: the config uses this name for {earlier.getName()!r}; choose another name")
    _remove(config, earlier.getName())


def _remove(config: OCIO.Config, name: str) -> None:
    """Remove a colour space of a config, its file rules and its views."""
    config.removeColorSpace(name)
    remove_file_rules(config, (name, name + LINEAR_SUFFIX))
    remove_plate_views(config, [name])


def _to_reference(config: OCIO.Config, space: PlateColorSpace) -> OCIO.Transform:
    """Return the LUT, the exposure, and the matrices from the plate's primaries to the reference space."""
    file_name = space.lut_file.replace("\\", "/")
    steps: list[OCIO.Transform] = [OCIO.FileTransform(src=file_name, interpolation=OCIO.INTERP_LINEAR)]
    if space.exposure or config.getMajorVersion() >= 2:  # profile version 1 does not know this transform
        steps.append(OCIO.ExposureContrastTransform(OCIO.EXPOSURE_CONTRAST_LINEAR, exposure=space.exposure))
    if space.primaries != REC709:
        steps.append(matrix_transform(conversion_matrix(space.primaries, REC709)))
    return OCIO.GroupTransform([*steps, *rec709_to_reference(config)])
