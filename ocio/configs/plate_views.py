"""Views "as photographed": the scene through a plate's camera response, for review and for output.

The view transform undoes the plate's conversion: from the scene reference to linear light in the plate's exposure and
primaries, then through the response f to code values. A display with the sRGB curve and these primaries shows the codes
as they are. CG on a linear plate gets the camera's tone curve in this way, and the plate its code values.

A plate knows no light above its white. The plain view clips it. The other one rolls it off (docs/METHOD.md, Eq. 37).
"""

import copy
import math
from collections.abc import Sequence

import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import REC709

from .reference_space import matrix_transform, rec709_to_reference, steps_to_reference

#: The part of the plate's white from which the roll-off differs from the plate, and how slowly it rises from there.
KNEE, SOFTNESS = 0.8, 1 / 30

#: The display whose code values a photograph's are taken for.
SRGB_DISPLAY = "DISPLAY - CIE-XYZ-D65_to_sRGB"


def view_names(space: str) -> tuple[str, str]:
    """Return the names of the views and view transforms of a plate's color space: clipped at white, and rolled off."""
    return f"As photographed ({space})", f"As photographed with roll-off ({space})"


def add_plate_views(config: OCIO.Config, spaces: Sequence[str]) -> OCIO.Config:
    """Return a copy of the portable config with the views of plates' color spaces on its displays.

    The first view of each display goes through the display reference.
    """
    config = copy.deepcopy(config)
    for space in spaces:
        for name, is_rolled_off in zip(view_names(space), (False, True), strict=True):
            config.addViewTransform(_view_transform(config, space, name, is_rolled_off=is_rolled_off))
        for display in config.getDisplays():
            display_space = config.getDisplayViewColorSpaceName(display, config.getViews(display)[0])
            for name in view_names(space):
                view = {"display": display, "view": name, "viewTransform": name}
                config.addDisplayView(**view, displayColorSpaceName=display_space)
    names = [*active_views(config), *(name for space in spaces for name in view_names(space))]
    config.setActiveViews(", ".join(f'"{name}"' if "," in name else name for name in names))
    return config


def active_views(config: OCIO.Config) -> list[str]:
    """Return the views that menus show. OpenColorIO 2.4 gives a text, later versions an iterator."""
    views = config.getActiveViews()
    return [name.strip() for name in (views.split(",") if isinstance(views, str) else views) if name.strip()]


def roll_off() -> OCIO.Transform:
    """Return the roll-off of highlights, from linear light with the plate's white at 1 to at most 1 (Eq. 37).

    Up to `KNEE` it is the identity, above it a logarithm that continues with the same value and slope. White of the
    plate comes to 0.865, and 1 is reached at 14.2, or 3.8 stops above it.
    """
    return OCIO.LogCameraTransform(
        base=math.e,
        linSideBreak=[KNEE] * 3,
        linSideSlope=[1 / SOFTNESS] * 3,
        linSideOffset=[1 - KNEE / SOFTNESS] * 3,
        logSideSlope=[SOFTNESS] * 3,
        logSideOffset=[KNEE] * 3,
        linearSlope=[1] * 3,
    )


def _view_transform(config: OCIO.Config, space: str, name: str, *, is_rolled_off: bool) -> OCIO.ViewTransform:
    """Return the way from the scene reference through the plate's response to CIE XYZ of an sRGB display."""
    response, *rest = steps_to_reference(config.getColorSpace(space))
    inverse = OCIO.TRANSFORM_DIR_INVERSE
    steps: list[OCIO.Transform] = [OCIO.GroupTransform(rest, inverse)] if rest else []
    if is_rolled_off:
        steps.append(roll_off())
    steps += [OCIO.GroupTransform([response], inverse), *_codes_to_xyz(config, rest)]
    transform = OCIO.ViewTransform(OCIO.REFERENCE_SPACE_SCENE)
    transform.setName(name)
    highlights = f"rolled off from {KNEE} of its white" if is_rolled_off else "clipped at its white"
    transform.setDescription(f"Through the camera response of {space}, {highlights}.")
    transform.setTransform(OCIO.GroupTransform(steps), OCIO.VIEWTRANSFORM_DIR_FROM_REFERENCE)
    return transform


def _codes_to_xyz(config: OCIO.Config, steps: Sequence[OCIO.Transform]) -> list[OCIO.Transform]:
    """Return the transforms from a photograph's code values, by the sRGB curve, to CIE XYZ of a display.

    `steps` of its color space are an exposure, perhaps a matrix to linear Rec.709, and the way from there.
    """
    steps = steps[: len(steps) - len(rec709_to_reference(config))]
    primaries = [step for step in steps if isinstance(step, OCIO.MatrixTransform)]
    if not primaries:
        return [OCIO.BuiltinTransform(SRGB_DISPLAY, direction=OCIO.TRANSFORM_DIR_INVERSE)]
    curve = OCIO.ExponentWithLinearTransform(gamma=[2.4, 2.4, 2.4, 1], offset=[0.055, 0.055, 0.055, 0])
    return [curve, *primaries, matrix_transform(REC709.to_xyz())]
