# SPDX-License-Identifier: GPL-3.0-or-later
"""Load the inverse of a plate's response from a LUT file, in place of an estimate."""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from ... import lazy_import
from ...scene import color_management, plates, stored_estimate
from ...work.errors import AddonError, expected_errors
from .. import running
from ..image_editor import comparison
from ..operator_base import ChosenPlate, failed
from ..plate_settings import exported_config
from ..preferences import absolute

if TYPE_CHECKING:
    from crfnet_core.colorimetry import Primaries


class CRF_OT_load_lut(ChosenPlate, bpy.types.Operator):
    """Choose a LUT file whose response the plate gets."""

    bl_idname = "crf.load_lut"
    bl_label = "Load Response from LUT"
    bl_description = (
        "Use the response in a LUT file, which leads from code values to linear light, in place of an estimate. Nothing"
        " else changes until it is applied"
    )

    filepath: bpy.props.StringProperty(
        name="File", description="The LUT file", subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"}
    )
    filter_glob: bpy.props.StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Let the user choose a file of a format that OpenColorIO reads."""
        try:
            suffixes = lazy_import.load("crfnet.luts.opencolorio").READABLE
        except expected_errors() as problem:
            return failed(self, problem)
        self.filter_glob = ";".join(f"*{suffix}" for suffix in suffixes)
        self.filepath = self.filepath or _first_folder(plates.active_datablock(context))
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Store the response on the plate."""
        try:
            plate = self.chosen_plate(context)
            primaries = _primaries(plate)
            path = absolute(self.filepath)
            if path is None or not Path(self.filepath).name:
                raise AddonError("No LUT file is chosen: choose one")
            lut = lazy_import.load("crfnet.luts.files").read_lut(path)
            curve = lazy_import.load("crfnet.luts.response").response_of_lut(lut)
            model = f"loaded from {path.name}"
            loaded = lazy_import.load(".work.estimate_record").loaded_estimate(curve, model)
        except expected_errors() as problem:
            return failed(self, problem)
        comparison.end_all()
        stored_estimate.store(plate, loaded)
        stored_estimate.set_entry(plate, stored_estimate.ORIGIN, f"Loaded from {path.name}")
        stored_estimate.set_primaries(plate, primaries)
        running.redraw_editors(context.window_manager)
        self.report({"INFO"}, f"{plate.name}: the response is {model}; nothing else was changed")
        return {"FINISHED"}


def _first_folder(datablock: plates.Datablock) -> str:
    """Return the folder that the dialog shows at first: of what was exported for a plate last, or of its file."""
    config = exported_config(datablock) if stored_estimate.is_stored(datablock) else ""
    return f"{Path(config or bpy.path.abspath(datablock.filepath)).parent}{os.sep}"


def _primaries(datablock: plates.Datablock) -> "Primaries":
    """Return the primaries that a plate is encoded in."""
    plate, frame_files = plates.plate_of(datablock), lazy_import.load(".work.frame_files")
    holds_encoded_values = lazy_import.load(".work.encoding_check").holds_encoded_values
    is_forced = datablock.camera_response_settings.force
    is_encoded = holds_encoded_values(plate, color_management.running_config(), is_forced=is_forced)
    return frame_files.primaries_of(plate, frame_files.frames_of(plate), is_encoded=is_encoded)


register, unregister = bpy.utils.register_classes_factory((CRF_OT_load_lut,))
