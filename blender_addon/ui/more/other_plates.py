# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply the response of a plate to other plates of the same camera."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import bpy

from ... import lazy_import
from ...scene import plates, stored_estimate
from ...work.errors import AddonError, expected_errors
from .. import running
from ..image_editor import comparison
from ..operator_base import ChosenPlate, failed
from ..plate_settings import CHOICES, remember_applied

if TYPE_CHECKING:
    from ...work.job import Job


class CRF_OtherPlate(bpy.types.PropertyGroup):
    """An image or clip by its name, and whether it gets the response."""

    is_clip: bpy.props.BoolProperty(name="Movie Clip", description="Whether this is a movie clip, not an image")
    is_chosen: bpy.props.BoolProperty(name="Apply", description="Apply the response to this plate", default=True)

    @property
    def datablock(self) -> plates.Datablock:
        """The image or clip; an AddonError if there is none of this name."""
        names = ("", self.name) if self.is_clip else (self.name, "")
        return plates.chosen_datablock(bpy.context, *names)


class CRF_OT_copy_response(ChosenPlate, bpy.types.Operator):
    """Apply the response of the active plate to other plates, with its settings."""

    bl_idname = "crf.copy_response"
    bl_label = "Apply to Other Plates"
    bl_description = (
        "Apply this response, with the settings of this plate, to other plates that the same camera took with the same"
        " settings. Selected nodes in the compositor are chosen at first"
    )

    targets: bpy.props.CollectionProperty(type=CRF_OtherPlate, options={"HIDDEN", "SKIP_SAVE"})

    needs_estimate = True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Let the user choose among all other plates of the file."""
        self.targets.clear()
        source, selected = plates.active_datablock(context), _selected(context)
        self._cameras = []
        for datablock in other_plates(source):
            target = self.targets.add()
            target.name, target.is_clip = datablock.name, isinstance(datablock, bpy.types.MovieClip)
            self._cameras.append(other_camera(source, datablock))
            target.is_chosen = datablock in selected and not self._cameras[-1]
        if not self.targets:
            self.report({"INFO"}, "This file has no other plate: open one first")
            return {"CANCELLED"}
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the list."""
        column = self.layout.column(align=True)
        for target, camera in zip(self.targets, self._cameras, strict=True):
            row = column.row()
            row.alert = bool(camera)
            row.prop(target, "is_chosen", text=f"{target.name} ({camera})" if camera else target.name)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Apply it to one plate after the other, once all of them are known to be usable."""
        done = 0
        try:
            source = self.chosen_plate(context)
            chosen = self._chosen(source)
            jobs = [_job(source, datablock) for datablock in chosen]
            comparison.end_all()
            for job in jobs:
                _apply(context, source, job)
                done += 1
        except expected_errors() as problem:
            result = failed(self, problem)
            return {"FINISHED"} if done else result
        running.redraw_editors(context.window_manager)
        count = "one more plate has" if done == 1 else f"{done} more plates have"
        self.report({"INFO"}, f"{source.name}: {count} its response now; {_what_was_done(source)}")
        for datablock in chosen:
            if camera := other_camera(source, datablock):
                self.report({"WARNING"}, f"{datablock.name}: its file names another camera, {camera}")
        return {"FINISHED"}

    def _chosen(self, source: plates.Datablock) -> list[plates.Datablock]:
        """Return the plates that get the response."""
        chosen = dict.fromkeys(target.datablock for target in self.targets if target.is_chosen)
        chosen.pop(source, None)
        if not chosen:
            raise AddonError("No other plate is chosen: tick at least one")
        return list(chosen)


def other_plates(source: plates.Datablock) -> Iterator[plates.Datablock]:
    """Yield the images and clips of the file that a response can be applied to, hidden ones and the source excepted."""
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        if datablock != source and not datablock.name.startswith(".") and not plates.obstacle(datablock):
            yield datablock


def other_camera(source: plates.Datablock, target: plates.Datablock) -> str:
    """Return the camera that the file of a plate names, if the estimate of another plate is from other cameras."""
    cameras = stored_estimate.camera_models(source)
    if not cameras or target.source == "MOVIE":
        return ""
    camera: str = lazy_import.load(".work.frame_files").camera_of(plates.plate_of(target))
    return "" if camera in cameras else camera


def _selected(context: bpy.types.Context) -> list[plates.Datablock]:
    """Return the plates of the selected nodes of the compositor."""
    space = context.space_data
    if space is None or space.type != "NODE_EDITOR" or not space.edit_tree:
        return []
    return [plates.datablock_of_node(node) for node in space.edit_tree.nodes if node.select]


def _job(source: plates.Datablock, target: plates.Datablock) -> "Job":
    """Return the job that applies the response and the settings of one plate to another one.

    A bake may take long, so each plate gets it by its own Apply; until then the response is only stored.
    """
    settings = source.camera_response_settings
    arguments = {name: getattr(settings, name) for name in CHOICES} | {"compose": False}
    if arguments["apply"] == "BAKE":
        arguments["apply"] = "ESTIMATE"
    job = lazy_import.load(".ui.gather").gather_job(target, arguments, is_estimated=False)
    origin = stored_estimate.origin(source)
    words = f"From {source.name}" + (f" ({origin})" if origin else "")
    return replace(job, estimation=replace(job.estimation, stored=stored_estimate.restored(source), origin=words))


def _apply(context: bpy.types.Context, source: plates.Datablock, job: "Job") -> None:
    """Run a job, and apply it to its plate."""
    completed = lazy_import.load(".work.run").run(job)
    lazy_import.load(".scene.apply").apply(context, completed)
    datablock = plates.datablock_of_plate(job.plate)
    datablock.camera_response_settings.apply = source.camera_response_settings.apply
    if completed.is_applied:
        remember_applied(datablock, completed)


def _what_was_done(source: plates.Datablock) -> str:
    """Return in words how the response was applied to the other plates."""
    if stored_estimate.verdict(source) == stored_estimate.DO_NOT_TRUST:
        return "it is stored only, because it is not to be trusted"
    done = {
        "NODES": "it is applied as Nodes",
        "BAKE": "bake each with its own Apply",
        "EXPORT": "its files are written",
    }
    return done[source.camera_response_settings.apply]


register, unregister = bpy.utils.register_classes_factory((CRF_OtherPlate, CRF_OT_copy_response))
