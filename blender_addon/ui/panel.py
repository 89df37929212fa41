# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar panel of the Image Editor, the Movie Clip Editor and the compositor."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import bpy
import bpy.utils.previews

from ..scene import plates, stored_estimate
from ..work import curve_picture
from .operators import CRF_OT_apply_response, CRF_OT_estimate_response

#: The pictures of responses that were drawn, by the fingerprint of the estimate.
_previews: bpy.utils.previews.ImagePreviewCollection  # while the panels are registered

#: How lines begin that get an icon.
ALARMING = ("Warning", "The estimate is not to be trusted")

#: The mean width of a letter of the interface, in pixels at a scale of 1.
_LETTER = 7


class ResponsePanel:
    """The panel, which is the same in every editor."""

    bl_label = "Camera Response"
    bl_region_type = "UI"

    if TYPE_CHECKING:  # of bpy.types.Panel
        layout: bpy.types.UILayout

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the editor can show a plate: the node editor can only as the compositor."""
        return context.space_data.type != "NODE_EDITOR" or context.space_data.tree_type == "CompositorNodeTree"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the buttons, the settings of the plate and its estimate."""
        layout, datablock = self.layout, plates.active_datablock(context)
        layout.operator(CRF_OT_estimate_response.bl_idname, icon="CAMERA_DATA")
        if datablock is None:
            layout.label(text=plates.OPEN_A_PLATE[context.area.type], icon="INFO")
            return
        _draw_settings(layout, datablock.camera_response_settings)
        if stored_estimate.is_stored(datablock):
            layout.operator(CRF_OT_apply_response.bl_idname, icon="FILE_REFRESH")
            letter = _LETTER * (context.preferences.system.ui_scale or 1)  # 0 without a screen
            _draw_estimate(layout, datablock, letters=max(20, int(context.region.width / letter)))


class CRF_PT_image(ResponsePanel, bpy.types.Panel):
    """The panel in the Image Editor."""

    bl_space_type = "IMAGE_EDITOR"
    bl_category = "Image"


class CRF_PT_clip(ResponsePanel, bpy.types.Panel):
    """The panel in the Movie Clip Editor."""

    bl_space_type = "CLIP_EDITOR"
    bl_category = "Footage"


class CRF_PT_node(ResponsePanel, bpy.types.Panel):
    """The panel in the compositor."""

    bl_space_type = "NODE_EDITOR"
    bl_category = "Node"


def _draw_settings(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the settings that matter for the chosen way to apply the response."""
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
    _draw_advanced(layout, settings)


def _draw_advanced(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw what few plates need, closed at first: which responses to expect, and whether metadata counts."""
    header, body = layout.panel("CRF_advanced", default_closed=True)
    header.label(text="Advanced")
    if body is None:
        return
    column = body.column()
    column.use_property_split = True
    column.use_property_decorate = False
    column.prop(settings, "prior")
    if settings.prior == "file":
        column.prop(settings, "prior_file")
    column.prop(settings, "ignore_metadata")


def _draw_estimate(layout: bpy.types.UILayout, datablock: plates.Datablock, *, letters: int) -> None:
    """Draw the response, and the verdict and warnings wrapped to a number of letters."""
    box = layout.box()
    box.template_icon(icon_value=curve_icon(datablock), scale=9)
    box.label(text="Response, 90 % credible band; gamma 2.2 dashed")
    for line in stored_estimate.lines(datablock):
        first, others = ("ERROR", "BLANK1") if line.startswith(ALARMING) else ("NONE", "NONE")
        for number, part in enumerate(textwrap.wrap(line, letters)):
            box.label(text=part, icon=others if number else first)


def curve_icon(datablock: plates.Datablock) -> int:
    """Return the icon of the picture of a stored response, which is drawn at the first call."""
    key = stored_estimate.fingerprint(datablock)
    if key not in _previews:
        preview = _previews.new(key)
        preview.image_size = (curve_picture.SIZE, curve_picture.SIZE)
        pixels = curve_picture.draw_response(*stored_estimate.curve_and_band(datablock))
        preview.image_pixels_float.foreach_set(pixels.ravel())
    return _previews[key].icon_id


_CLASSES = (CRF_PT_image, CRF_PT_clip, CRF_PT_node)


def register() -> None:
    """Register the panels, and start with no picture drawn."""
    global _previews
    _previews = bpy.utils.previews.new()
    for kind in _CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    """Unregister the panels, and free their pictures."""
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
    bpy.utils.previews.remove(_previews)
