# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools for images: compare the plate before and after, pick gray in it, make a sequence of supposed UDIM tiles."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import bpy

from ... import lazy_import
from ...scene import plates, stored_estimate
from ...scene.nodes import compositor
from ...work.errors import AddonError, expected_errors
from .. import running
from ..operator_base import failed, is_allowed, why_unchangeable
from . import comparison

if TYPE_CHECKING:
    from crfnet_core.types import Float32Array

REACH = 2  # half the side of the square of pixels whose mean is picked

#: The entry of the key in Blender's keymaps, with its keymap, while it is there.
_keys: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


class CRF_OT_compare(bpy.types.Operator):
    """Show the plate, or the linear plate with the present exposure, or switch; nothing but the editor changes."""

    bl_idname = "crf.compare"
    bl_label = "Compare Plate and Linear Plate"
    bl_description = (
        "Show the plate as it is, or as linear light with the present exposure; only the view changes. Shift Z switches"
        " with the mouse over the picture: see Image in the Keymap of the Preferences"
    )

    is_after: bpy.props.BoolProperty(
        name="After", description="Show the linear plate. Left out: the other of the two", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether an Image Editor shows a plate with an estimate."""
        return _is_image_editor(context) and stored_estimate.is_stored(plates.active_datablock(context))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Show the one or the other."""
        space = context.space_data
        is_switch = not self.properties.is_property_set("is_after")
        is_after = plates.compared_plate(space.image) is None if is_switch else self.is_after
        with comparison.same_view(context):
            comparison.end(space)
            try:
                if is_after:
                    comparison.show_linear(space)
            except expected_errors() as problem:
                return failed(self, problem)
        return {"FINISHED"}


class CRF_OT_show_plate(bpy.types.Operator):
    """Show the plate from which the linear plate in the editor was baked."""

    bl_idname = "crf.show_plate"
    bl_label = "Show the Plate"
    bl_description = "Show the plate that this was baked from"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether an Image Editor or Movie Clip Editor shows a baked plate whose plate is in the file."""
        return context.area is not None and context.area.type != "NODE_EDITOR" and _plate_of_baked(context) is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Show it."""
        shown = "image" if context.area.type == "IMAGE_EDITOR" else "clip"
        with comparison.same_view(context):
            setattr(context.space_data, shown, _plate_of_baked(context))
        return {"FINISHED"}


class CRF_OT_pick_gray(bpy.types.Operator):
    """Pick the brightness of middle gray in the plate."""

    bl_idname = "crf.pick_gray"
    bl_label = "Pick Gray"
    bl_description = "Click on something in the plate that reflects 18 % of the light, such as a gray card"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether an Image Editor shows a plate that may be changed, and set the tooltip if not."""
        return _is_image_editor(context) and is_allowed(cls, running.why_busy() or why_unchangeable(context))

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Wait for the click, with the plate as it is in the editor."""
        comparison.end(context.space_data)
        self._workspace = context.workspace
        context.window.cursor_modal_set("EYEDROPPER")
        running.set_status(self._workspace, "Click on something gray in the plate  |  Esc to cancel")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Pick the pixels under the mouse at the click; let the mouse wheel and the middle button move the view."""
        is_ended = event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS"
        if is_ended or not self.poll(context):  # the editor may show something else meanwhile
            self.cancel(context)
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        self.cancel(context)
        region = next(region for region in context.area.regions if region.type == "WINDOW")
        place = region.view2d.region_to_view(event.mouse_x - region.x, event.mouse_y - region.y)
        try:
            gray = self._pick(context.space_data, place)
        except expected_errors() as problem:
            return failed(self, problem)
        self.report({"INFO"}, f"Gray is {gray:.3f}")
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Give the mouse pointer and the status bar back."""
        context.window.cursor_modal_restore()
        running.set_status(self._workspace, None)

    def _pick(self, space: bpy.types.SpaceImageEditor, place: tuple[float, float]) -> float:
        """Set the anchor of the plate to the brightness at a place, from (0, 0) bottom left to (1, 1); return it."""
        codes = comparison.code_values(space.image, space.image_user)
        settings = space.image.camera_response_settings
        settings.gray = mean_around(codes, place)
        settings.anchor = "GRAY"
        return settings.gray


class CRF_OT_read_as_sequence(bpy.types.Operator):
    """Make an image sequence of frames that Blender took for UDIM tiles, and show its first frame on frame 1."""

    bl_idname = "crf.read_as_sequence"
    bl_label = "Set to Image Sequence"
    bl_description = "Set Source to Image Sequence: the numbers in the file names are frames, not UDIM tiles"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the plate is made of tiles and may be changed, and set the tooltip if not."""
        return plates.is_tiled(plates.active_datablock(context)) and is_allowed(cls, why_unchangeable(context))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Change the source of the image, and the timing where it is shown: at first, that would show no frame."""
        image, space = plates.chosen_datablock(context), context.space_data
        image.source = "SEQUENCE"
        image.name = Path(image.filepath).name
        user = space.image_user if space.type == "IMAGE_EDITOR" else space.edit_tree.nodes.active
        if hasattr(user, "frame_duration"):  # not the plate's node group
            with suppress(*expected_errors()):  # reported where a response is estimated
                frames = lazy_import.load(".work.frame_files").frames_of(plates.plate_of(image)).numbers
                compositor.FrameTiming.by_number(frames, start=1).set_on(user)
        if space.type == "IMAGE_EDITOR":
            comparison.frame_view(context)
        return {"FINISHED"}


def mean_around(codes: Float32Array, place: tuple[float, float]) -> float:
    """Return the mean brightness of red, green and blue in a square of pixels of code values, shape (H, W, 3 or more).

    Its center is from (0, 0), the corner of the first row and column, to (1, 1). Raise AddonError if it lies outside.
    """
    height, width = codes.shape[:2]
    column, row = int(place[0] * width // 1), int(place[1] * height // 1)
    if not (0 <= column < width and 0 <= row < height):
        raise AddonError("No pixel there: click inside the plate")
    square = codes[max(0, row - REACH) : row + REACH + 1, max(0, column - REACH) : column + REACH + 1, :3]
    return float(square.mean())


def _plate_of_baked(context: bpy.types.Context) -> plates.Datablock | None:
    """Return the plate that the linear plate in an editor was baked from, by its name; None for any other plate."""
    baked = plates.active_datablock(context)
    collection = bpy.data.images if isinstance(baked, bpy.types.Image) else bpy.data.movieclips
    return None if baked is None else collection.get(baked.get(plates.BAKED_FROM, ""))


def _is_image_editor(context: bpy.types.Context) -> bool:
    """Return whether an Image Editor is active."""
    return context.space_data is not None and context.space_data.type == "IMAGE_EDITOR"


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (CRF_OT_compare, CRF_OT_show_plate, CRF_OT_pick_gray, CRF_OT_read_as_sequence)
)


def register() -> None:
    """Register the tools, and the key where there is a window."""
    _register_classes()
    if not bpy.app.background:
        add_key()


def add_key() -> None:
    """Add the key that switches between the plate and the linear plate; Blender uses it for nothing in this editor."""
    keymap = bpy.context.window_manager.keyconfigs.addon.keymaps.new("Image", space_type="IMAGE_EDITOR")
    _keys.append((keymap, keymap.keymap_items.new(CRF_OT_compare.bl_idname, "Z", "PRESS", shift=True)))


def unregister() -> None:
    """Show the plates again, and remove the key and the tools."""
    comparison.end_all()
    while _keys:
        keymap, item = _keys.pop()
        keymap.keymap_items.remove(item)
    _unregister_classes()
