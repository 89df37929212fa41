# SPDX-License-Identifier: GPL-3.0-or-later
"""The inverse response as a node group of RGB Curves nodes, for the compositor or for shaders: see `curves`.

Plates of 8 bits need one, with a step at every code; deeper ones, as many as `curves.TOLERANCE` takes. Values are
clipped to [0, 1], as where files are baked.
"""

import bpy
import numpy as np
import PyOpenColorIO as OCIO

from crfnet.configs.reference_space import LINEAR_REC709
from crfnet.configs.sources import find_config, role_name
from crfnet.errors import ConfigError
from crfnet_core import ResponseCurve
from crfnet_core.types import Float64Array

from .. import stored_estimate
from ..code_values import alpha_in_compositor, is_deep
from ..color_management import color_spaces, data_space, running_config
from ..plates import COMPOSITOR, NODE_TREES, SHADER, Datablock, alpha_mode, mark, short_hash
from .building import CHANNELS, NodeGrid, Socket
from .curves import EIGHT_BITS, Part, add_curves, deep_parts
from .links import PLATE, WORKING_SPACE, file_space

_COLORS = {COMPOSITOR: "Image", SHADER: "Color"}  # the name of the colors of a node group by the kind of node tree


def build_group(
    plate: Datablock, name: str, curve: ResponseCurve, exposure: float, *, kind: str = COMPOSITOR
) -> bpy.types.NodeTree:
    """Return the plate's node group "Camera Response <name> <hash>" for a kind of node tree.

    Every plate has a group of its own for each kind, which survives renaming, saving and appending; those that exist
    are updated. `exposure` is the default of the Exposure socket, in stops. Raise ConfigError as `check_config`.
    """
    check_config()
    groups = {each: made_for(plate, kind=each) for each in NODE_TREES}
    if groups[kind] is None:
        title = f"Camera Response {name}{' shader' if kind == SHADER else ''}"
        groups[kind] = new_group(plate, title, PLATE, "Stops added to the linear plate", kind=kind)
    parts = deep_parts(curve) if is_deep(plate) else [EIGHT_BITS]
    for group in filter(None, groups.values()):
        group.nodes.clear()
        inputs(group)["Exposure"].default_value = exposure
        add_nodes = _add_shader_nodes if group.bl_idname == SHADER else _add_nodes
        add_nodes(group, plate, curve, parts)
    return groups[kind]


def check_config() -> None:
    """Raise a ConfigError unless the config of this session has the color spaces that the node groups need."""
    data_space(), working_space(), working_matrix()


def linear_rec709() -> str:
    """Return the name of linear Rec.709 in the config of this session."""
    known = [name for name in LINEAR_REC709 if name in color_spaces()]
    if known:
        return known[0]
    raise ConfigError("this config has no linear Rec.709 space, which the nodes need; choose another way to apply it")


def working_space() -> str:
    """Return the name that the Convert Colorspace node has for the scene's working space."""
    kinds = bpy.types.CompositorNodeConvertColorSpace.bl_rna.properties["to_color_space"].enum_items
    return "scene_linear" if "scene_linear" in kinds else role_name(running_config(), OCIO.ROLE_SCENE_LINEAR)


def working_matrix() -> Float64Array:
    """Return the matrix from linear Rec.709 to the scene's working space, shape (3, 3), which shaders compute with.

    Raise ConfigError if the working space is not linear.
    """
    config = find_config(running_config()).config
    colors = np.vstack([np.eye(3), np.eye(3) / 4]).astype(np.float32)
    config.getProcessor(linear_rec709(), file_space() or working_space()).getDefaultCPUProcessor().applyRGB(colors)
    if not np.allclose(colors[:3], 4 * colors[3:], atol=1e-5):
        raise ConfigError("the working space of this config is not linear; choose another way to apply it")
    return colors[:3].T.astype(float)


def set_working_space(group: bpy.types.NodeTree) -> None:
    """Have a plate's node group for shaders convert to the present working space, by the last three Dot Products."""
    rows = [node for node in group.nodes if node.type == "VECT_MATH" and node.operation == "DOT_PRODUCT"][-3:]
    for node, factors in zip(rows, working_matrix().tolist(), strict=True):
        node.inputs[1].default_value = factors
    group[WORKING_SPACE] = file_space()


def inputs(group: bpy.types.NodeTree) -> dict[str, bpy.types.NodeTreeInterfaceSocket]:
    """Return the inputs of a node group by their names."""
    return {item.name: item for item in group.interface.items_tree if item.in_out == "INPUT"}


def new_group(plate: Datablock, title: str, name: str, exposure: str, *, kind: str = COMPOSITOR) -> bpy.types.NodeTree:
    """Return a plate's new node group for a kind of node tree, with sockets and without nodes.

    A short hash of the plate ends its name. The custom property of a name, whose value is the plate, finds it again.
    `exposure` is the description of the Exposure socket.
    """
    group, color = bpy.data.node_groups.new(f"{title} {short_hash(plate)}", kind), _COLORS[kind]
    mark(group, name, plate)
    for in_out in ("OUTPUT", "INPUT"):
        group.interface.new_socket(color, in_out=in_out, socket_type="NodeSocketColor")
    stops = group.interface.new_socket("Exposure", in_out="INPUT", socket_type="NodeSocketFloat")
    stops.description = exposure
    stops.min_value, stops.max_value = -20, 20
    return group


def made_for(plate: Datablock, name: str = PLATE, *, kind: str = COMPOSITOR) -> bpy.types.NodeTree | None:
    """Return the node group that was made for a plate and a kind of node tree; not one linked from another file."""
    groups = (group for group in bpy.data.node_groups if group.bl_idname == kind and group.library is None)
    return next((group for group in groups if group.get(name) == plate), None)


def _add_nodes(group: bpy.types.NodeTree, plate: Datablock, curve: ResponseCurve, parts: list[Part]) -> None:
    """Add the nodes of a compositor: the curve, exposure, multiplication by alpha, conversion to the working space.

    A matrix comes behind the curve if the plate has other primaries than Rec.709.

    The colors come as stored, but for an exception: see `alpha_in_compositor`. They are divided by an alpha that is
    "Premultiplied", and not multiplied by one that is "Channel Packed"; if it is "None", alpha is 1.
    """
    grid, matrix, mode = NodeGrid(group), stored_estimate.matrix(plate), alpha_in_compositor(plate)
    start = grid.node("NodeGroupInput", 0)
    codes = start.outputs["Image"]
    if mode == "PREMUL":
        codes = grid.convert_alpha(codes, 1, is_multiplied=False)
    light = add_curves(grid, codes, curve.inverse, parts, 2)
    if matrix is not None or mode == "NONE":
        light = by_channel(grid, light, matrix, 3, has_alpha=mode != "NONE")
    exposed, end = grid.node("CompositorNodeExposure", 8), grid.node("NodeGroupOutput", 11)
    grid.link(light, exposed.inputs["Image"])
    grid.link(start.outputs["Exposure"], exposed.inputs["Exposure"])
    light = exposed.outputs[0]
    if mode not in ("NONE", "CHANNEL_PACKED"):
        light = grid.convert_alpha(light, 9, is_multiplied=True)  # before the conversion: faster
    grid.link(grid.convert_color_space(linear_rec709(), working_space(), light, 10), end.inputs["Image"])


def _add_shader_nodes(group: bpy.types.NodeTree, plate: Datablock, curve: ResponseCurve, parts: list[Part]) -> None:
    """Add the nodes of a shader: the curve, conversion of primaries and to the working space, exposure.

    Textures give the colors as stored, in Cycles and EEVEE, of movies, too. They are divided by an alpha that is
    "Premultiplied", and never multiplied by it.
    """
    grid, matrix, is_multiplied = NodeGrid(group), stored_estimate.matrix(plate), alpha_mode(plate) == "PREMUL"
    if is_multiplied and "Alpha" not in inputs(group):
        group.interface.new_socket("Alpha", in_out="INPUT", socket_type="NodeSocketFloat").default_value = 1
    start, end = grid.node("NodeGroupInput", 0), grid.node("NodeGroupOutput", 12)
    codes = start.outputs["Color"]
    if is_multiplied:
        codes = grid.math("DIVIDE", 1, 0, codes, start.outputs["Alpha"], kind="VectorMath")
    light = add_curves(grid, codes, curve.inverse, parts, 3)
    if matrix is not None:
        light = grid.transformed(light, matrix, 6)
    light = grid.transformed(light, np.eye(3), 8)  # see `set_working_space`
    factor = grid.math("POWER", 10, 1, 2, start.outputs["Exposure"])
    grid.link(grid.math("SCALE", 11, 0, light, factor, kind="VectorMath"), end.inputs["Color"])
    set_working_space(group)


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
