# SPDX-License-Identifier: GPL-3.0-or-later
"""The sub-panel "More", closed at first."""

from __future__ import annotations

import bpy

from ...scene import plates, stored_estimate
from .add_look import CRF_OT_add_look
from .load_lut import CRF_OT_load_lut
from .other_plates import CRF_OT_copy_response


def draw_more(layout: bpy.types.UILayout, datablock: plates.Datablock) -> None:
    """Draw further uses of the response of a plate, and the button that loads one."""
    header, body = layout.panel("CRF_more", default_closed=True)
    header.label(text="More")
    if body is None:
        return
    column = body.column(align=True)
    column.operator(CRF_OT_load_lut.bl_idname, icon="FILE_FOLDER")
    if not stored_estimate.is_stored(datablock):
        return
    column.operator(CRF_OT_add_look.bl_idname, icon="CAMERA_DATA")
    column.operator(CRF_OT_copy_response.bl_idname, icon="DUPLICATE")
