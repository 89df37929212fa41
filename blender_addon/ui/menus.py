# SPDX-License-Identifier: GPL-3.0-or-later
"""The entries of the menus Image, Clip and Node, by which Blender's search finds the operators, too."""

from __future__ import annotations

import bpy

from .operators import CRF_OT_apply_response, CRF_OT_estimate_response

#: The menus of the three editors.
MENUS = ("IMAGE_MT_image", "CLIP_MT_clip", "NODE_MT_node")


def draw_entries(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Draw the entries; the node editor has them only as the compositor."""
    space = context.space_data
    if space is not None and space.type == "NODE_EDITOR" and space.tree_type != "CompositorNodeTree":
        return
    menu.layout.separator()
    menu.layout.operator(CRF_OT_estimate_response.bl_idname, icon="CAMERA_DATA")
    menu.layout.operator(CRF_OT_apply_response.bl_idname, icon="CHECKMARK")


def register() -> None:
    """Add the entries."""
    for name in MENUS:
        getattr(bpy.types, name).append(draw_entries)


def unregister() -> None:
    """Remove the entries."""
    for name in MENUS:
        getattr(bpy.types, name).remove(draw_entries)
