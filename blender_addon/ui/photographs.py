# SPDX-License-Identifier: GPL-3.0-or-later
"""Further photographs of the camera that took a plate: the response is estimated from all of them together."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import bpy

from ..scene import plates
from ..work.errors import expected_errors
from .operator_base import ChosenSettings, failed


class CRF_OT_add_photographs(ChosenSettings, bpy.types.Operator):
    """Choose files of further photographs of the plate's camera."""

    bl_idname = "crf.add_photographs"
    bl_label = "Add Photographs of This Camera"
    bl_description = (
        "Add photographs that the same camera took with the same settings: the response is estimated from all of them"
        " together. On real cameras this has made it a little better only"
    )
    bl_options: ClassVar[set[str]] = {"UNDO"}

    directory: bpy.props.StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: bpy.props.CollectionProperty(type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"})
    filter_glob: bpy.props.StringProperty(
        default=";".join(f"*{suffix}" for suffix in plates.HEIF_SUFFIXES), options={"HIDDEN", "SKIP_SAVE"}
    )
    filter_image: bpy.props.BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Let the user choose files."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Open the files and add them to the list, each once, and not the plate itself."""
        try:
            plate = self.changeable_plate(context)
        except expected_errors() as problem:
            return failed(self, problem)
        photographs = plate.camera_response_settings.photographs
        for file in self.files:
            try:
                loaded = bpy.data.images.load(str(Path(self.directory, file.name)), check_existing=True)
            except RuntimeError:
                self.report({"ERROR"}, f"{file.name}: cannot be opened as an image")
                return {"CANCELLED"}
            image = plates.plate_itself(loaded)
            if image not in (plate, *(item.image for item in photographs)):
                photographs.add().image = image
        return {"FINISHED"}


class CRF_OT_remove_photograph(ChosenSettings, bpy.types.Operator):
    """Take a photograph from the list; it stays in the file."""

    bl_idname = "crf.remove_photograph"
    bl_label = "Remove Photograph"
    bl_description = "Take this photograph from the list; the image itself stays in the .blend file"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    index: bpy.props.IntProperty(name="Index", min=0, options={"HIDDEN", "SKIP_SAVE"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove it."""
        try:
            self.changeable_plate(context).camera_response_settings.photographs.remove(self.index)
        except expected_errors() as problem:
            return failed(self, problem)
        return {"FINISHED"}


def draw_photographs(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup) -> None:
    """Draw the list of photographs, closed at first."""
    header, body = layout.panel("CRF_photographs", default_closed=True)
    header.label(text=f"More Photos ({len(settings.photographs)})" if settings.photographs else "More Photos")
    if body is None:
        return
    column = body.column(align=True)
    for index, photograph in enumerate(settings.photographs):
        row = column.row(align=True)
        row.prop(photograph, "image", text="")
        row.operator(CRF_OT_remove_photograph.bl_idname, text="", icon="X").index = index
    column.operator(CRF_OT_add_photographs.bl_idname, text="Add Photos", icon="ADD")


register, unregister = bpy.utils.register_classes_factory((CRF_OT_add_photographs, CRF_OT_remove_photograph))
