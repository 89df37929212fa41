# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimate Camera Response: from a photograph to its camera's response and the linear plate, inside Blender.

Nothing here imports the estimator while Blender starts: see `libraries`.
"""

from . import handlers, operators, panels, preferences, settings

_MODULES = (preferences, settings, operators, panels, handlers)


def register() -> None:
    """Register everything; Blender calls this."""
    for module in _MODULES:
        module.register()


def unregister() -> None:
    """Take everything back; Blender calls this."""
    for module in reversed(_MODULES):
        module.unregister()
