# SPDX-License-Identifier: GPL-3.0-or-later
"""The inverse response as a compositor node group: the code values are looked up in an image of the LUT.

Map UV reads the LUT image, N x 1 pixels, at u = B (N - 1) / N + 0.5 / N. Blender 5.0 and later interpolate between the
pixels; 4.5 takes the nearest, so the image is longer there. Curve nodes would be 50 times less exact.
"""

from __future__ import annotations

import bpy
import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core import ResponseCurve
from crfnet_core.errors import ConfigError
from ocio.configs.installed import role_name
from ocio.configs.plate_color_space import LINEAR_REC709
from ocio.luts.lut1d import DEFAULT_LENGTH, inverse_response_lut

from .color_management import color_spaces, running_config

#: Whether Map UV has a bilinear interpolation.
IS_BILINEAR = bpy.app.version >= (5, 0, 0)

#: Pixels of the LUT image: both are exact on 8-bit codes.
LENGTH = DEFAULT_LENGTH if IS_BILINEAR else 16321

#: The custom property by which node groups and LUT images of ours are known again.
TAG = "camera_response_of"

#: Nodes that Blender 5.0 merged with those of shaders.
_MATH, _COMBINE = (
    ("ShaderNodeMath", "ShaderNodeCombineXYZ") if IS_BILINEAR else ("CompositorNodeMath", "CompositorNodeCombineXYZ")
)

_CHANNELS = ("Red", "Green", "Blue")


def build_group(name: str, curve: ResponseCurve, exposure: float) -> bpy.types.NodeTree:
    """Return the node group "Camera Response <name>", made anew or brought up to date.

    Parameters
    ----------
    name : str
        The plate's name.
    curve : ResponseCurve
        Its response.
    exposure : float
        The default of the Exposure socket, in stops.

    Raises
    ------
    ConfigError
        If the config has no linear Rec.709, in which the response ends.
    """
    source = linear_rec709()
    group = _tagged(bpy.data.node_groups, name) or _new_group(name)
    group.nodes.clear()
    sockets = {item.name: item for item in group.interface.items_tree if item.in_out == "INPUT"}
    sockets["Exposure"].default_value = exposure
    _fill(group, _lut_image(name, curve), source)
    return group


def check_config() -> None:
    """Raise a ConfigError unless this session's config has what the node group needs."""
    linear_rec709(), data_space(), working_space()


def linear_rec709() -> str:
    """Return the name of linear Rec.709 in this session's config."""
    known = color_spaces()
    for name in LINEAR_REC709:
        if name in known:
            return name
    raise ConfigError("this config has no linear Rec.709 space, which the nodes need; choose another way to apply it")


def data_space() -> str:
    """Return the name of the space whose pixels stay as they are; "Non-Color" in Blender's own config."""
    return "Non-Color" if "Non-Color" in color_spaces() else role_name(running_config(), OCIO.ROLE_DATA)


def _new_group(name: str) -> bpy.types.NodeTree:
    """Return an empty node group with its sockets."""
    group = bpy.data.node_groups.new(f"Camera Response {name}", "CompositorNodeTree")
    group[TAG] = name
    group.use_fake_user = True
    group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    group.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
    exposure = group.interface.new_socket("Exposure", in_out="INPUT", socket_type="NodeSocketFloat")
    exposure.description = "Stops added to the linear plate"
    exposure.min_value, exposure.max_value = -20, 20
    return group


def _lut_image(name: str, curve: ResponseCurve) -> bpy.types.Image:
    """Return the packed LUT image, with its pixels set."""
    image = _tagged(bpy.data.images, name)
    if image is not None and tuple(image.size) != (LENGTH, 1):
        bpy.data.images.remove(image)
        image = None
    if image is None:
        image = bpy.data.images.new(f"Camera Response {name} LUT", LENGTH, 1, alpha=False, float_buffer=True)
        image[TAG] = name
        image.colorspace_settings.name = data_space()  # before the pixels, which it would drop
    pixels = np.ones((LENGTH, 4), np.float32)
    pixels[:, :3] = inverse_response_lut(curve, length=LENGTH).values[:, None]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    return image


def _tagged(collection: bpy.types.bpy_prop_collection, name: str) -> bpy.types.ID | None:
    """Return what was made for a plate of this name and may be changed."""
    return next((item for item in collection if item.get(TAG) == name and item.library is None), None)


def _fill(group: bpy.types.NodeTree, lut: bpy.types.Image, source: str) -> None:
    """Make the nodes: one look-up per channel, exposure, working space, alpha multiplied in.

    Blender hands on 8-bit images in Non-Color as they are stored, not multiplied by alpha.
    """
    build = _Builder(group)
    start = build.node("NodeGroupInput", 0)
    table = build.node("CompositorNodeImage", 1, row=-1)
    table.image = lut
    split = build.node("CompositorNodeSeparateColor", 1)
    build.link(start.outputs["Image"], split.inputs[0])
    join = build.node("CompositorNodeCombineColor", 7)
    build.link(split.outputs["Alpha"], join.inputs["Alpha"])
    for row, channel in enumerate(_CHANNELS):
        build.link(_looked_up(build, split.outputs[channel], table.outputs["Image"], row), join.inputs[channel])
    exposed = build.node("CompositorNodeExposure", 8)
    build.link(join.outputs[0], exposed.inputs["Image"])
    build.link(start.outputs["Exposure"], exposed.inputs["Exposure"])
    working = build.converted(source, exposed.outputs[0], 9)
    end = build.node("NodeGroupOutput", 11)
    build.link(build.premultiplied(working, 10), end.inputs["Image"])


def _looked_up(
    build: _Builder, value: bpy.types.NodeSocket, table: bpy.types.NodeSocket, row: int
) -> bpy.types.NodeSocket:
    """Return a channel's entry in the LUT."""
    clamped = build.node(_MATH, 2, row=row)
    clamped.operation, clamped.use_clamp = "ADD", True
    build.link(value, clamped.inputs[0])
    clamped.inputs[1].default_value = 0
    place = build.node(_MATH, 3, row=row)
    place.operation = "MULTIPLY_ADD"
    build.link(clamped.outputs[0], place.inputs[0])
    place.inputs[1].default_value, place.inputs[2].default_value = (LENGTH - 1) / LENGTH, 0.5 / LENGTH
    vector = build.node(_COMBINE, 4, row=row)
    build.link(place.outputs[0], vector.inputs["X"])
    vector.inputs["Y"].default_value, vector.inputs["Z"].default_value = 0.5, 1
    look = build.node("CompositorNodeMapUV", 5, row=row)
    if IS_BILINEAR:
        look.inputs["Interpolation"].default_value = "Bilinear"
        look.inputs["Extension X"].default_value = look.inputs["Extension Y"].default_value = "Extend"
    else:
        look.filter_type = "NEAREST"
    build.link(table, look.inputs["Image"])
    build.link(vector.outputs[0], look.inputs["UV"])
    split = build.node("CompositorNodeSeparateColor", 6, row=row)
    build.link(look.outputs[0], split.inputs[0])
    return split.outputs["Red"]


class _Builder:
    """Adds nodes to a tree on a grid of columns and rows."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self._tree = tree

    def node(self, kind: str, column: int, *, row: int = 0) -> bpy.types.Node:
        """Return a new node."""
        node = self._tree.nodes.new(kind)
        node.location = (190 * column, -230 * row)
        return node

    def link(self, source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
        """Link two sockets."""
        self._tree.links.new(source, target)

    def premultiplied(self, source: bpy.types.NodeSocket, column: int) -> bpy.types.NodeSocket:
        """Return colours multiplied by their alpha."""
        node = self.node("CompositorNodePremulKey", column)
        if IS_BILINEAR:
            node.inputs["Type"].default_value = "To Premultiplied"
        else:
            node.mapping = "STRAIGHT_TO_PREMUL"
        self.link(source, node.inputs["Image"])
        return node.outputs[0]

    def converted(self, space: str, source: bpy.types.NodeSocket, column: int) -> bpy.types.NodeSocket:
        """Return colours in the working space, from linear Rec.709."""
        node = self.node("CompositorNodeConvertColorSpace", column)
        node.from_color_space = space
        node.to_color_space = working_space()
        self.link(source, node.inputs["Image"])
        return node.outputs[0]


def working_space() -> str:
    """Return the name under which the Convert Colorspace node knows the scene's working space."""
    kinds = bpy.types.CompositorNodeConvertColorSpace.bl_rna.properties["to_color_space"].enum_items
    return "scene_linear" if "scene_linear" in kinds else role_name(running_config(), OCIO.ROLE_SCENE_LINEAR)
