"""The add-on's runs: install and remove it, start it as a script does, see whether it runs and when it ended."""

from __future__ import annotations

import bpy
import editors

#: The add-on's identifier, and its module once it is installed.
IDENTIFIER, MODULE = "crf_response", "bl_ext.user_default.crf_response"

#: Seconds between two looks at whether a run has ended: at every turn of Blender's main loop, so that none is missed.
INTERVAL = 0.0

#: What was seen of the run that is watched: "started", "ended".
_seen: set[str] = set()


def install(path: str) -> bool:
    """Install the extension from its zip, as by dropping it on the window; return whether it is enabled."""
    bpy.ops.extensions.package_install_files(filepath=path, repo="user_default", enable_on_install=True)
    bpy.ops.wm.save_userpref()
    return MODULE in bpy.context.preferences.addons


def uninstall() -> None:
    """Uninstall the extension, as by its button in the preferences."""
    repositories = [repository.module for repository in bpy.context.preferences.extensions.repos]
    bpy.ops.extensions.package_uninstall(repo_index=repositories.index("user_default"), pkg_id=IDENTIFIER)
    bpy.ops.wm.save_userpref()


def disable() -> None:
    """Disable the add-on, as by its checkbox in the preferences."""
    bpy.ops.preferences.addon_disable(module=MODULE)


def running() -> list[str]:
    """Return the add-on's operators that run in the window."""
    known = [found for found in editors.window().modal_operators if found is not None]  # None: of a disabled add-on
    return [found.bl_idname for found in known if found.bl_idname.startswith("CRF_OT")]


def can_run() -> bool:
    """Return whether an estimate may be started in the Image Editor."""
    with editors.context("IMAGE_EDITOR"):
        return bpy.ops.crf.estimate_response.poll()


def watch() -> None:
    """Note that the next run starts and ends."""
    _seen.clear()

    def look() -> float | None:
        if running():
            _seen.add("started")
        elif "started" in _seen:
            _seen.add("ended")
            return None
        return INTERVAL

    bpy.app.timers.register(look)


def has_started() -> bool:
    """Return whether the run that is watched was seen."""
    return "started" in _seen


def has_ended() -> bool:
    """Return whether the run that is watched was seen to end."""
    return "ended" in _seen


def quit() -> None:
    """End Blender, without a question."""
    with bpy.context.temp_override(window=editors.window()):
        bpy.ops.wm.quit_blender()
