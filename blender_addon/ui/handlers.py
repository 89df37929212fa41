# SPDX-License-Identifier: GPL-3.0-or-later
"""Handlers for opening, importing from and saving a .blend file, and for undo.

Before a file is saved and around undo, editors that show a linear plate for comparison go back to the plate, so that it
is never saved. The code values of plates that were packed are packed, too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import bpy

from .. import lazy_import
from ..scene import code_values, node_links
from ..work.errors import expected_errors
from .image_editor import comparison


@bpy.app.handlers.persistent
def end_comparisons(*_arguments: Any) -> None:
    """Show plates again where the linear plate is shown."""
    comparison.end_all()


@bpy.app.handlers.persistent
def note_files_as_read(_path: str = "") -> None:
    """Note that the code values of all plates are from their present files, which Blender has just read."""
    code_values.note_files_as_read()


@bpy.app.handlers.persistent
def rename_color_spaces(_path: str = "") -> None:
    """Give the color spaces of a file that may have been made under another config the names of the present one."""
    if node_links.has_groups():
        try:
            lazy_import.load(".scene.color_space_names").rename_color_spaces()
        except expected_errors() as problem:
            sys.stderr.write(f"Camera response: {problem}\n")


@bpy.app.handlers.persistent
def pack_code_values(*_arguments: Any) -> None:
    """Pack the code values of plates that have been packed."""
    code_values.pack_with_plates()


#: The handlers: Blender's name of the occasion, and the function.
_HANDLERS: tuple[tuple[str, Callable[..., None]], ...] = (
    ("load_post", end_comparisons),
    ("load_post", rename_color_spaces),
    ("blend_import_post", rename_color_spaces),
    ("load_post", note_files_as_read),
    ("save_pre", pack_code_values),
    ("save_pre", end_comparisons),
    ("undo_pre", end_comparisons),
    ("undo_post", end_comparisons),
    ("redo_pre", end_comparisons),
    ("redo_post", end_comparisons),
)


def register() -> None:
    """Add the handlers."""
    for name, function in _HANDLERS:
        getattr(bpy.app.handlers, name).append(function)


def unregister() -> None:
    """Remove the handlers."""
    for name, function in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(function)
