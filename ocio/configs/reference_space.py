"""The linear spaces of any config by their primaries, and from linear Rec.709 to its scene reference space."""

import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import ADOBE_RGB, AP0, AP1, DISPLAY_P3, PROPHOTO, REC709, REC2020, Primaries
from crfnet_core.types import Float64Array

from ..errors import ConfigError

#: Names and aliases of linear Rec.709 in common configs, the most specific first.
LINEAR_REC709 = (
    *("lin_rec709_scene", "lin_rec709_srgb", "lin_rec709", "lin_srgb", "Linear Rec.709 (sRGB)", "Linear Rec.709"),
    *("Utility - Linear - Rec.709", "Utility - Linear - sRGB"),
)

#: Primaries -> names, aliases and roles of the linear space with them in common configs: the Color Interop Forum's name
#: first, where there is one, and Blender's last.
LINEAR_NAMES: dict[Primaries, tuple[str, ...]] = {
    REC709: LINEAR_REC709,
    AP0: ("lin_ap0_scene", "aces_interchange", "ACES2065-1"),
    AP1: ("lin_ap1_scene", "lin_ap1", "acescg", "ACEScg"),
    DISPLAY_P3: ("lin_p3d65_scene", "lin_p3d65", "Linear P3-D65", "Linear DCI-P3 D65"),
    REC2020: ("lin_rec2020_scene", "lin_rec2020", "Linear Rec.2020"),
    ADOBE_RGB: ("lin_adobergb_scene", "lin_adobergb", "Linear AdobeRGB"),
    PROPHOTO: ("lin_prophoto", "Linear ProPhoto RGB"),
}

#: Linear Rec.709 to ACES2065-1, row by row; with Bradford chromatic adaptation, as in the ACES configs.
REC709_TO_AP0 = (
    (0.439632981919, 0.382988698152, 0.177378319930),
    (0.089776442959, 0.813439428749, 0.096784128292),
    (0.017541170383, 0.111546553302, 0.870912276314),
)


def linear_space_name(config: OCIO.Config, primaries: Primaries) -> str | None:
    """Return a config's name of the linear space with some primaries; None if it has none that is known."""
    spaces = filter(None, map(config.getColorSpace, LINEAR_NAMES.get(primaries, ())))
    return next((str(space.getName()) for space in spaces), None)


def rec709_to_reference(config: OCIO.Config) -> list[OCIO.Transform]:
    """Return the transforms from linear Rec.709 to the scene reference space of a config.

    Raise a ConfigError if it has neither a linear Rec.709 space (`LINEAR_REC709`) nor a role `aces_interchange`.
    """
    for name in LINEAR_REC709:
        space = config.getColorSpace(name)
        if space is not None and space.getReferenceSpaceType() == OCIO.REFERENCE_SPACE_SCENE:
            return _space_to_reference(space)
    interchange = config.getColorSpace("aces_interchange")
    if interchange is not None:
        return [matrix_transform(np.array(REC709_TO_AP0)), *_space_to_reference(interchange)]
    raise ConfigError("config_without_rec709")


def _space_to_reference(space: OCIO.ColorSpace) -> list[OCIO.Transform]:
    """Return a color space's transforms to its reference space, inverted where it defines the other direction only."""
    forward = space.getTransform(OCIO.COLORSPACE_DIR_TO_REFERENCE)
    if forward is not None:
        return [forward]
    backward = space.getTransform(OCIO.COLORSPACE_DIR_FROM_REFERENCE)
    return [] if backward is None else [OCIO.GroupTransform([backward], OCIO.TRANSFORM_DIR_INVERSE)]


def steps_to_reference(space: OCIO.ColorSpace) -> list[OCIO.Transform]:
    """Return the transforms of a color space to the reference space, one by one; none if it defines none."""
    transform = space.getTransform(OCIO.COLORSPACE_DIR_TO_REFERENCE)
    if isinstance(transform, OCIO.GroupTransform):
        return list(transform)
    return [] if transform is None else [transform]


def matrix_transform(rows: Float64Array) -> OCIO.MatrixTransform:
    """Return a transform that multiplies RGB by `rows`, shape (3, 3), of 12 decimals, which every machine computes."""
    square = np.eye(4)
    square[:3, :3] = np.round(rows, 12) + 0.0  # not -0
    return OCIO.MatrixTransform(matrix=square.ravel().tolist())
