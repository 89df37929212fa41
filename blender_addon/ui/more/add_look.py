# SPDX-License-Identifier: GPL-3.0-or-later
"""Give a finished comp the look of a photograph: the camera's response at the end of the compositor."""

from typing import ClassVar

import bpy

from ... import lazy_import
from ...scene import plates, stored_estimate
from ...work.errors import expected_errors
from ..operator_base import ChosenPlate, failed


class CRF_OT_add_look(ChosenPlate, bpy.types.Operator):
    """Put the plate's "Camera Look" before the output of the compositor."""

    bl_idname = "crf.add_look"
    bl_label = "Add Camera Look"
    bl_description = (
        "Put the camera's response before the output of the compositor: scene-linear light gets the look of the plate."
        " Set View Transform to Standard and Look to None: the render, and files saved from it, then match the plate."
        " For Raw, use the output Code Values"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the plate of the compositor has a response, and tell why if not; a script names its plate."""
        if not plates.is_in_editor(context):
            return True
        if context.area.type != "NODE_EDITOR":
            cls.poll_message_set("The look is added in the compositor")
            return False
        if stored_estimate.is_stored(plates.active_datablock(context)):
            return True
        cls.poll_message_set("Select a plate that has a response")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Add the node, or bring the one that is there up to date."""
        try:
            plate = self.estimated_plate(context)
            tree = lazy_import.load(".scene.apply").shown_tree(context)
            curve, stops = stored_estimate.restored(plate).curve, stored_estimate.exposure(plate)
            name = plates.plate_of(plate).name
            lazy_import.load(".scene.look_group").add_look(tree, plate, name, curve, stops)
        except expected_errors() as problem:
            return failed(self, problem)
        self.report({"INFO"}, f"{plate.name}: its look is before the output; set View Transform to Standard")
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((CRF_OT_add_look,))
