# SPDX-License-Identifier: GPL-3.0-or-later
"""Say that a view transform such as AgX gives a linear plate another tone, and set Standard instead."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ...scene import color_management
from ..estimate_box import draw_text, letters_of
from .add_look import CRF_OT_add_look


class CRF_OT_standard_view(bpy.types.Operator):
    """Set the scene's view transform to Standard."""

    bl_idname = "crf.standard_view"
    bl_label = "Standard View"
    bl_description = (
        "Set View Transform to Standard, Look to None, Exposure to 0 and Gamma to 1: white stays white, and tones are"
        " close to the photograph's. The render stays linear"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Set it."""
        return {"FINISHED"} if color_management.set_standard_view(context.scene) else {"CANCELLED"}


def draw_view(layout: bpy.types.UILayout, context: bpy.types.Context, *, has_nodes: bool) -> None:
    """Draw that the scene's view transform darkens the highlights of a plate, and the buttons that change it."""
    view = color_management.darker_view(context.scene)
    if not view:
        return
    box = layout.box()
    draw_text(box, f"{view} darkens the highlights of the plate.", letters_of(context), icon="INFO")
    if color_management.has_standard_view(context.scene):
        column = box.column(align=True)
        column.operator(CRF_OT_standard_view.bl_idname, icon="HIDE_OFF")
        if has_nodes:
            column.operator(CRF_OT_add_look.bl_idname, text="Match the Photograph", icon="CAMERA_DATA")


register, unregister = bpy.utils.register_classes_factory((CRF_OT_standard_view,))
