# SPDX-License-Identifier: GPL-3.0-or-later
"""After a restart, give plates the colour space that they have been waiting for."""

from __future__ import annotations

import bpy

from ..scene import color_management, stored_estimate


@bpy.app.handlers.persistent
def set_pending_color_spaces(_path: str = "") -> None:
    """Set the colour space of every plate that waits for one which this session has."""
    known = color_management.color_spaces()
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        is_stored = stored_estimate.is_stored(datablock)
        name = stored_estimate.recall(datablock, stored_estimate.PENDING) if is_stored else None
        if name in known:
            datablock.colorspace_settings.name = name
            stored_estimate.forget(datablock, stored_estimate.PENDING)


def register() -> None:
    """Listen for opened files."""
    bpy.app.handlers.load_post.append(set_pending_color_spaces)


def unregister() -> None:
    """Listen no more."""
    bpy.app.handlers.load_post.remove(set_pending_color_spaces)
