# SPDX-License-Identifier: GPL-3.0-or-later
"""What colour management this Blender runs on."""

from __future__ import annotations

import os
import re
from pathlib import Path

import bpy

#: Names of colour spaces whose pixels are linear or logarithmic, for configs that give no encoding.
_LOG_OR_LINEAR = re.compile(r"linear|^lin_|aces|adx\d|\blog|log\w?\d?\b", re.IGNORECASE)

#: The file that Blender looks for.
CONFIG_NAME = "config.ocio"


def color_spaces() -> list[str]:
    """Return the names that an image's or clip's colour space can have in this session."""
    return bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()


def environment_config() -> str:
    """Return the config that the environment demands instead of the user's or Blender's own, or nothing.

    Blender 5.2 itself sets OCIO to the config that it has found.
    """
    names = ("BLENDER_OCIO", "OCIO") if bpy.app.version >= (5, 0, 0) else ("OCIO",)
    demanded = next((os.environ[name] for name in names if os.environ.get(name)), "")
    is_as_usual = demanded and Path(demanded).resolve() in (_own_config().resolve(), _user_config().resolve())
    return "" if is_as_usual else demanded


def user_folder() -> Path:
    """Return the folder in which Blender looks for the user's config at the start; it need not exist."""
    return Path(bpy.utils.user_resource("DATAFILES", path="colormanagement"))


def running_config() -> str:
    """Return the config that this Blender was started with: the environment's, the user's or Blender's own."""
    return environment_config() or str(_user_config() if _user_config().is_file() else _own_config())


def _user_config() -> Path:
    """Return the config that the user may have."""
    return user_folder() / CONFIG_NAME


def _own_config() -> Path:
    """Return the config that comes with Blender."""
    return Path(bpy.utils.system_resource("DATAFILES", path="colormanagement"), CONFIG_NAME)


def is_log_or_linear(color_space: str, encoding: str = "") -> bool:
    """Return whether pixels in a colour space are logarithmic or linear, by its encoding in the config or its name."""
    if encoding:
        return encoding in ("log", "scene-linear", "display-linear")
    return bool(_LOG_OR_LINEAR.search(color_space))
