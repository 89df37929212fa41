# SPDX-License-Identifier: GPL-3.0-or-later
"""The base of operators: when they can run, the plate that a script names, and how they report a problem."""

from typing import Any, ClassVar

import bpy

from ..scene import plates, stored_estimate
from ..work.errors import AddonError, CancelledError
from ..work.wording import problem_line
from . import running

#: Why nothing can be done with the response of a plate that has none.
NO_ESTIMATE = "Estimate the camera response of a plate first"


class ChosenPlate:
    """An operator on one plate, with the arguments that name it; they are empty for the active plate."""

    image: bpy.props.StringProperty(
        name="Image", description="Name of the image; empty for the active plate", options={"HIDDEN", "SKIP_SAVE"}
    )
    clip: bpy.props.StringProperty(
        name="Movie Clip", description="Name of the clip; empty for the active plate", options={"HIDDEN", "SKIP_SAVE"}
    )

    bl_options: ClassVar[set[str]] = {"UNDO"}

    #: Whether the plate must have a response.
    needs_estimate = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether it can run on the editor's plate now, and tell why if not; a script names its plate."""
        why_not = running.why_busy()
        if context.area is not None and context.area.type in plates.EDITORS:  # not where a script runs
            why_not = why_not or cls.why_not(context)
        return is_allowed(cls, why_not)

    @classmethod
    def why_not(cls, context: bpy.types.Context) -> str:
        """Return why the operator cannot run on the plate of an editor, or an empty text."""
        if cls.needs_estimate:
            return "" if stored_estimate.is_stored(plates.active_datablock(context)) else NO_ESTIMATE
        return plates.obstacle_in(context)

    def chosen_plate(self, context: bpy.types.Context) -> plates.Datablock:
        """Return the image or clip; an AddonError if there is none, or it lacks a response that it needs."""
        datablock = plates.chosen_datablock(context, self.image, self.clip)
        if self.needs_estimate and not stored_estimate.is_stored(datablock):
            raise AddonError(f"{datablock.name}: has no estimate yet; estimate its response first")
        return datablock


def is_allowed(operator: Any, why_not: str) -> bool:
    """Return whether an operator can run; its tooltip gives the reason if not."""
    if why_not:
        operator.poll_message_set(why_not)
    return not why_not


def why_unchangeable(context: bpy.types.Context) -> str:
    """Return why no settings of an editor's plate can be changed, or an empty text."""
    datablock = plates.active_datablock(context)
    return plates.OPEN_A_PLATE[context.space_data.type] if datablock is None else plates.why_unchangeable(datablock)


def failed(operator: bpy.types.Operator, problem: Exception) -> set[str]:
    """Report why an operator did nothing, and return its result; that the user canceled is not an error."""
    operator.report({"INFO" if isinstance(problem, CancelledError) else "ERROR"}, problem_line(problem))
    return {"CANCELLED"}
