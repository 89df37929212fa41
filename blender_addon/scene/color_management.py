# SPDX-License-Identifier: GPL-3.0-or-later
"""The OpenColorIO config that this Blender runs on, its color spaces, and the scene's view transform."""

import os
from pathlib import Path

import bpy

from .. import lazy_import

CONFIG_NAME = "config.ocio"  # by which Blender looks for a config
CONFIG_VARIABLES = ("OCIO", "BLENDER_OCIO")  # that name Blender's config; Blender 4.5 knows the first only

#: The view transforms that undo the encoding of the display, in Blender's config and in ACES configs; and all, of
#: common configs, that do not darken a plate, or are not made for pictures.
STANDARD = ("Standard", "Un-tone-mapped")
NOT_DARKER = (*STANDARD, "Raw", "False Color", "Filmic Log")


def color_spaces() -> list[str]:
    """Return the names that the color space of an image or clip can have in this session."""
    return bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()


def data_space() -> str:
    """Return the name of the color space that leaves pixels as they are; in Blender's own config, "Non-Color".

    Raise ConfigError if the config of this session has none, or cannot be read.
    """
    if "Non-Color" in color_spaces():
        return "Non-Color"
    return lazy_import.load("crfnet.configs.sources").role_name(running_config(), "data")


def running_config() -> str:
    """Return the config that this Blender was started with: the environment's, the user's or Blender's own.

    Blender 5.2 itself sets the variable OCIO to its config.
    """
    names = CONFIG_VARIABLES[::-1] if bpy.app.version >= (5, 0, 0) else CONFIG_VARIABLES[:1]
    user = Path(bpy.utils.user_resource("DATAFILES", path="colormanagement"), CONFIG_NAME)
    own = Path(bpy.utils.system_resource("DATAFILES", path="colormanagement"), CONFIG_NAME)
    demanded = next((os.environ[name] for name in names if os.environ.get(name)), "")
    return demanded or str(user if user.is_file() else own)


def darker_view(scene: bpy.types.Scene) -> str:
    """Return the view transform of a scene if it shows a plate darker than it was photographed; else an empty text."""
    view = scene.view_settings.view_transform
    return "" if view in NOT_DARKER else view


def standard_view(scene: bpy.types.Scene) -> str:
    """Return which of `STANDARD` the config has for the scene's display; an empty text for none."""
    view, item_name = scene.view_settings, bpy.types.UILayout.enum_item_name
    return next((name for name in STANDARD if item_name(view, "view_transform", name)), "")


def set_standard_view(scene: bpy.types.Scene) -> str:
    """Show a scene by its `standard_view` and nothing else; return this view."""
    view, name = scene.view_settings, standard_view(scene)
    if name:
        view.view_transform, view.look, view.exposure, view.gamma = name, "None", 0, 1
        view.use_curve_mapping = view.use_white_balance = False
    return name
