# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar panel of the Image Editor, the Movie Clip Editor and the compositor."""

from __future__ import annotations

import textwrap

import bpy
import bpy.utils.previews

from ..scene import plates, stored_estimate
from ..work import curve_picture
from .operators import CRF_OT_apply_response, CRF_OT_estimate_response

#: The drawn curves, by what they show.
_previews: bpy.utils.previews.ImagePreviewCollection | None = None

#: Pixels of the interface that a letter takes.
_LETTER = 7


class ResponsePanel:
    """The panel; the editors differ only in where it is."""

    bl_label = "Camera Response"
    bl_region_type = "UI"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the editor can show a plate."""
        return context.space_data.type != "NODE_EDITOR" or context.space_data.tree_type == "CompositorNodeTree"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the choices, the buttons and what was found."""
        layout, datablock = self.layout, plates.active_datablock(context)
        layout.operator(CRF_OT_estimate_response.bl_idname, icon="CAMERA_DATA")
        if datablock is None:
            layout.label(text=plates.OPEN_A_PLATE[context.area.type], icon="INFO")
            return
        _draw_choices(layout, datablock.camera_response_settings)
        if stored_estimate.is_stored(datablock):
            layout.operator(CRF_OT_apply_response.bl_idname, icon="FILE_REFRESH")
            letter = _LETTER * (context.preferences.system.ui_scale or 1)  # 0 without a screen
            _draw_estimate(layout, datablock, letters=max(20, int(context.region.width / letter)))


class CRF_PT_image(ResponsePanel, bpy.types.Panel):
    """In the Image Editor."""

    bl_space_type = "IMAGE_EDITOR"
    bl_category = "Image"


class CRF_PT_clip(ResponsePanel, bpy.types.Panel):
    """In the Movie Clip Editor."""

    bl_space_type = "CLIP_EDITOR"
    bl_category = "Footage"


class CRF_PT_node(ResponsePanel, bpy.types.Panel):
    """In the compositor."""

    bl_space_type = "NODE_EDITOR"
    bl_category = "Node"


def _draw_choices(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the settings that matter for the way the response is applied."""
    column = layout.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(settings, "apply")
    column.prop(settings, "anchor")
    if settings.anchor == "GRAY":
        column.prop(settings, "gray", slider=True)
    column.prop(settings, "exposure")
    if settings.apply == "BAKE":
        column.prop(settings, "depth")
    if settings.apply != "NODES":
        column.prop(settings, "folder")
    if settings.apply in ("BAKE", "EXPORT"):
        column.prop(settings, "overwrite")
    column.prop(settings, "force")


def _draw_estimate(layout: bpy.types.UILayout, datablock: plates.Datablock, *, letters: int) -> None:
    """Draw the curve and what is to be said of it."""
    box = layout.box()
    box.template_icon(icon_value=curve_icon(datablock), scale=9)
    box.label(text="Response, its 90 % band, gamma 2.2 dashed")
    for line in stored_estimate.lines(datablock):
        icon = "ERROR" if line.startswith("Warning") else "NONE"
        for number, part in enumerate(textwrap.wrap(line, letters)):
            box.label(text=part, icon=icon if number == 0 else "BLANK1" if icon == "ERROR" else "NONE")


def curve_icon(datablock: plates.Datablock) -> int:
    """Return the icon of a stored response's picture, drawn when it is first asked for."""
    key = stored_estimate.fingerprint(datablock)
    if key not in _previews:
        preview = _previews.new(key)
        preview.image_size = (curve_picture.SIZE, curve_picture.SIZE)
        pixels = curve_picture.draw_response(*stored_estimate.curve_and_band(datablock))
        preview.image_pixels_float.foreach_set(pixels.ravel())
    return _previews[key].icon_id


_CLASSES = (CRF_PT_image, CRF_PT_clip, CRF_PT_node)


def register() -> None:
    """Register the panels, and make room for their pictures."""
    global _previews
    _previews = bpy.utils.previews.new()
    for kind in _CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    """Take them back."""
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
    bpy.utils.previews.remove(_previews)
