# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimate Camera Response: from a photograph to its camera's response and the linear plate, inside Blender.

ui           operators, panel, settings, preferences; gathers a job from Blender
scene        Blender's data, read and changed: plates, node groups, stored estimates
work         a job in its own thread: estimate and write files; no module of it imports bpy
lazy_import  loads the modules that need the estimator, when they are first used
build        builds the zips of the extension

`ui` may import `scene`, and both may import `work`. No room is imported before `register`, so that `work` can be
imported without Blender. Registering does not import the estimator: see `lazy_import`.
"""

from types import ModuleType


def register() -> None:
    """Register the classes, properties and handlers; Blender calls this when the add-on is enabled."""
    for module in _registered():
        module.register()


def unregister() -> None:
    """Undo `register`; Blender calls this when the add-on is disabled."""
    for module in reversed(_registered()):
        module.unregister()


def _registered() -> tuple[ModuleType, ...]:
    """Return the modules with something to register, in order: the settings use the preferences."""
    from .ui import camera_response, estimate_box, handlers, operators, panel, plate_settings, preferences
    from .ui.image_editor import image_tools
    from .ui.more import load_lut, looks, other_plates

    tools = (operators, image_tools, looks, load_lut, other_plates)
    return (preferences, plate_settings, camera_response, *tools, estimate_box, panel, handlers)
