# SPDX-License-Identifier: GPL-3.0-or-later
"""Give a finished comp the look of a photograph: the camera's response at the end of the compositor."""

from typing import ClassVar

import bpy

from ... import lazy_import
from ...scene import color_management, plates, stored_estimate
from ...work.errors import expected_errors
from ..operator_base import NO_ESTIMATE, ChosenPlate, failed


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

    @classmethod
    def why_not(cls, context: bpy.types.Context) -> str:
        """Return that the plate has no response."""
        return "" if stored_estimate.is_stored(plates.active_datablock(context)) else NO_ESTIMATE

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Add the node, or bring the one that is there up to date."""
        try:
            plate = self.estimated_plate(context)
            tree = lazy_import.load(".scene.apply").shown_tree(context)
            curve, stops = stored_estimate.restored(plate).curve, stored_estimate.exposure(plate)
            lazy_import.load(".scene.nodes.look_group").add_look(tree, plate, plates.name_of(plate), curve, stops)
        except expected_errors() as problem:
            return failed(self, problem)
        is_matched = color_management.set_standard_view(context.scene)
        view = "View Transform is Standard now" if is_matched else "choose a View Transform without tone mapping"
        self.report({"INFO"}, f"{plate.name}: its look is before the output; {view}")
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((CRF_OT_add_look,))
