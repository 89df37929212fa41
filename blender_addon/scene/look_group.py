# SPDX-License-Identifier: GPL-3.0-or-later
"""The response as a compositor node group, "Camera Look": from scene-linear light to the code values of the plate.

A Map UV node for each channel reads the nearest pixel k of an image of the response, which holds f at sample k and the
step to the next one; f is linear between its samples, so the result is exact. Then the code values are taken for sRGB
and converted to the working space: the view transform Standard undoes this, on screen and in files that are saved with
it. A second output has the code values themselves, for the view transform Raw.
"""

from __future__ import annotations

import bpy
import numpy as np

from crfnet.errors import ConfigError
from crfnet_core import ResponseCurve
from crfnet_core.response.curve import SAMPLES
from crfnet_core.types import Float64Array

from . import stored_estimate
from .color_management import color_spaces, data_space
from .node_building import CHANNELS, GAP, IS_BLENDER_5, SHADER, WIDTH, NodeGrid, Socket, activate
from .node_group import linear_rec709, made_for, new_group, working_space
from .node_links import LOOK, compositor_trees, holds_group_of, output_of
from .plates import Datablock

#: The output of the group with code values.
CODE_VALUES = "Code Values"

#: Names of sRGB, the encoding of displays, in common configs.
SRGB = ("sRGB", "sRGB Encoded Rec.709 (sRGB)", "sRGB - Texture", "Utility - sRGB - Texture")


def add_look(tree: bpy.types.NodeTree, plate: Datablock, name: str, curve: ResponseCurve, exposure: float) -> None:
    """Put the plate's "Camera Look <name>" before the output of a compositor tree, in place of an earlier look.

    It takes back the exposure, in stops, of the plate's linearizing group, or `exposure` if the tree has none. Without
    an output, it is not linked. Raise ConfigError, and change nothing, if the config lacks linear Rec.709 or sRGB.
    """
    group = _build(plate, name, curve)
    linearizing = (node for node in tree.nodes if holds_group_of(node, plate))
    node = _node_before_output(tree)
    node.node_tree = group
    node.inputs["Exposure"].default_value = next((n.inputs["Exposure"].default_value for n in linearizing), exposure)
    _link(tree, node)
    activate(node)


def update_look(plate: Datablock, curve: ResponseCurve, exposure: float) -> None:
    """Bring the plate's look up to date, and every node of it in the file; nothing happens if it has none."""
    group = made_for(plate, LOOK)
    if group is None:
        return
    _build(plate, "", curve)
    for tree in compositor_trees():
        for node in tree.nodes:
            if getattr(node, "node_tree", None) == group:
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
    straight = grid.divide_by_alpha(start.outputs["Image"], 1)
    light = grid.node("CompositorNodeExposure", 3)
    grid.link(grid.convert_color_space(working, linear, straight, 2), light.inputs["Image"])
    grid.link(grid.math("MULTIPLY", 2, 1, start.outputs["Exposure"], -1), light.inputs["Exposure"])
    response = _response_image(plate, f".{group.name} Response", curve)
    codes = _encoded(grid, light.outputs[0], stored_estimate.matrix(plate), response)
    grid.link(grid.multiply_by_alpha(codes, 14), end.inputs[CODE_VALUES])
    shown = grid.convert_color_space(srgb_space, working, codes, 13)
    grid.link(grid.multiply_by_alpha(shown, 14), end.inputs["Image"])
    return group


def _encoded(grid: NodeGrid, light: Socket, matrix: Float64Array | None, response: bpy.types.Image) -> Socket:
    """Return the socket of the code values of light in linear Rec.709, clipped to [0, 1] as by the camera.

    The matrix leads from the plate's primaries to Rec.709; here, its inverse leads back.
    """
    table = grid.node("CompositorNodeImage", 8, row=-1)
    table.image = response
    split, join = grid.node("CompositorNodeSeparateColor", 4), grid.node("CompositorNodeCombineColor", 12)
    grid.link(light, split.inputs[0])
    grid.link(split.outputs["Alpha"], join.inputs["Alpha"])
    channels = [split.outputs[name] for name in CHANNELS]
    if matrix is not None:
        channels = grid.multiply_by_matrix(channels, np.asarray(np.linalg.inv(matrix), float), 2)
    for row, (channel, light_in_it) in enumerate(zip(CHANNELS, channels, strict=True)):
        clipped = grid.math("ADD", 5, row, light_in_it, 0)
        clipped.node.use_clamp = True
        position = grid.math("MULTIPLY", 6, row, clipped, SAMPLES - 1)
        sample = grid.math("FLOOR", 7, row, position)
        read = grid.node("CompositorNodeSeparateColor", 10, row=row)
        grid.link(_sample(grid, table.outputs["Image"], sample, row), read.inputs[0])
        between = grid.math("MULTIPLY_ADD", 11, row, grid.math("FRACT", 7, row + 0.5, position))
        grid.link(read.outputs["Green"], between.node.inputs[1])
        grid.link(read.outputs["Red"], between.node.inputs[2])
        grid.link(between, join.inputs[channel])
    return join.outputs[0]


def _sample(grid: NodeGrid, table: Socket, number: Socket, row: int) -> Socket:
    """Return the socket of the pixel of a number in the image of a response."""
    vector = grid.node(f"{SHADER}NodeCombineXYZ", 8, row=row)
    vector.inputs["Y"].default_value, vector.inputs["Z"].default_value = 0.5, 1
    grid.link(grid.math("MULTIPLY_ADD", 7.5, row, number, 1 / SAMPLES, 0.5 / SAMPLES), vector.inputs["X"])
    node = grid.node("CompositorNodeMapUV", 9, row=row)
    if IS_BLENDER_5:
        node.inputs["Interpolation"].default_value = "Nearest"
        node.inputs["Extension X"].default_value = node.inputs["Extension Y"].default_value = "Extend"
    else:
        node.filter_type = "NEAREST"
    grid.link(table, node.inputs["Image"])
    grid.link(vector.outputs[0], node.inputs["UV"])
    return node.outputs[0]


def _response_image(plate: Datablock, name: str, curve: ResponseCurve) -> bpy.types.Image:
    """Return the packed image of a response, red f at each sample, green the step to the next; hidden by its name."""
    image = next((item for item in bpy.data.images if item.get(LOOK) == plate and item.library is None), None)
    if image is None:
        image = bpy.data.images.new(name, SAMPLES, 1, alpha=False, float_buffer=True)
        image[LOOK] = plate
        image.colorspace_settings.name = data_space()  # before the pixels, which this would remove
    pixels = np.zeros((SAMPLES, 4), np.float32)
    pixels[:, 0], pixels[:-1, 1], pixels[:, 3] = curve.brightness, np.diff(curve.brightness), 1
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def srgb() -> str:
    """Return the name of sRGB in the config of this session."""
    known = color_spaces()
    for name in SRGB:
        if name in known:
            return name
    raise ConfigError("this config has no sRGB space, which the look needs; use Blender's own config")


def _node_before_output(tree: bpy.types.NodeTree) -> bpy.types.Node:
    """Return the look that leads to the output of a tree, of whatever plate; else a new node."""
    output = output_of(tree)
    link = output.inputs[0].links[0] if output is not None and output.inputs[0].links else None
    earlier = link.from_node if link is not None else None
    if LOOK in (getattr(earlier, "node_tree", None) or {}):
        return earlier
    node = tree.nodes.new("CompositorNodeGroup")
    node.width = WIDTH
    if output is not None:
        node.location = output.location
        output.location.x += WIDTH + GAP
    return node


def _link(tree: bpy.types.NodeTree, node: bpy.types.Node) -> None:
    """Put a look between the output of a tree, with its viewers, and what leads to it, unless it is there already."""
    output = output_of(tree)
    if output is None:
        return
    source = output.inputs[0].links[0].from_socket if output.inputs[0].links else None
    if source is not None and source.node == node:
        return
    viewers = [] if source is None else [link.to_socket for link in source.links if link.to_node.type == "VIEWER"]
    for target in (output.inputs[0], *viewers):
        tree.links.new(node.outputs["Image"], target)
    if source is not None:
        tree.links.new(source, node.inputs["Image"])
