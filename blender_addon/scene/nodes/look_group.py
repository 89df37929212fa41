# SPDX-License-Identifier: GPL-3.0-or-later
"""The response as a compositor node group, "Camera Look": from scene-linear light to the code values of the plate.

RGB Curves nodes have a step at every sample of the response f, which is linear between them, so the result is exact.
Then the code values are taken for sRGB and converted to the working space: the view transform Standard undoes this, on
screen and in files that are saved with it. A second output has the code values themselves, for the view transform Raw.
"""

from itertools import pairwise

import bpy
import numpy as np

from crfnet.errors import ConfigError
from crfnet_core import ResponseCurve
from crfnet_core.response.curve import SAMPLES

from .. import stored_estimate
from ..color_management import color_spaces
from ..plates import Datablock
from .building import GAP, WIDTH, NodeGrid, activate
from .curves import STEPS, add_curves
from .links import LOOK, groups_of, holds_group_of, output_of
from .plate_group import by_channel, linear_rec709, made_for, new_group, working_space

CODE_VALUES = "Code Values"  # the output of the group that has them
_ENDS = [end / (SAMPLES - 1) for end in range(0, SAMPLES + 1, STEPS)]  # of the parts of light; the last lies beyond 1

#: Names of sRGB, the encoding of displays, in common configs.
SRGB = ("sRGB", "sRGB Encoded Rec.709 (sRGB)", "sRGB - Texture", "Utility - sRGB - Texture")


def add_look(tree: bpy.types.NodeTree, plate: Datablock, name: str, curve: ResponseCurve, exposure: float) -> None:
    """Put the plate's "Camera Look <name>" before the output of a compositor tree, in place of an earlier look.

    It takes back the exposure, in stops, of the plate's linearizing group, or `exposure` if the tree has none. Without
    an output, it is not linked. Raise ConfigError, and change nothing, if the config lacks linear Rec.709 or sRGB.
    """
    group = _build(plate, name, curve)
    linearizing = (node for node in tree.nodes if holds_group_of(node, plate))
    node = _node_before_output(tree, group)
    node.node_tree, node.mute = group, False
    node.inputs["Exposure"].default_value = next((n.inputs["Exposure"].default_value for n in linearizing), exposure)
    activate(node)


def update_look(scene: bpy.types.Scene, plate: Datablock, curve: ResponseCurve, exposure: float) -> None:
    """Bring the plate's look up to date, and its nodes but for those of other scenes; nothing if it has none."""
    if made_for(plate, LOOK) is not None:
        _build(plate, "", curve)
    for node in groups_of(plate, scene, LOOK):
        node.inputs["Exposure"].default_value = exposure


def _build(plate: Datablock, name: str, curve: ResponseCurve) -> bpy.types.NodeTree:
    """Return the plate's look; one that exists already is updated."""
    linear, srgb_space, working = linear_rec709(), srgb(), working_space()
    group = made_for(plate, LOOK)
    if group is None:
        group = new_group(plate, f"Camera Look {name}", LOOK, "Exposure of the linear plate in stops, taken back here")
        codes = group.interface.new_socket(CODE_VALUES, in_out="OUTPUT", socket_type="NodeSocketColor")
        codes.description = "For the view transform Raw, and for files without color management"
        group.interface.items_tree["Image"].description = "For the view transform Standard on an sRGB display"
    group.nodes.clear()
    grid = NodeGrid(group)
    start, end = grid.node("NodeGroupInput", 0), grid.node("NodeGroupOutput", 15)
    straight = grid.convert_alpha(start.outputs["Image"], 1, is_multiplied=False)
    light = grid.node("CompositorNodeExposure", 3)
    grid.link(grid.convert_color_space(working, linear, straight, 2), light.inputs["Image"])
    grid.link(grid.math("MULTIPLY", 2, 1, start.outputs["Exposure"], -1), light.inputs["Exposure"])
    exposed, matrix = light.outputs[0], stored_estimate.matrix(plate)
    if matrix is not None:
        exposed = by_channel(grid, exposed, np.asarray(np.linalg.inv(matrix), float), 4)
    codes = add_curves(grid, exposed, curve.forward, list(pairwise(_ENDS)), 9)
    grid.link(grid.convert_alpha(codes, 14, is_multiplied=True), end.inputs[CODE_VALUES])
    shown = grid.convert_color_space(srgb_space, working, codes, 13)
    grid.link(grid.convert_alpha(shown, 14, is_multiplied=True), end.inputs["Image"])
    return group


def srgb() -> str:
    """Return the name of sRGB in the config of this session."""
    known = [name for name in SRGB if name in color_spaces()]
    if known:
        return known[0]
    raise ConfigError("this config has no sRGB space, which the look needs; use Blender's own config")


def _node_before_output(tree: bpy.types.NodeTree, group: bpy.types.NodeTree) -> bpy.types.Node:
    """Return the look, of whatever plate, that leads to the output of a tree; else a new node of a look.

    A new one stands between the output, with its viewers, and the node that leads to it.
    """
    output = output_of(tree)
    source = output.inputs[0].links[0].from_socket if output is not None and output.inputs[0].links else None
    if source is not None and LOOK in (getattr(source.node, "node_tree", None) or {}):
        return source.node
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree, node.width = group, WIDTH
    if output is None:
        return node
    node.location = output.location
    output.location.x += WIDTH + GAP
    viewers = [] if source is None else [link.to_socket for link in source.links if link.to_node.type == "VIEWER"]
    for target in (output.inputs[0], *viewers):
        tree.links.new(node.outputs["Image"], target)
    if source is not None:
        tree.links.new(source, node.inputs["Image"])
    return node
