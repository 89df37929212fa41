# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators share: the plate that a script names, and how they report a problem."""

import bpy

from ..scene import plates, stored_estimate
from ..work.errors import AddonError, CancelledError
from ..work.wording import american


class ChosenPlate:
    """The arguments of an operator that name its plate; the panel leaves them empty, for the active one."""

    image: bpy.props.StringProperty(
        name="Image", description="Name of the image; empty for the active plate", options={"HIDDEN", "SKIP_SAVE"}
    )
    clip: bpy.props.StringProperty(
        name="Movie Clip",
        description="Name of the movie clip; empty for the active plate",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    def chosen_plate(self, context: bpy.types.Context) -> plates.Datablock:
        """Return the image or clip; an AddonError if there is none."""
        return plates.chosen_datablock(context, self.image, self.clip)

    def estimated_plate(self, context: bpy.types.Context) -> plates.Datablock:
        """Return the image or clip, which must have a response; else an AddonError."""
        datablock = self.chosen_plate(context)
        if not stored_estimate.is_stored(datablock):
            raise AddonError(f"{datablock.name}: has no estimate yet; estimate its response first")
        return datablock


def failed(operator: bpy.types.Operator, problem: Exception) -> set[str]:
    """Report why an operator did nothing, and return its result; that the user cancelled is no error."""
    operator.report({"INFO" if isinstance(problem, CancelledError) else "ERROR"}, american(str(problem)))
    return {"CANCELLED"}
