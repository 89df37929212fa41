# SPDX-License-Identifier: GPL-3.0-or-later
"""The look of a photograph for a finished comp, and the view transform under which a linear plate keeps its tones."""

from typing import ClassVar

import bpy

from ... import lazy_import
from ...scene import color_management, plates, stored_estimate
from ...scene.nodes import links
from ...work.errors import expected_errors
from ..estimate_box import draw_text
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
        standard = color_management.set_standard_view(context.scene)
        view = f"View Transform is {standard} now" if standard else "choose a View Transform without tone mapping"
        self.report({"INFO"}, f"{plate.name}: its look is before the output; {view}")
        return {"FINISHED"}


class CRF_OT_standard_view(bpy.types.Operator):
    """Set the scene's view transform to Standard."""

    bl_idname = "crf.standard_view"
    bl_label = "Standard View"
    bl_description = (
        "Set View Transform to Standard (in ACES configs, Un-tone-mapped), Look to None, Exposure to 0 and Gamma to 1:"
        " white stays white, and tones are close to the photograph's. The render stays linear"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Set it."""
        return {"FINISHED"} if color_management.set_standard_view(context.scene) else {"CANCELLED"}


def draw_view(
    layout: bpy.types.UILayout, scene: bpy.types.Scene, plate: plates.Datablock, *, is_composited: bool
) -> None:
    """Draw that the view darkens a plate, or that its look is in the comp, with the buttons to change it."""
    looks = links.groups_of(plate, scene, links.LOOK) if is_composited else []
    view, standard = color_management.darker_view(scene), color_management.standard_view(scene)
    column = layout.box().column(align=True) if view or looks else layout
    if view:
        draw_text(column, f"{view} darkens the highlights of the plate.", icon="INFO")
    if view and standard:
        column.operator(CRF_OT_standard_view.bl_idname, text=f"{standard} View", icon="HIDE_OFF")
    if view and standard and is_composited:
        column.operator(CRF_OT_add_look.bl_idname, text="Match the Photograph", icon="CAMERA_DATA")
    for look in looks:
        if not look.mute:
            draw_text(column, "The output has the Camera Look: it is not linear.", icon="INFO")
        column.prop(look, "mute", text="Mute Camera Look")


register, unregister = bpy.utils.register_classes_factory((CRF_OT_add_look, CRF_OT_standard_view))
