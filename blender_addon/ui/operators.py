# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators: gather a job, run it, apply what it found to the scene, report."""

from typing import TYPE_CHECKING, Any, ClassVar

import bpy

from .. import lazy_import
from ..scene import color_management, plates, stored_estimate
from ..work.background import BackgroundTask
from ..work.errors import AddonError, CancelledError, expected_errors
from .plate_settings import CHOICES, PlateChoices
from .preferences import APPLY_MODES, absolute

if TYPE_CHECKING:
    from ..work.job import Job
    from ..work.run import CompletedJob

#: Seconds between two checks of how far the job is.
TICK = 0.1


class PlateOperator(PlateChoices):
    """What "Estimate Camera Response" and "Apply Camera Response" share.

    A script, and Blender in the background, calls `execute`, which returns when the job is done. The interface calls
    `invoke`, which starts the job in another thread, and then `modal` at every event. Either way, nothing in Blender's
    data changes before the job has succeeded, so an error or Esc leaves everything as it was.
    """

    image: bpy.props.StringProperty(
        name="Image", description="Name of the image; empty for the active plate", options={"SKIP_SAVE"}
    )
    clip: bpy.props.StringProperty(
        name="Movie Clip", description="Name of the movie clip; empty for the active plate", options={"SKIP_SAVE"}
    )
    apply: bpy.props.EnumProperty(name="Apply As", description="What becomes of the response", items=APPLY_MODES)

    #: Whether the operator uses the stored estimate instead of a new one.
    is_estimated = False

    if TYPE_CHECKING:  # of bpy.types.Operator
        properties: Any
        report: Any

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run the job, and return when it is done."""
        try:
            job = self._gather_job(context)
            return self._apply(context, lazy_import.load(".work.run").run(job))
        except expected_errors() as problem:
            return self._fail(problem)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Start the job in another thread, and a timer that watches it."""
        try:
            job = self._gather_job(context)
            run = lazy_import.load(".work.run").run
        except expected_errors() as problem:
            return self._fail(problem)
        self._task: BackgroundTask[CompletedJob] = BackgroundTask(lambda progress: run(job, progress))
        manager = context.window_manager
        self._timer = manager.event_timer_add(TICK, window=context.window)
        manager.progress_begin(0, 100)
        manager.modal_handler_add(self)
        self._show_progress(context)
        self._task.start()
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show the progress; cancel the job on Esc; apply what it found when it has ended."""
        if event.type == "ESC" and event.value == "PRESS":
            self._task.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        self._show_progress(context)
        if self._task.is_running:
            return {"PASS_THROUGH"}
        self._hide_progress(context)
        try:
            return self._apply(context, self._task.result())
        except expected_errors() as problem:
            return self._fail(problem)

    def cancel(self, context: bpy.types.Context) -> None:
        """Cancel the job, because Blender closes or opens another file."""
        self._task.cancel()
        self._hide_progress(context)

    def _gather_job(self, context: bpy.types.Context) -> "Job":
        """Return the job; arguments of the call take precedence over the settings of the plate."""
        datablock = plates.chosen_datablock(context, self.image, self.clip)
        if self.is_estimated and not stored_estimate.is_stored(datablock):
            raise AddonError(f"{datablock.name}: has no estimate yet; estimate its response first")
        arguments = {name: getattr(self, name) for name in CHOICES if self.properties.is_property_set(name)}
        gather = lazy_import.load(".ui.gather")
        return gather.gather_job(datablock, is_estimated=self.is_estimated, arguments=arguments)

    def _apply(self, context: bpy.types.Context, completed: "CompletedJob") -> set[str]:
        """Apply a completed job to the scene, and report what was done."""
        done = lazy_import.load(".scene.apply").apply(context, completed)
        message = f"{completed.job.plate.name}: response is {completed.estimate.verdict}; {done}"
        self.report({"WARNING"} if completed.is_doubtful else {"INFO"}, message)
        return {"FINISHED"}

    def _fail(self, problem: Exception) -> set[str]:
        """Report why nothing was done."""
        self.report({"WARNING" if isinstance(problem, CancelledError) else "ERROR"}, str(problem))
        return {"CANCELLED"}

    def _show_progress(self, context: bpy.types.Context) -> None:
        """Show the progress in the status bar and at the mouse pointer."""
        percent = self._task.percent
        text = "Cancelling" if self._task.is_cancelled else f"Camera response: {percent} %  |  Esc to cancel"
        context.workspace.status_text_set(text)
        context.window_manager.progress_update(percent)

    def _hide_progress(self, context: bpy.types.Context) -> None:
        """Remove the timer and the display of the progress."""
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
        """Return whether there is a plate, and tell why if not; outside the editors, a script names its plate."""
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
        """Return whether the plate has an estimate, and tell so if not; a script names its plate."""
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
        """Restore the config, and report what was done."""
        folder = absolute(self.folder) or color_management.user_folder()
        try:
            restored = lazy_import.load("ocio.configs.installed").restore(folder)
        except expected_errors() as problem:
            self.report({"ERROR"}, str(problem))
            return {"CANCELLED"}
        done = "removed, so Blender uses its own again" if restored.is_removed else "again as it was"
        self.report({"INFO"}, f"{restored.config} is {done}; restart Blender")
        return {"FINISHED"}


_CLASSES = (CRF_OT_estimate_response, CRF_OT_apply_response, CRF_OT_restore_config)


def register() -> None:
    """Register the operators."""
    for kind in _CLASSES:
        bpy.utils.register_class(kind)


def unregister() -> None:
    """Unregister the operators."""
    for kind in reversed(_CLASSES):
        bpy.utils.unregister_class(kind)
