# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators: gather a request, let the pipeline work, apply the outcome, report."""

from pathlib import Path
from typing import Any, ClassVar

import bpy

from .. import lazy_import
from ..scene import color_management, plates, stored_estimate
from ..work.background import Task
from ..work.errors import AddonError, CancelledError, expected_errors
from .gather import Request, request_for
from .plate_settings import CHOICES, PlateChoices
from .preferences import APPLY_MODES, absolute

#: Seconds between two looks at the other thread.
TICK = 0.1


class PlateOperator(PlateChoices):
    """What both operators share: a run that blocks in scripts and in the background, and a modal one in the interface.

    Nothing in Blender's data changes before the run has succeeded, so that errors and Esc leave everything as it was.
    """

    image: bpy.props.StringProperty(
        name="Image", description="Name of the image; empty for the active plate", options={"SKIP_SAVE"}
    )
    clip: bpy.props.StringProperty(
        name="Movie Clip", description="Name of the movie clip; empty for the active plate", options={"SKIP_SAVE"}
    )
    apply: bpy.props.EnumProperty(name="Apply As", description="What becomes of the response", items=APPLY_MODES)

    is_estimated = False

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run to the end."""
        try:
            request = self._request(context)
            return self._finished(context, request, lazy_import.load(".work.run").run(request, _ignore))
        except expected_errors() as problem:
            return self._failed(problem)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Start a run in another thread and watch it."""
        try:
            self._job = self._request(context)
            pipeline = lazy_import.load(".work.run")
        except expected_errors() as problem:
            return self._failed(problem)
        self._task = Task(lambda progress: pipeline.run(self._job, progress))
        manager = context.window_manager
        self._timer = manager.event_timer_add(TICK, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        self._show(context)
        self._task.start()
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show how far the run is, cancel it on Esc, apply it once it is through."""
        if event.type == "ESC" and event.value == "PRESS":
            self._task.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        self._show(context)
        if self._task.is_running:
            return {"PASS_THROUGH"}
        self._hide(context)
        try:
            return self._finished(context, self._job, self._task.result())
        except expected_errors() as problem:
            return self._failed(problem)

    def cancel(self, context: bpy.types.Context) -> None:
        """Stop when Blender closes or opens another file."""
        self._task.cancel()
        self._hide(context)

    def _request(self, context: bpy.types.Context) -> Request:
        """Return what to do; choices given in the call come before the plate's."""
        datablock = plates.chosen_datablock(context, self.image, self.clip)
        if self.is_estimated and not stored_estimate.is_stored(datablock):
            raise AddonError(f"{datablock.name}: has no estimate yet; estimate its response first")
        chosen = {name: getattr(self, name) for name in CHOICES if self.properties.is_property_set(name)}
        return request_for(datablock, is_estimated=self.is_estimated, choices=chosen)

    def _finished(self, context: bpy.types.Context, request: Request, outcome: Any) -> set[str]:
        """Apply the outcome and say so."""
        done = lazy_import.load(".scene.apply").finish(context, request, outcome)
        kind = "WARNING" if outcome.estimate.warnings or outcome.estimate.verdict == "do not trust" else "INFO"
        self.report({kind}, f"{request.plate.name}: response is {outcome.estimate.verdict}; {done}")
        return {"FINISHED"}

    def _failed(self, problem: Exception) -> set[str]:
        """Say why nothing was done."""
        self.report({"WARNING" if isinstance(problem, CancelledError) else "ERROR"}, str(problem))
        return {"CANCELLED"}

    def _show(self, context: bpy.types.Context) -> None:
        """Show the progress in the status bar."""
        share = 100 * self._task.done // max(1, self._task.total)
        what = "Cancelling" if self._task.is_cancelled else f"Camera response: {share} %  |  Esc to cancel"
        context.workspace.status_text_set(what)
        context.window_manager.progress_update(share)

    def _hide(self, context: bpy.types.Context) -> None:
        """Take the progress away."""
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


class CRF_OT_estimate_response(PlateOperator, bpy.types.Operator):
    """Estimate the camera's response from the active photograph or frame sequence, and apply it."""

    bl_idname = "crf.estimate_response"
    bl_label = "Estimate Camera Response"
    bl_description = "Estimate the camera's response from the photograph or frame sequence, and apply it"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether there is a plate, and say why not; scripts outside the editors name theirs."""
        if context.area is None or context.area.type not in plates.EDITORS:
            return True
        datablock = plates.active_datablock(context)
        why = plates.OPEN_A_PLATE[context.area.type] if datablock is None else plates.obstacle(datablock)
        if why:
            cls.poll_message_set(why)
        return not why


class CRF_OT_apply_response(PlateOperator, bpy.types.Operator):
    """Apply the response that was estimated for the active plate, with the present settings."""

    bl_idname = "crf.apply_response"
    bl_label = "Apply Camera Response"
    bl_description = "Apply the response that was estimated for this plate again, with the present settings"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    is_estimated = True

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the plate has an estimate, and say why not; scripts outside the editors name theirs."""
        if context.area is None or context.area.type not in plates.EDITORS:
            return True
        if stored_estimate.is_stored(plates.active_datablock(context)):
            return True
        cls.poll_message_set("Estimate the camera response of a plate first")
        return False


class CRF_OT_restore_config(bpy.types.Operator):
    """Put back the OpenColorIO config that was there before the add-on added colour spaces."""

    bl_idname = "crf.restore_config"
    bl_label = "Restore OpenColorIO Config"
    bl_description = "Put back the OpenColorIO config that was there before the add-on added colour spaces"

    folder: bpy.props.StringProperty(
        name="Folder", description="Of the config; empty for Blender's colour management folder", subtype="DIR_PATH"
    )

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """Restore, and say what is there now."""
        folder: Path = absolute(self.folder) or color_management.user_folder()
        try:
            self.report({"INFO"}, lazy_import.load("ocio.configs.installed").restore(folder))
        except expected_errors() as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        return {"FINISHED"}


def _ignore(_done: int, _total: int) -> None:
    """Show no progress."""


_CLASSES = (CRF_OT_estimate_response, CRF_OT_apply_response, CRF_OT_restore_config)


def register() -> None:
    """Register the operators."""
    for kind in _CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    """Take them back."""
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
