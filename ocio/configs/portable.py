"""A small config for plates, which every host from OpenColorIO 2.0 on can load."""

from collections.abc import Sequence
from importlib.resources import files

import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import ADOBE_RGB, DISPLAY_P3, PROPHOTO, REC709, REC2020, Primaries, conversion_matrix

from .plate_color_space import CATEGORIES, PlateColorSpace, add_plate_color_spaces
from .plate_views import add_plate_views
from .reference_space import LINEAR_NAMES, REC709_TO_AP0, matrix_transform

#: The primaries of linear plates whose spaces the packaged config does not have.
ADDED_PRIMARIES = (DISPLAY_P3, REC2020, ADOBE_RGB, PROPHOTO)

#: The most plates whose views are in the config: more would bury the others in the menus.
MOST_PLATES_WITH_VIEWS = 16


def portable_config(spaces: Sequence[PlateColorSpace]) -> OCIO.Config:
    """Return a config of profile 2.0 with plates' color spaces, for every host from OpenColorIO 2.0 on.

    Its reference and scene-linear space is linear Rec.709 with a D65 white; its color spaces have Blender's names, so
    that Blender's files find them. Raise a ConfigError if two spaces share a name, or one takes a name of the config.
    """
    template = files("crfnet.configs").joinpath("portable.ocio").read_text(encoding="utf-8")
    matrix = ", ".join(str([*row, 0])[1:-1] for row in REC709_TO_AP0)
    config = OCIO.Config.CreateFromStream(template.replace("REC709_TO_AP0", f"[{matrix}, 0, 0, 0, 1]"))
    for primaries in ADDED_PRIMARIES:
        config.addColorSpace(_linear_space(primaries))
    add_plate_color_spaces(config, spaces)
    if not 0 < len(spaces) <= MOST_PLATES_WITH_VIEWS:
        return config
    return add_plate_views(config, [space.name for space in spaces])


def _linear_space(primaries: Primaries) -> OCIO.ColorSpace:
    """Return the linear space of some primaries, by its name in Blender; the reference space is linear Rec.709."""
    *aliases, name = LINEAR_NAMES[primaries]
    return OCIO.ColorSpace(
        name=name,
        aliases=aliases,
        family="Scene-linear",
        encoding="scene-linear",
        categories=CATEGORIES,
        description=f"Scene-linear light, {primaries.name} primaries.",
        bitDepth=OCIO.BIT_DEPTH_F32,
        toReference=matrix_transform(conversion_matrix(primaries, REC709)),
    )
