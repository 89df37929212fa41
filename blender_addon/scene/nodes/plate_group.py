# SPDX-License-Identifier: GPL-3.0-or-later
"""The inverse response as a compositor node group of RGB Curves nodes: see `curves`.

Plates of 8 bits need one, with a step at every code; deeper ones, as many as `curves.TOLERANCE` takes. Values are
clipped to [0, 1], as where files are baked.
"""

import bpy
import PyOpenColorIO as OCIO

from crfnet.configs.reference_space import LINEAR_REC709
from crfnet.configs.sources import role_name
from crfnet.errors import ConfigError
from crfnet_core import ResponseCurve
from crfnet_core.types import Float64Array

from .. import stored_estimate
from ..code_values import alpha_in_compositor, is_deep
from ..color_management import color_spaces, data_space, running_config
from ..plates import Datablock, mark, short_hash
from .building import CHANNELS, NodeGrid, Socket
from .curves import EIGHT_BITS, Part, add_curves, deep_parts
from .links import PLATE


def build_group(plate: Datablock, name: str, curve: ResponseCurve, exposure: float) -> bpy.types.NodeTree:
    """Return the plate's node group "Camera Response <name> <hash>"; one that exists already is updated.

    Every plate has a group of its own, which survives renaming, saving and appending. `exposure` is the default of its
    Exposure socket, in stops. Raise ConfigError if the config has no linear Rec.709.
    """
    source = linear_rec709()
    group = made_for(plate)
    if group is None:
        group = new_group(plate, f"Camera Response {name}", PLATE, "Stops added to the linear plate")
    group.nodes.clear()
    sockets = {item.name: item for item in group.interface.items_tree if item.in_out == "INPUT"}
    sockets["Exposure"].default_value = exposure
    parts = deep_parts(curve) if is_deep(plate) else [EIGHT_BITS]
    _add_nodes(group, curve, parts, source, stored_estimate.matrix(plate), alpha_in_compositor(plate))
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


def new_group(plate: Datablock, title: str, name: str, exposure: str) -> bpy.types.NodeTree:
    """Return a plate's new node group, with sockets and without nodes.

    A short hash of the plate ends its name. The custom property of a name, whose value is the plate, finds it again.
    `exposure` is the description of the Exposure socket.
    """
    group = bpy.data.node_groups.new(f"{title} {short_hash(plate)}", "CompositorNodeTree")
    mark(group, name, plate)
    group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
    stops = group.interface.new_socket("Exposure", in_out="INPUT", socket_type="NodeSocketFloat")
    stops.description = exposure
    stops.min_value, stops.max_value = -20, 20
    return group


def made_for(plate: Datablock, name: str = PLATE) -> bpy.types.NodeTree | None:
    """Return the node group that was made for a plate; not one linked from another file."""
    return next((group for group in bpy.data.node_groups if group.get(name) == plate and group.library is None), None)


def _add_nodes(
    group: bpy.types.NodeTree,
    curve: ResponseCurve,
    parts: list[Part],
    source: str,
    matrix: Float64Array | None,
    alpha_mode: str,
) -> None:
    """Add the nodes: the curve, exposure, multiplication by alpha, conversion to the working space.

    A matrix comes behind the curve if the plate has other primaries than Rec.709.

    The colors come as stored, but for an exception: see `alpha_in_compositor`. They are divided by an alpha that is
    "Premultiplied", and not multiplied by one that is "Channel Packed"; if it is "None", alpha is 1.
    """
    grid = NodeGrid(group)
    start = grid.node("NodeGroupInput", 0)
    codes = start.outputs["Image"]
    if alpha_mode == "PREMUL":
        codes = grid.divide_by_alpha(codes, 1)
    light = add_curves(grid, codes, curve.inverse, parts, 2)
    if matrix is not None or alpha_mode == "NONE":
        light = by_channel(grid, light, matrix, 3, has_alpha=alpha_mode != "NONE")
    exposed, end = grid.node("CompositorNodeExposure", 8), grid.node("NodeGroupOutput", 11)
    grid.link(light, exposed.inputs["Image"])
    grid.link(start.outputs["Exposure"], exposed.inputs["Exposure"])
    light = exposed.outputs[0]
    if alpha_mode not in ("NONE", "CHANNEL_PACKED"):
        light = grid.multiply_by_alpha(light, 9)  # before the conversion: faster
    grid.link(grid.convert_color_space(source, working_space(), light, 10), end.inputs["Image"])


def by_channel(
    grid: NodeGrid, light: Socket, matrix: Float64Array | None, column: float, *, has_alpha: bool = True
) -> Socket:
    """Return the socket of light whose primaries a matrix, shape (3, 3), converts, and whose alpha is 1 on demand."""
    split, join = grid.node("CompositorNodeSeparateColor", column), grid.node("CompositorNodeCombineColor", column + 4)
    grid.link(light, split.inputs[0])
    if has_alpha:
        grid.link(split.outputs["Alpha"], join.inputs["Alpha"])
    channels = [split.outputs[channel] for channel in CHANNELS]
    if matrix is not None:
        channels = grid.multiply_by_matrix(channels, matrix, column + 1)
    for channel, socket in zip(CHANNELS, channels, strict=True):
        grid.link(socket, join.inputs[channel])
    return join.outputs[0]
