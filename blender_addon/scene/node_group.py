# SPDX-License-Identifier: GPL-3.0-or-later
"""The inverse response as a compositor node group, which looks the code values up in an image of the LUT.

A Map UV node for each channel reads the LUT image at the pixel of brightness B. Blender 5.0 and later interpolate
between the pixels of a LUT of the usual length, N x 1 pixels, at u = B (N - 1) / N + 0.5 / N. Blender 4.5 takes the
nearest one, so there the image has a pixel for each 16-bit code, 256 x 256 of them: with t = (65535 B + 0.5) / 256, it
is at u = t - floor(t), v = (floor(t) + 0.5) / 256.
"""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import PyOpenColorIO as OCIO

from crfnet.configs.files import role_name
from crfnet.configs.reference_space import LINEAR_REC709
from crfnet.defaults import LUT_LENGTH
from crfnet.errors import ConfigError
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.output_files import distinct_names
from crfnet_core import ResponseCurve
from crfnet_core.types import Float64Array

from . import stored_estimate
from .code_values import alpha_in_compositor
from .color_management import color_spaces, data_space, running_config
from .node_building import (
    CHANNELS,
    IS_BLENDER_5,
    NodeGrid,
    combine_node,
    convert_color_space,
    divide_by_alpha,
    map_uv,
    math_node,
    multiply_by_alpha,
    multiply_by_matrix,
)
from .node_links import PLATE
from .plates import Datablock

#: Width and height of the LUT image.
SIZE = (LUT_LENGTH, 1) if IS_BLENDER_5 else (256, 256)


def build_group(plate: Datablock, name: str, curve: ResponseCurve, exposure: float) -> bpy.types.NodeTree:
    """Return the plate's node group "Camera Response <name>"; one that exists already is updated.

    Every plate has a group of its own, which survives renaming, saving and appending. `exposure` is the default of its
    Exposure socket, in stops. Raise ConfigError if the config has no linear Rec.709.
    """
    source = linear_rec709()
    group = made_for(plate, bpy.data.node_groups)
    if group is None:
        group = new_group(plate, f"Camera Response {name}", PLATE, "Stops added to the linear plate")
    group.nodes.clear()
    sockets = {item.name: item for item in group.interface.items_tree if item.in_out == "INPUT"}
    sockets["Exposure"].default_value = exposure
    lut = _lut_image(plate, f".{group.name} LUT", curve)
    _add_nodes(group, lut, source, stored_estimate.matrix(plate), alpha_in_compositor(plate))
    return group


def check_config() -> None:
    """Raise a ConfigError unless the config of this session has the color spaces that the node group needs."""
    linear_rec709(), data_space(), working_space()


def linear_rec709() -> str:
    """Return the name of linear Rec.709 in the config of this session."""
    known = color_spaces()
    for name in LINEAR_REC709:
        if name in known:
            return name
    raise ConfigError("this config has no linear Rec.709 space, which the nodes need; choose another way to apply it")


def working_space() -> str:
    """Return the name that the Convert Colorspace node has for the scene's working space."""
    kinds = bpy.types.CompositorNodeConvertColorSpace.bl_rna.properties["to_color_space"].enum_items
    return "scene_linear" if "scene_linear" in kinds else role_name(running_config(), OCIO.ROLE_SCENE_LINEAR)


def new_group(plate: Datablock, title: str, mark: str, exposure: str) -> bpy.types.NodeTree:
    """Return a plate's new node group, with sockets and without nodes.

    If there is a group of this title, the folder of the plate is added to its name. The custom property `mark`, whose
    value is the plate, finds it again. `exposure` is the description of the Exposure socket.
    """
    names = distinct_names(title, Path(bpy.path.abspath(plate.filepath)).parent.name)
    free = next(name for name in names if name not in bpy.data.node_groups)
    group = bpy.data.node_groups.new(free, "CompositorNodeTree")
    group[mark] = plate
    group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
    stops = group.interface.new_socket("Exposure", in_out="INPUT", socket_type="NodeSocketFloat")
    stops.description = exposure
    stops.min_value, stops.max_value = -20, 20
    return group


def made_for(plate: Datablock, collection: bpy.types.bpy_prop_collection, mark: str = PLATE) -> bpy.types.ID | None:
    """Return the node group or image that was made for a plate; not one linked from another file."""
    return next((item for item in collection if item.get(mark) == plate and item.library is None), None)


def _lut_image(plate: Datablock, name: str, curve: ResponseCurve) -> bpy.types.Image:
    """Return the packed image of a plate's LUT, which the leading dot of its name hides; an earlier one is updated."""
    image = made_for(plate, bpy.data.images)
    if image is not None and tuple(image.size) != SIZE:
        bpy.data.images.remove(image)
        image = None
    if image is None:
        image = bpy.data.images.new(name, *SIZE, alpha=False, float_buffer=True)
        image[PLATE] = plate
        image.colorspace_settings.name = data_space()  # before the pixels, which this would remove
    count = SIZE[0] * SIZE[1]
    pixels = np.ones((count, 4), np.float32)
    pixels[:, :3] = inverse_response_lut(curve, length=LUT_LENGTH).apply(np.linspace(0, 1, count))[:, None]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def _add_nodes(
    group: bpy.types.NodeTree, lut: bpy.types.Image, source: str, matrix: Float64Array | None, alpha_mode: str
) -> None:
    """Add the nodes: a look-up for each channel, exposure, multiplication by alpha, conversion to the working space.

    A matrix comes behind the look-ups if the plate has other primaries than Rec.709.

    The colors come as stored, but for an exception: see `alpha_in_compositor`. They are divided by an alpha that is
    "Premultiplied", and not multiplied by one that is "Channel Packed"; if it is "None", alpha is 1.
    """
    grid = NodeGrid(group)
    start = grid.node("NodeGroupInput", -1)
    table = grid.node("CompositorNodeImage", 3, row=-1)
    table.image = lut
    split, codes = grid.node("CompositorNodeSeparateColor", 1), start.outputs["Image"]
    grid.link(divide_by_alpha(grid, codes, 0) if alpha_mode == "PREMUL" else codes, split.inputs[0])
    positions = [_position(grid, split.outputs[channel], row) for row, channel in enumerate(CHANNELS)]
    channels = [_look_up(grid, table.outputs["Image"], position, row) for row, position in enumerate(positions)]
    after = 5
    if matrix is not None:
        channels, after = multiply_by_matrix(grid, channels, matrix, 6), 8
    join = grid.node("CompositorNodeCombineColor", after + 1)
    if alpha_mode != "NONE":
        grid.link(split.outputs["Alpha"], join.inputs["Alpha"])
    for channel, socket in zip(CHANNELS, channels, strict=True):
        grid.link(socket, join.inputs[channel])
    exposed = grid.node("CompositorNodeExposure", after + 2)
    grid.link(join.outputs[0], exposed.inputs["Image"])
    grid.link(start.outputs["Exposure"], exposed.inputs["Exposure"])
    light = exposed.outputs[0]
    if alpha_mode not in ("NONE", "CHANNEL_PACKED"):
        light = multiply_by_alpha(grid, light, after + 3)  # before the conversion: faster
    end = grid.node("NodeGroupOutput", after + 5)
    grid.link(convert_color_space(grid, source, working_space(), light, after + 4), end.inputs["Image"])


def _look_up(
    grid: NodeGrid, table: bpy.types.NodeSocket, position: bpy.types.NodeSocket, row: int
) -> bpy.types.NodeSocket:
    """Return the socket of a channel's irradiance, gray as the LUT image, which is read at a position in [0, 1]."""
    look_up = map_uv(grid, table, position, 5, row)
    if IS_BLENDER_5:
        look_up.inputs["Interpolation"].default_value = "Bilinear"
    return look_up.outputs[0]


def _position(grid: NodeGrid, brightness: bpy.types.NodeSocket, row: int) -> bpy.types.NodeSocket:
    """Return the socket of the position (u, v) of a brightness, clamped to [0, 1], in the LUT image."""
    clamped = math_node(grid, "ADD", 2, row, brightness, 0)
    clamped.node.use_clamp = True
    vector = combine_node(grid, 4, row)
    if IS_BLENDER_5:
        length = SIZE[0]
        u = math_node(grid, "MULTIPLY_ADD", 3, row, clamped, (length - 1) / length, 0.5 / length)
    else:
        scaled = math_node(grid, "MULTIPLY_ADD", 2.5, row, clamped, 65535 / 256, 0.5 / 256)
        u = math_node(grid, "FRACT", 3, row, scaled)
        line = math_node(grid, "FLOOR", 3, row + 0.5, scaled)
        grid.link(math_node(grid, "MULTIPLY_ADD", 3.5, row + 0.5, line, 1 / 256, 0.5 / 256), vector.inputs["Y"])
    grid.link(u, vector.inputs["X"])
    return vector.outputs[0]
