# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers for opening, importing from and saving a .blend file, and for undo.

Before a file is saved and around undo, editors go back from the linear plate to the plate: it is never saved.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import bpy

from .. import lazy_import
from ..scene import code_values
from ..scene.nodes import links
from ..work.errors import expected_errors
from .image_editor import comparison


@bpy.app.handlers.persistent
def end_comparisons(*_arguments: Any) -> None:
    """Show plates again where the linear plate is shown."""
    comparison.end_all()


@bpy.app.handlers.persistent
def follow_frames(*_arguments: Any) -> None:
    """Show the linear plate of the present frame, where that of a sequence or movie is shown."""
    if comparison.is_frame_shown():
        comparison.renew_soon()


@bpy.app.handlers.persistent
def rename_color_spaces(*_arguments: Any) -> None:
    """Name the color spaces of a file, which may have been made under another config, as the present one does."""
    if links.has_groups():
        try:
            lazy_import.load(".scene.color_space_names").rename_color_spaces()
        except expected_errors() as problem:
            sys.stderr.write(f"Camera response: {problem}\n")


@bpy.app.handlers.persistent
def check_opened_file(*_arguments: Any) -> None:
    """Check color spaces, and note that the code values are from the present files, which Blender has just read."""
    comparison.end_all()
    rename_color_spaces()
    code_values.note_files_as_read()


@bpy.app.handlers.persistent
def prepare_saving(*_arguments: Any) -> None:
    """Pack the code values of plates that have been packed, and show no linear plate."""
    code_values.pack_with_plates()
    comparison.end_all()


#: The handlers: Blender's name of the occasion, and the function.
_HANDLERS: dict[str, Callable[..., None]] = {
    "load_post": check_opened_file,
    "blend_import_post": rename_color_spaces,
    "save_pre": prepare_saving,
    "frame_change_post": follow_frames,
    **dict.fromkeys(("undo_pre", "undo_post", "redo_pre", "redo_post"), end_comparisons),
}


def register() -> None:
    """Add the handlers."""
    for name, function in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(function)


def unregister() -> None:
    """Remove the handlers."""
    for name, function in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(function)
