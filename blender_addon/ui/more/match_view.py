# SPDX-License-Identifier: GPL-3.0-or-later
"""Show the scene as the photograph looks, where a view transform such as AgX gives light another tone."""

from __future__ import annotations

from typing import ClassVar

import bpy

from ...scene import color_management
from ..estimate_box import draw_text, letters_of


class CRF_OT_match_view(bpy.types.Operator):
    """Set the scene's view transform to Standard."""

    bl_idname = "crf.match_view"
    bl_label = "Match the Photograph"
    bl_description = (
        "Set the scene's View Transform to Standard, Look to None, Exposure to 0 and Gamma to 1: the plate looks nearly"
        " as photographed. Add Camera Look, under More in the compositor, gives its very code values"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Set it."""
        return {"FINISHED"} if color_management.set_standard_view(context.scene) else {"CANCELLED"}


def draw_view(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw that the scene's view transform shows a plate darker than it was photographed, and the button for it."""
    if view := color_management.darker_view(context.scene):
        text = f"{view} shows the plate darker than the photograph."
        draw_text(layout, text, letters_of(context), icon="INFO")
        if color_management.has_standard_view(context.scene):
            layout.operator(CRF_OT_match_view.bl_idname, icon="HIDE_OFF")


register, unregister = bpy.utils.register_classes_factory((CRF_OT_match_view,))
