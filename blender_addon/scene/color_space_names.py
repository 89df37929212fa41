# SPDX-License-Identifier: GPL-3.0-or-later
"""Rename the color spaces of the add-on's images and nodes in a file that was made under another OpenColorIO config.

Blender takes a name that the present config lacks for sRGB, without a word.
"""

import bpy

from .color_management import data_space
from .nodes.links import LOOK, PLATE
from .nodes.look_group import srgb
from .nodes.plate_group import linear_rec709, set_working_space, working_space
from .plates import CODE_VALUES_OF, SHADER


def rename_color_spaces() -> None:
    """Take code values for data, and give all Convert Colorspace nodes of the add-on the names of the present config.

    Linked ones, too, since a file does not save their names. Raise ConfigError if the config lacks a space.
    """
    for copy in (*bpy.data.images, *bpy.data.movieclips):
        if CODE_VALUES_OF in copy and not copy.colorspace_settings.is_data:
            copy.colorspace_settings.name = data_space()
    linear, working = linear_rec709(), working_space()
    for group in bpy.data.node_groups:
        if PLATE in group and group.bl_idname == SHADER:
            set_working_space(group)
        elif PLATE in group:
            _convert(group, (linear, working))
        elif LOOK in group:
            _convert(group, (working, linear), (srgb(), working))


def _convert(group: bpy.types.NodeTree, *conversions: tuple[str, str]) -> None:
    """Set source and target of the Convert Colorspace nodes of a group, in the order in which they were made."""
    nodes = [node for node in group.nodes if node.bl_idname == "CompositorNodeConvertColorSpace"]
    for node, (source, target) in zip(nodes, conversions, strict=True):
        node.from_color_space, node.to_color_space = source, target
