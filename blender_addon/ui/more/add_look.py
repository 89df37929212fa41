# SPDX-License-Identifier: GPL-3.0-or-later
"""Give a finished comp the look of a photograph: the camera's response at the end of the compositor."""

from typing import ClassVar

import bpy

from ... import lazy_import
from ...scene import plates, stored_estimate
from ...work.errors import AddonError, expected_errors
from ...work.wording import american


class CRF_OT_add_look(bpy.types.Operator):
    """Put the plate's "Camera Look" before the output of the compositor."""

    bl_idname = "crf.add_look"
    bl_label = "Add Camera Look"
    bl_description = (
        "Put the camera's response before the output of the compositor: scene-linear light gets the look of the plate."
        " Set View Transform to Standard and Look to None: the render, and files saved from it, then match the plate."
        " For Raw, use the output Code Values"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    image: bpy.props.StringProperty(
        name="Image", description="Name of the image; empty for the active plate", options={"HIDDEN", "SKIP_SAVE"}
    )
    clip: bpy.props.StringProperty(
        name="Movie Clip",
        description="Name of the movie clip; empty for the active plate",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the plate of the compositor has a response, and tell why if not; a script names its plate."""
        if context.area is None or context.area.type not in plates.EDITORS:
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
            plate = plates.chosen_datablock(context, self.image, self.clip)
            if not stored_estimate.is_stored(plate):
                raise AddonError(f"{plate.name}: has no estimate yet; estimate its response first")
            tree = lazy_import.load(".scene.apply").shown_tree(context)
            curve, stops = stored_estimate.restored(plate).curve, stored_estimate.exposure(plate)
            name = plates.plate_of(plate).name
            lazy_import.load(".scene.look_group").add_look(tree, plate, name, curve, stops)
        except expected_errors() as problem:
            self.report({"ERROR"}, american(str(problem)))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{plate.name}: its look is before the output; set View Transform to Standard")
        return {"FINISHED"}


def register() -> None:
    """Register the operator."""
    bpy.utils.register_class(CRF_OT_add_look)


def unregister() -> None:
    """Unregister the operator."""
    bpy.utils.unregister_class(CRF_OT_add_look)
