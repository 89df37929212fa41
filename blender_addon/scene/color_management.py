# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenColorIO config that this Blender runs on, and its colour spaces."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from .. import lazy_import
from ..work.job import CONFIG_VARIABLES

#: The name under which Blender looks for a config. It is
#: `crfnet.defaults.CONFIG_NAME` again, because `crfnet` comes as a wheel, and the add-on has to start without it.
CONFIG_NAME = "config.ocio"


def color_spaces() -> list[str]:
    """Return the names that the colour space of an image or clip can have in this session."""
    return bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()


def data_space() -> str:
    """Return the name of the colour space that leaves pixels as they are; in Blender's own config, "Non-Color".

    Raises
    ------
    ConfigError
        If the config of this session has none, or cannot be read.
    """
    if "Non-Color" in color_spaces():
        return "Non-Color"
    return lazy_import.load("crfnet.configs.files").role_name(running_config(), "data")


def environment_config() -> str:
    """Return the config that the environment demands instead of the user's or Blender's own; empty if none.

    Blender 5.2 itself sets the variable OCIO to the config that it has found, which demands nothing.
    """
    names = CONFIG_VARIABLES[::-1] if bpy.app.version >= (5, 0, 0) else CONFIG_VARIABLES[:1]
    demanded = next((os.environ[name] for name in names if os.environ.get(name)), "")
    is_usual = demanded and Path(demanded).resolve() in (own_config().resolve(), _user_config().resolve())
    return "" if is_usual else demanded


def user_folder() -> Path:
    """Return the folder in which Blender looks for the user's config when it starts; it may not exist."""
    return Path(bpy.utils.user_resource("DATAFILES", path="colormanagement"))


def running_config() -> str:
    """Return the config that this Blender was started with: the environment's, the user's or Blender's own."""
    return environment_config() or str(_user_config() if _user_config().is_file() else own_config())


def _user_config() -> Path:
    """Return the file of the user's config, which may not exist."""
    return user_folder() / CONFIG_NAME


def own_config() -> Path:
    """Return the config that comes with Blender."""
    return Path(bpy.utils.system_resource("DATAFILES", path="colormanagement"), CONFIG_NAME)
