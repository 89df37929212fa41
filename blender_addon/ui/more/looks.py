# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of a photograph for a finished comp, and the view transform under which a linear plate keeps its tones."""

from typing import ClassVar

import bpy

from ... import lazy_import
from ...scene import color_management, plates, stored_estimate
from ...work.errors import expected_errors
from ..estimate_box import draw_text, letters_of
from ..operator_base import ChosenPlate, failed


class CRF_OT_add_look(ChosenPlate, bpy.types.Operator):
    """Put the plate's "Camera Look" before the output of the compositor."""

    bl_idname = "crf.add_look"
    bl_label = "Add Camera Look"
    bl_description = (
        "Put the camera's response before the output of the compositor, and set View Transform to Standard: the render,"
        " and files saved from it, look like the photograph, code by code. It is then not linear any more. For the view"
        " Raw, use the output Code Values"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    needs_estimate = True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Add the node, or bring the one that is there up to date."""
        try:
            plate = self.chosen_plate(context)
            tree = lazy_import.load(".scene.apply").shown_tree(context)
            curve, stops = stored_estimate.restored(plate).curve, stored_estimate.exposure(plate)
            lazy_import.load(".scene.nodes.look_group").add_look(tree, plate, plates.name_of(plate), curve, stops)
        except expected_errors() as problem:
            return failed(self, problem)
        is_matched = color_management.set_standard_view(context.scene)
        view = "View Transform is Standard now" if is_matched else "choose a View Transform without tone mapping"
        self.report({"INFO"}, f"{plate.name}: its look is before the output; {view}")
        return {"FINISHED"}


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


def draw_view(layout: bpy.types.UILayout, context: bpy.types.Context, *, is_composited: bool) -> None:
    """Draw that the view transform darkens the highlights of a plate, and the buttons for it; the look is for comps."""
    view = color_management.darker_view(context.scene)
    if not view:
        return
    box = layout.box()
    draw_text(box, f"{view} darkens the highlights of the plate.", letters_of(context), icon="INFO")
    if color_management.has_standard_view(context.scene):
        column = box.column(align=True)
        column.operator(CRF_OT_standard_view.bl_idname, icon="HIDE_OFF")
        if is_composited:
            column.operator(CRF_OT_add_look.bl_idname, text="Match the Photograph", icon="CAMERA_DATA")


register, unregister = bpy.utils.register_classes_factory((CRF_OT_add_look, CRF_OT_standard_view))
