# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators: gather a job, run it, apply its result to the scene, report.

They have no panel "Adjust Last Operation" (REGISTER): it would show the arguments of the call instead of the plate's
settings, and estimate the response anew, in the main thread, at every change.
"""

from typing import TYPE_CHECKING, Any

import bpy

from .. import lazy_import
from ..scene import plates, stored_estimate
from ..work.errors import AddonError, expected_errors
from ..work.wording import report_line
from . import running
from .image_editor import comparison
from .operator_base import ChosenPlate, failed
from .plate_settings import CHOICES, PlateChoices, remember_applied
from .preferences import APPLY_MODES

if TYPE_CHECKING:
    from ..work.job import Job
    from ..work.run import CompletedJob

#: The report on an estimate that is not applied because it is not to be trusted.
WITHHELD = "not applied; to use it all the same, press Apply Anyway (anyway=True)"


class PlateOperator(ChosenPlate, PlateChoices):
    """The base of "Estimate Camera Response" and "Apply Camera Response".

    A script calls `execute`; the interface calls `invoke`, and then `modal` at every event. Either way, nothing in
    Blender's data changes before the job has succeeded, so an error or Esc leaves everything as it was.
    """

    anyway: bpy.props.BoolProperty(
        name="Anyway", description="Apply the response even if it is not to be trusted", options={"SKIP_SAVE"}
    )

    if TYPE_CHECKING:  # of bpy.types.Operator
        properties: Any
        report: Any

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run the job, and return when it is done."""
        try:
            job = self._gather_job(context)
            return self._apply(context, lazy_import.load(".work.run").run(job), withheld="ERROR")
        except expected_errors() as problem:
            return failed(self, problem)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Start the job in another thread, and a timer that watches it."""
        try:
            job = self._gather_job(context)
            run = lazy_import.load(".work.run").run
        except expected_errors() as problem:
            return failed(self, problem)
        context.window_manager.modal_handler_add(self)
        doing = "Applying" if self.needs_estimate else "Estimating"
        self._run = running.start(context, job.plate.name, lambda progress: run(job, progress), doing=doing)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show the progress; cancel the job on Esc; apply its result when it has ended."""
        if event.type == "ESC" and event.value == "PRESS":
            self._run.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self._run.task.is_alive():
            self._run.show()
            return {"PASS_THROUGH"}
        self._run.end()
        try:
            return self._apply(context, self._run.task.result())
        except expected_errors() as problem:
            return failed(self, problem)

    def cancel(self, _context: bpy.types.Context) -> None:
        """Cancel the job, because Blender closes or opens another file."""
        self._run.task.cancelled.set()
        self._run.end()

    def _gather_job(self, context: bpy.types.Context) -> "Job":
        """Return the job; arguments of the call take precedence over the settings of the plate."""
        datablock = self.chosen_plate(context)
        is_doubted = self.needs_estimate and stored_estimate.verdict(datablock) == stored_estimate.DO_NOT_TRUST
        if is_doubted and not self.anyway:
            raise AddonError(f"{datablock.name}: the response is not to be trusted; {WITHHELD}")
        arguments = {name: getattr(self, name) for name in CHOICES if self.properties.is_property_set(name)}
        if not self.needs_estimate:
            arguments.setdefault("apply", "ESTIMATE")
        gather_job = lazy_import.load(".ui.gather").gather_job
        return gather_job(datablock, arguments, is_estimated=self.needs_estimate, despite_verdict=self.anyway)

    def _apply(self, context: bpy.types.Context, completed: "CompletedJob", withheld: str = "WARNING") -> set[str]:
        """Apply a completed job to the scene, and report what was done; if nothing, as a problem of a kind."""
        with comparison.same_view(context):
            comparison.end_all()
            done = lazy_import.load(".scene.apply").apply(context, completed)
        if completed.is_applied:
            remember_applied(plates.datablock_of_plate(completed.job.plate), completed)
        running.redraw_editors(context.window_manager)
        if completed.problem is not None:  # the estimate is stored, so this is a step that can be undone
            failed(self, completed.problem)
            return {"FINISHED"}
        message = report_line(completed.job.plate.name, completed.estimate, WITHHELD if completed.is_withheld else done)
        self.report({withheld if completed.is_withheld else "WARNING" if completed.is_doubtful else "INFO"}, message)
        return {"FINISHED"}


class CRF_OT_estimate_response(PlateOperator, bpy.types.Operator):
    """Estimate the camera's response from the active photograph, sequence or movie; a script can have it applied."""

    bl_idname = "crf.estimate_response"
    bl_label = "Estimate Camera Response"
    bl_description = (
        "Estimate the camera's response from the photograph, sequence or movie. Nothing else changes until you apply it"
    )

    apply: bpy.props.EnumProperty(
        name="Apply As",
        description="What becomes of the response",
        items=(("ESTIMATE", "Estimate Only", "Change nothing else"), *APPLY_MODES),
    )


class CRF_OT_apply_response(PlateOperator, bpy.types.Operator):
    """Apply the response that was estimated for the active plate, with the present settings."""

    bl_idname = "crf.apply_response"
    bl_label = "Apply Camera Response"
    bl_description = "Apply the response that was estimated for this plate, with the present settings"

    apply: bpy.props.EnumProperty(name="Apply As", description="What becomes of the response", items=APPLY_MODES)

    needs_estimate = True

    @classmethod
    def why_not(cls, context: bpy.types.Context) -> str:
        """Return that the plate has no estimate, or why this cannot be applied."""
        return super().why_not(context) or plates.obstacle_in(context)


class CRF_OT_cancel_run(bpy.types.Operator):
    """Cancel the estimate that is running."""

    bl_idname = "crf.cancel_run"
    bl_label = "Cancel"
    bl_description = "Cancel the run; nothing is changed then"

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        """Return whether there is a run."""
        return running.current is not None

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """Ask the run to stop; the operator that started it reports when it has."""
        if run := running.current:
            run.cancel()
        return {"FINISHED"}


register, _unregister_classes = bpy.utils.register_classes_factory(
    (CRF_OT_estimate_response, CRF_OT_apply_response, CRF_OT_cancel_run)
)


def unregister() -> None:
    """Cancel what runs, and unregister the operators."""
    running.stop()
    _unregister_classes()
