"""Views "as photographed": the scene through a plate's own camera response, for review and for output.

The view transform undoes the plate's conversion: from the scene reference to linear light in the plate's exposure and
primaries, then through the response f to code values. A display with the sRGB curve and these primaries shows the codes
as they are. CG on a linear plate gets the camera's tone curve in this way, and the plate its own code values.

A plate knows no light above its white. The plain view clips it. The other one rolls it off (docs/METHOD.md, Eq. 37).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence

import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import REC709
from crfnet_core.errors import one_line

from ..errors import ConfigError
from .reference_space import matrix_transform, rec709_to_reference, steps_to_reference

#: The names of the two views and view transforms of a plate's colour space.
VIEW_NAMES = ("As photographed ({})", "As photographed with roll-off ({})")

#: From which part of the plate's white the roll-off differs from the plate, and how slowly it rises from there.
KNEE, SOFTNESS = 0.8, 1 / 30

#: The display whose code values a photograph's are taken for.
SRGB_DISPLAY = "DISPLAY - CIE-XYZ-D65_to_sRGB"

#: The encodings of displays that show a photograph's range; Blender's displays state none.
SDR_ENCODINGS = ("sdr-video", "")


def view_names(space: str) -> tuple[str, str]:
    """Return the names of the views of a plate's colour space: clipped at white, and rolled off."""
    clipped, rolled_off = (name.format(space) for name in VIEW_NAMES)
    return clipped, rolled_off


def add_plate_views(config: OCIO.Config, spaces: Sequence[str]) -> OCIO.Config:
    """Return a copy of `config` with the views of plates' colour spaces on every standard-range display.

    A display that goes through the display reference space (CIE XYZ) gets a view transform, which is right on any
    display. Where displays show scene-referred colour spaces, as in Blender 4.5, only those whose name holds "sRGB" get
    a view, and only the clipped one: it is the plate's colour space.

    Parameters
    ----------
    config : PyOpenColorIO.Config
        A config of profile 2 with the plates' colour spaces.
    spaces : sequence of str
        The names of the plates' colour spaces.

    Raises
    ------
    ConfigError
        If the config is of profile 1, or has no display for the views.
    """
    if config.getMajorVersion() < 2:
        raise ConfigError("profile version 1 has no view transforms; leave --view out")
    config = copy.deepcopy(config)
    remove_plate_views(config, spaces)
    displays = _display_spaces(config)
    plain = [] if displays else [display for display in config.getDisplaysAll() if "srgb" in display.lower()]
    if not displays and not plain:
        raise ConfigError("the config has no standard-range display for a view; leave --view out")
    active = active_views(config)
    try:
        for space in spaces:
            added = _add_views(config, space, displays) if displays else _add_plain_view(config, space, plain)
            active += added if active else ()
    except OCIO.Exception as problem:
        raise ConfigError(f"no view can be added to the config ({one_line(problem)})") from problem
    config.setActiveViews(_listed(active))
    return config


def remove_plate_views(config: OCIO.Config, spaces: Sequence[str]) -> None:
    """Remove the views of plates' colour spaces from a config, which is changed."""
    names = {name for space in spaces for name in view_names(space)}
    for display in config.getDisplaysAll():
        for name in names.intersection(config.getViews(OCIO.VIEW_DISPLAY_DEFINED, display)):
            config.removeDisplayView(display, name)
    transforms = list(config.getViewTransforms())
    if names.intersection(transform.getName() for transform in transforms):
        config.clearViewTransforms()
        for transform in transforms:
            if transform.getName() not in names:
                config.addViewTransform(transform)
    if names.intersection(active := active_views(config)):
        config.setActiveViews(_listed([name for name in active if name not in names]))


def plate_views(config: OCIO.Config, space: str) -> tuple[str, ...]:
    """Return those names of the views of a plate's colour space that any display has."""
    found = {
        name for display in config.getDisplaysAll() for name in config.getViews(OCIO.VIEW_DISPLAY_DEFINED, display)
    }
    return tuple(name for name in view_names(space) if name in found)


def active_views(config: OCIO.Config) -> list[str]:
    """Return the views that menus show; none means all. OpenColorIO 2.4 gives a text, later versions an iterator."""
    found = config.getActiveViews()
    return [name.strip() for name in (found.split(",") if isinstance(found, str) else found) if name.strip()]


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


def _add_views(config: OCIO.Config, space: str, displays: Mapping[str, str]) -> tuple[str, ...]:
    """Add both views of a plate to displays with these display-referred colour spaces; return the views' names."""
    clipped, rolled_off = view_names(space)
    config.addViewTransform(_view_transform(config, space, clipped, is_rolled_off=False))
    config.addViewTransform(_view_transform(config, space, rolled_off, is_rolled_off=True))
    for display, display_space in displays.items():
        for name in (clipped, rolled_off):
            view = {"display": display, "view": name, "viewTransform": name}
            config.addDisplayView(**view, displayColorSpaceName=display_space)
    return clipped, rolled_off


def _add_plain_view(config: OCIO.Config, space: str, displays: Sequence[str]) -> tuple[str, ...]:
    """Add the clipped view of a plate to displays that show scene-referred colour spaces; return its name."""
    clipped, _ = view_names(space)
    if _primaries_matrix(config, space) is not None:
        raise ConfigError(f"{space}: an sRGB display cannot show its primaries as they are; leave --view out")
    for display in displays:
        config.addDisplayView(display, clipped, space)
    return (clipped,)


def _view_transform(config: OCIO.Config, space: str, name: str, *, is_rolled_off: bool) -> OCIO.ViewTransform:
    """Return the way from the scene reference through the plate's response to CIE XYZ of an sRGB display."""
    response, *rest = steps_to_reference(config.getColorSpace(space))
    inverse = OCIO.TRANSFORM_DIR_INVERSE
    steps: list[OCIO.Transform] = [OCIO.GroupTransform(rest, inverse)] if rest else []
    if is_rolled_off:
        steps.append(roll_off())
    steps += [OCIO.GroupTransform([response], inverse), *_codes_to_xyz(_primaries_matrix(config, space))]
    transform = OCIO.ViewTransform(OCIO.REFERENCE_SPACE_SCENE)
    transform.setName(name)
    highlights = f"rolled off from {KNEE} of its white" if is_rolled_off else "clipped at its white"
    transform.setDescription(f"Through the camera response of {space}, {highlights}.")
    transform.setTransform(OCIO.GroupTransform(steps), OCIO.VIEWTRANSFORM_DIR_FROM_REFERENCE)
    return transform


def _primaries_matrix(config: OCIO.Config, space: str) -> OCIO.Transform | None:
    """Return the matrix from a plate's primaries to linear Rec.709; None if it has these already.

    A plate's colour space is a LUT, perhaps an exposure, perhaps this matrix, and the way from Rec.709.
    """
    own = steps_to_reference(config.getColorSpace(space))[1:]
    own = own[: len(own) - len(rec709_to_reference(config))]
    return next((step for step in own if isinstance(step, OCIO.MatrixTransform)), None)


def _codes_to_xyz(primaries: OCIO.Transform | None) -> list[OCIO.Transform]:
    """Return the transforms from a photograph's code values, by the sRGB curve, to CIE XYZ of a display."""
    if primaries is None:
        return [OCIO.BuiltinTransform(SRGB_DISPLAY, direction=OCIO.TRANSFORM_DIR_INVERSE)]
    curve = OCIO.ExponentWithLinearTransform(gamma=[2.4, 2.4, 2.4, 1], offset=[0.055, 0.055, 0.055, 0])
    return [curve, primaries, matrix_transform(REC709.to_xyz())]


def _display_spaces(config: OCIO.Config) -> dict[str, str]:
    """Return the display-referred colour space of every standard-range display, by display."""
    spaces: dict[str, str] = {}
    for display in config.getDisplaysAll():
        for view in config.getViews(display):
            name = config.getDisplayViewColorSpaceName(display, view)
            found = config.getColorSpace(display if name == "<USE_DISPLAY_NAME>" else name)
            is_display = found is not None and found.getReferenceSpaceType() == OCIO.REFERENCE_SPACE_DISPLAY
            if is_display and found.getEncoding() in SDR_ENCODINGS:
                spaces.setdefault(display, found.getName())
    return spaces


def _listed(names: list[str]) -> str:
    """Return names as OpenColorIO's list."""
    return ", ".join(f'"{name}"' if "," in name else name for name in names)
