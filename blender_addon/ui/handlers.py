# SPDX-License-Identifier: GPL-3.0-or-later
"""What happens when a .blend file is opened: plates get the colour space for which Blender had to be restarted."""

from __future__ import annotations

import bpy

from ..scene import color_management, stored_estimate


@bpy.app.handlers.persistent
def set_pending_color_spaces(_path: str = "") -> None:
    """Set the colour space of every plate that waits for one that this session has."""
    available = color_management.color_spaces()
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        if name := stored_estimate.pop_pending_color_space(datablock, available):
            datablock.colorspace_settings.name = name


def register() -> None:
    """Add the handler."""
    bpy.app.handlers.load_post.append(set_pending_color_spaces)


def unregister() -> None:
    """Remove the handler."""
    bpy.app.handlers.load_post.remove(set_pending_color_spaces)
