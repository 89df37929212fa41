# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on has put into Blender's OpenColorIO config: list it, take it out, and restart Blender.

Blender reads its config once, at its start. So a restart is due while the user's config and its LUTs differ from what
they were when the add-on was first enabled in this session.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
from functools import lru_cache
from pathlib import Path
from typing import ClassVar

import bpy

from .. import lazy_import
from ..scene import color_management, stored_estimate
from ..work.errors import expected_errors
from ..work.job import CONFIG_VARIABLES
from .estimate_box import draw_text
from .image_editor import comparison
from .operator_base import failed
from .preferences import absolute

#: What Blender read at its start; set when the add-on is first enabled in a session.
_read_at_start: str | None = None

#: The file that says what was installed: `FOLDER` and `RECORD_NAME` of `crfnet.configs.installation_record`, repeated
#: because the interface is drawn without `crfnet`.
RECORD = Path("camera_response", "installed.json")

#: How many letters fit into a line of the preferences.
_LETTERS = 60


class CRF_OT_restore_config(bpy.types.Operator):
    """Put back the OpenColorIO config that was there before the add-on added color spaces."""

    bl_idname = "crf.restore_config"
    bl_label = "Restore OpenColorIO Config"
    bl_description = "Put back the OpenColorIO config that was there before the add-on added color spaces"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    folder: bpy.props.StringProperty(
        name="Folder",
        description="Folder of the config. Empty: Blender's color management folder",
        subtype="DIR_PATH",
        options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"},
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Restore the config, and report what was done."""
        try:
            folder = absolute(self.folder) or color_management.user_folder()
            names = _names(folder)
            restored = lazy_import.load("crfnet.configs.installed").restore(folder)
        except expected_errors() as problem:
            return failed(self, problem)
        _end_waits(names)
        _redraw(context)
        done = "removed, so Blender uses its own again" if restored.is_removed else "again as it was"
        self.report({"INFO"}, f"The config is {done} after a restart: {restored.config}")
        return {"FINISHED"}


class CRF_OT_remove_color_space(bpy.types.Operator):
    """Take one color space of the add-on out of Blender's OpenColorIO config."""

    bl_idname = "crf.remove_color_space"
    bl_label = "Remove Color Space"
    bl_description = "Take this color space and its LUT out of your OpenColorIO config; plates that use it lose it"
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    color_space: bpy.props.StringProperty(name="Color Space", options={"SKIP_SAVE"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Remove it, and report what was done."""
        try:
            lazy_import.load("crfnet.configs.installed").uninstall(color_management.user_folder(), self.color_space)
        except expected_errors() as problem:
            return failed(self, problem)
        _end_waits((self.color_space,))
        _redraw(context)
        self.report({"INFO"}, f'"{self.color_space}" is gone after a restart')
        return {"FINISHED"}


class CRF_OT_save_and_restart(bpy.types.Operator):
    """Save the file, and start Blender again with it."""

    bl_idname = "crf.save_and_restart"
    bl_label = "Save and Restart"
    bl_description = (
        "Save the file, quit, and start Blender again with it: Blender reads color spaces at its start only"
    )
    bl_options: ClassVar[set[str]] = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        """Return whether the file has a name to be saved under."""
        if not bpy.data.filepath:
            cls.poll_message_set("The file has no name yet: use File, Save As first")
        return bool(bpy.data.filepath)

    def execute(self, _context: bpy.types.Context) -> set[str]:
        """Save, start another Blender, and quit this one; quit nothing that was not saved."""
        comparison.end_all()
        if unsaved := next((image.name for image in bpy.data.images if image.is_dirty), ""):
            self.report({"ERROR"}, f"{unsaved}: has changes that would be lost; save or pack the image first")
            return {"CANCELLED"}
        try:
            bpy.ops.wm.save_mainfile()
            start_blender(bpy.data.filepath)
        except (RuntimeError, OSError) as problem:
            self.report({"ERROR"}, f"Blender was not restarted: {problem}")
            return {"CANCELLED"}
        bpy.ops.wm.quit_blender()
        return {"FINISHED"}


def start_blender(file: str) -> None:
    """Start another Blender with a file; raise an OSError if it cannot be started."""
    environment = dict(os.environ)
    if not color_management.environment_config():
        for name in CONFIG_VARIABLES:
            environment.pop(name, None)
    subprocess.Popen([bpy.app.binary_path, file], env=environment, start_new_session=True)


def is_restart_due() -> bool:
    """Return whether the user's config or a LUT of it differs from what Blender read at its start."""
    return _read_at_start is not None and _fingerprint() != _read_at_start


def draw_restart(layout: bpy.types.UILayout, letters: int, pending: str = "") -> None:
    """Draw that a restart is due, and the button that does it, or the one that must come before.

    Nothing is drawn while no restart is due and no color space is waited for, unless Blender was updated and still runs
    on a config that was built on its earlier version's.

    Parameters
    ----------
    layout : UILayout
        Gets a box.
    letters : int
        How many letters fit into a line.
    pending : str
        The color space that the plate waits for; empty if it waits for none.
    """
    if not is_restart_due():
        if missing := _missing(color_management.user_folder(), _fingerprint()):
            box = layout.box()
            draw_text(
                box,
                f"Blender runs on a config of its earlier version, which lacks {len(missing)} of its color spaces, such"
                f" as {missing[0]}. Restore its own, restart, and apply the plates' color spaces again.",
                letters,
                icon="ERROR",
            )
            box.operator(CRF_OT_restore_config.bl_idname, icon="LOOP_BACK")
        if pending:  # the environment names the config, so that Blender must be started with another one
            draw_text(layout, f'"{pending}" comes with a restart.', letters, icon="COLOR")
        return
    box = layout.box()
    draw_text(
        box, f'Restart due for "{pending}".' if pending else "Restart due for color spaces.", letters, icon="INFO"
    )
    if bpy.data.filepath:
        box.operator(CRF_OT_save_and_restart.bl_idname, icon="FILE_REFRESH")
        return
    draw_text(box, "Save the file first: it has no name yet.", letters)
    box.operator("wm.save_as_mainfile", text="Save As...", icon="FILE_TICK")


def draw_installed(layout: bpy.types.UILayout) -> None:
    """Draw the color spaces in the user's config, each with a button that removes it, and the button for all."""
    folder = color_management.user_folder()
    is_left_over = folder.is_dir() and not (folder / color_management.CONFIG_NAME).exists()  # Blender runs without AgX
    if is_left_over:
        layout.operator(CRF_OT_restore_config.bl_idname, icon="LOOP_BACK")
    elif (folder / RECORD).is_file():
        box = layout.box()
        box.label(text="In your OpenColorIO config", icon="COLOR")
        column = box.column(align=True)
        for name in _installed(folder, _fingerprint()):
            row = column.row(align=True)
            row.label(text=name)
            row.operator(CRF_OT_remove_color_space.bl_idname, text="", icon="X").color_space = name
        box.operator(CRF_OT_restore_config.bl_idname, icon="LOOP_BACK")
    draw_restart(layout, _LETTERS)


@lru_cache(maxsize=1)
def _installed(folder: Path, _fingerprint: str) -> tuple[str, ...]:
    """Return the names of the installed color spaces; the fingerprint makes a changed config be read again."""
    return _names(folder)


def _names(folder: Path) -> tuple[str, ...]:
    """Return the names of the color spaces that are installed in a folder; none if it cannot be read."""
    try:
        return lazy_import.load("crfnet.configs.installed").installed_color_spaces(folder)
    except expected_errors():
        return ()


def _end_waits(names: tuple[str, ...]) -> None:
    """Let no plate wait any longer for color spaces that were taken out of a config: no restart brings them."""
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        stored_estimate.pop_pending_color_space(datablock, names)


@lru_cache(maxsize=1)
def _missing(folder: Path, _fingerprint: str) -> tuple[str, ...]:
    """Return the color spaces of this Blender that the user's config lacks, if the add-on has built it."""
    if not (folder / RECORD).is_file() or color_management.environment_config():
        return ()
    try:
        installed = lazy_import.load("crfnet.configs.installed")
        return installed.missing_color_spaces(folder, color_management.own_config())
    except expected_errors():
        return ()


def _fingerprint() -> str:
    """Return a text that differs between different contents of the user's config and its LUTs."""
    folder = color_management.user_folder()
    files = [folder / color_management.CONFIG_NAME, *sorted((folder / RECORD.parent).glob("*.spi1d"))]
    states = [(path, path.stat()) for path in files if path.is_file()]
    return _digest(tuple((path, state.st_mtime_ns, state.st_size) for path, state in states))


@lru_cache(maxsize=8)
def _digest(states: tuple[tuple[Path, int, int], ...]) -> str:
    """Return the SHA-256 of files; they are read again only if their times or sizes have changed."""
    digest = hashlib.sha256()
    for path, _, _ in states:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def _redraw(context: bpy.types.Context) -> None:
    """Have all areas drawn again, as they may say that a restart is due."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            area.tag_redraw()


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (CRF_OT_restore_config, CRF_OT_remove_color_space, CRF_OT_save_and_restart)
)


def register() -> None:
    """Register the operators, and keep in mind what Blender read at its start."""
    global _read_at_start
    if _read_at_start is None:
        _read_at_start = _fingerprint()
    _register_classes()


def unregister() -> None:
    """Unregister the operators; what Blender read at its start stays in mind for the session."""
    _unregister_classes()
