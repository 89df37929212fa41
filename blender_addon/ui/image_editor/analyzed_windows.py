# SPDX-License-Identifier: GPL-3.0-or-later
"""Outline, over the plate in Image Editors, the windows that its response was estimated from.

The switch is a property of the window manager, so it is that of the session and no part of a plate. While it is on,
Blender calls `_draw` whenever it draws an Image Editor. It is off at first, and after another file is opened.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ...scene import plates, stored_estimate
from .. import running

if TYPE_CHECKING:
    from crfnet_core.types import BoolArray, Float64Array

#: The switch: a property of the window manager.
SHOWN = "camera_response_shows_windows"

#: Samples along each side of a window. It is `crfnet_core.statistics.windows.WINDOW_SIZE` again, because it comes as a
#: wheel, and the add-on has to start without it.
WINDOW_SIZE = 227

#: The outline of windows that agree with each other, of the others, and what lies under both to set them off: RGBA.
_AGREEING, _OTHERS, _BELOW = (1.0, 0.72, 0.25, 1.0), (0.75, 0.75, 0.75, 1.0), (0.0, 0.0, 0.0, 0.6)

#: The widths of an outline and of what lies under it, in pixels at a scale of 1.
_WIDTH, _WIDTH_BELOW = 1.5, 3.5

#: A file name without suffix, split around its last number, which is the frame number.
_FRAME_NUMBER = re.compile(r"(.*?)(\d+)\D*")

#: The four sides of a rectangle, each from one of its corners to another.
_SIDES = ((0, 1), (1, 2), (2, 3), (3, 0))

#: What Blender calls to draw, while the switch is on.
_handler: Any = None


def rectangles(datablock: plates.Datablock, photo: int, size: tuple[int, int]) -> tuple[Float64Array, BoolArray]:
    """Return where the windows of one photograph lie, in the coordinates of an Image Editor's view.

    Parameters
    ----------
    datablock : Image or MovieClip
        A plate with an estimate.
    photo : int
        Which of the photographs of the estimate: see `photo_shown`.
    size : tuple of int
        The width and the height of the photograph, in pixels.

    Returns
    -------
    corners : ndarray, float64, shape (N, 4, 2)
        The corners (x, y) of each window in turn; the photograph reaches from (0, 0) bottom left to (1, 1).
    agrees : ndarray, bool, shape (N,)
        Whether the window agrees with the others.
    """
    places, photos, agrees = stored_estimate.windows(datablock)
    x, y, step = places[photos == photo, :3].T
    extent = (WINDOW_SIZE - 1) * step + 1
    left, right = x / size[0], (x + extent) / size[0]
    top, bottom = 1 - y / size[1], 1 - (y + extent) / size[1]
    corners = np.stack([[left, bottom], [right, bottom], [right, top], [left, top]])  # (4, 2, N)
    return corners.transpose(2, 0, 1), agrees[photos == photo]


def photo_shown(image: bpy.types.Image, user: bpy.types.ImageUser) -> int | None:
    """Return which photograph of its estimate an editor shows of a plate; None for a frame that is none of them."""
    if image.source == "SEQUENCE":
        shown = Path(image.filepath_from_user(image_user=user)).stem
    elif image.source == "MOVIE":
        shown = f"{Path(image.filepath).stem}.{user.frame_current:04d}"  # as `work.frame_files.frames_of` names it
    else:
        return 0
    stems = [Path(name).stem for name in stored_estimate.photos(image)]
    return stems.index(shown) if shown in stems else None


def draw_switch(layout: bpy.types.UILayout, context: bpy.types.Context) -> str:
    """Draw the switch, and return what is to be said of it: in which frames the windows are, if not in this one."""
    plate, user = plates.active_datablock(context), context.space_data.image_user
    if not has_windows(plate):
        return ""
    layout.prop(context.window_manager, SHOWN)
    if not getattr(context.window_manager, SHOWN) or photo_shown(plate, user) is not None:
        return ""
    return f"Not in this frame: the windows are in {', '.join(_analyzed_frames(plate))}."


def has_windows(plate: plates.Datablock | None) -> bool:
    """Return whether a plate has an estimate from windows of its own; not if the response comes from elsewhere."""
    return stored_estimate.is_stored(plate) and not stored_estimate.origin(plate)


def _analyzed_frames(plate: plates.Datablock) -> list[str]:
    """Return the numbers of the frames of a plate that have windows, as they stand in the names of the files."""
    found = [_FRAME_NUMBER.fullmatch(Path(name).stem) for name in stored_estimate.photos(plate)]
    numbered = [match.groups() for match in found if match is not None]
    return [number for before, number in numbered if before == numbered[0][0]]  # the others are further photographs


def switch_off() -> None:
    """Draw no windows any more."""
    for manager in bpy.data.window_managers:
        setattr(manager, SHOWN, False)
    _free()


def _switch(manager: bpy.types.WindowManager, _context: bpy.types.Context) -> None:
    """Begin or end to draw, as the switch says."""
    global _handler
    _free()
    if getattr(manager, SHOWN):
        _handler = bpy.types.SpaceImageEditor.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
    running.redraw_editors(manager)


def _free() -> None:
    """Have Blender draw nothing for the add-on."""
    global _handler
    if _handler is not None:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handler, "WINDOW")
        _handler = None


def _draw() -> None:
    """Outline the windows in the Image Editor that is drawn."""
    context = bpy.context
    space, plate = context.space_data, plates.active_datablock(context)
    if plate is None or not has_windows(plate) or not all(plate.size):
        return
    photo = photo_shown(plate, space.image_user)
    if photo is None:
        return
    corners, agrees = rectangles(plate, photo, tuple(plate.size))
    to_region, scale = context.region.view2d.view_to_region, context.preferences.system.ui_scale or 1
    outlines = [(corners, _BELOW, _WIDTH_BELOW)]
    outlines += [(corners[~agrees], _OTHERS, _WIDTH), (corners[agrees], _AGREEING, _WIDTH)]
    for chosen, color, width in outlines:
        _draw_lines(segments(chosen, to_region), color, width * scale, (context.region.width, context.region.height))


def segments(corners: Float64Array, to_region: Callable[..., tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the ends of the sides of rectangles in pixels of a region, two for each side.

    Parameters
    ----------
    corners : ndarray, float64, shape (N, 4, 2)
        As `rectangles` returns them.
    to_region : callable
        `View2D.view_to_region`, which rounds to pixels.
    """
    found = []
    for rectangle in corners:
        ends = [to_region(*corner, clip=False) for corner in rectangle.tolist()]
        found += [ends[end] for side in _SIDES for end in side]
    return found


def _draw_lines(ends: list[tuple[float, float]], color: tuple[float, ...], width: float, size: tuple[int, int]) -> None:
    """Draw lines between each two ends in a region of a size in pixels."""
    if not ends:
        return
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    batch = batch_for_shader(shader, "LINES", {"pos": [(x, y, 0) for x, y in ends]})
    shader.uniform_float("viewportSize", size)
    shader.uniform_float("lineWidth", width)
    shader.uniform_float("color", color)
    gpu.state.blend_set("ALPHA")
    batch.draw(shader)
    gpu.state.blend_set("NONE")


def register() -> None:
    """Add the switch to the window manager."""
    switch = bpy.props.BoolProperty(
        name="Analyzed Windows",
        description="Outline the windows of the plate that its response was estimated from; gray are those that"
        " disagree with the others",
        update=_switch,
        options={"SKIP_SAVE"},
    )
    setattr(bpy.types.WindowManager, SHOWN, switch)


def unregister() -> None:
    """Draw no windows any more, and remove the switch."""
    switch_off()
    delattr(bpy.types.WindowManager, SHOWN)
