"""A small config of our own for plates, which every host from OpenColorIO 2.0 on can load."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from importlib.resources import files

import PyOpenColorIO as OCIO

from crfnet_core.errors import ConfigError
from ocio.configs.plate_color_space import REC709_TO_AP0, PlateColorSpace, add_plate_color_space

#: The packaged config without plates; in it, `MATRIX` stands for the matrix `REC709_TO_AP0`.
TEMPLATE, MATRIX = "portable.ocio", "REC709_TO_AP0"


def portable_config(spaces: Sequence[PlateColorSpace]) -> OCIO.Config:
    """Return a config of profile 2.0 with `spaces`, for every host from OpenColorIO 2.0 on.

    Its reference and scene-linear space is linear Rec.709 with a D65 white. Its colour spaces have the names that
    Blender uses, so that Blender's files find them.

    Parameters
    ----------
    spaces : sequence of PlateColorSpace
        The plates' colour spaces, of different names.

    Raises
    ------
    ConfigError
        If two spaces share a name or an alias, or one takes a name of the config.
    """
    config = OCIO.Config.CreateFromStream(_template())
    names = Counter(space.name.casefold() for space in spaces)
    for space in spaces:
        if names[space.name.casefold()] > 1:
            raise ConfigError(f"{space.name}: two plates have this name; rename one")
    return add_plate_color_space(config, *spaces)


def _template() -> str:
    """Return the text of the packaged config, its matrix filled in as 4 x 4 numbers."""
    rows = [str([*row, 0])[1:-1] for row in REC709_TO_AP0]
    text = files("ocio.configs").joinpath(TEMPLATE).read_text(encoding="utf-8")
    return text.replace(MATRIX, f"[{', '.join(rows)}, 0, 0, 0, 1]")
