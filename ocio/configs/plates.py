"""The plates of a config."""

from __future__ import annotations

from dataclasses import dataclass

import PyOpenColorIO as OCIO

from .file_rules import FAMILY, plate_rules
from .files import plate_exposure
from .reference_space import steps_to_reference


@dataclass(frozen=True)
class PlateInConfig:
    """A plate's color space in a config: its name, its LUT as the config names it, and the stops added after the LUT.

    `rules` holds the color space that each of its file rules gives, by the rule's regular expression.
    """

    name: str
    lut_file: str
    exposure: float
    rules: dict[str, str]


def plates_in_config(config: OCIO.Config) -> list[PlateInConfig]:
    """Return the plates of a config, in its order."""
    spaces = [space for space in config.getColorSpaces() if space.getFamily() == FAMILY]
    return [_plate(config, space) for space in spaces]


def _plate(config: OCIO.Config, space: OCIO.ColorSpace) -> PlateInConfig:
    """Return the plate of a color space; its LUT comes first."""
    name, first = str(space.getName()), next(iter(steps_to_reference(space)), None)
    lut_file = str(first.getSrc()) if isinstance(first, OCIO.FileTransform) else ""
    return PlateInConfig(name, lut_file, plate_exposure(space), plate_rules(config, name))
