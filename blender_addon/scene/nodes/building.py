# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes from which the node groups for compositors and shaders are built, placed in columns and rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import bpy

from ..plates import SHADER

if TYPE_CHECKING:
    from crfnet_core.types import Float64Array

#: Whether this is Blender 5.0 or later, whose nodes have other names and sockets.
IS_BLENDER_5 = bpy.app.version >= (5, 0, 0)

#: In units of the node editor: the distance between a group's node and its neighbors, and its width; the distances
#: between the nodes of neighboring columns and rows.
GAP, WIDTH = 60, 320
_COLUMN, _ROW = 190, -230

#: The sockets of the nodes that separate and combine colors.
CHANNELS = ("Red", "Green", "Blue")

Socket: TypeAlias = bpy.types.NodeSocket
Operand: TypeAlias = Socket | float | list[float]  # of a node that computes


def activate(node: bpy.types.Node) -> None:
    """Select a node, and no other one of its tree."""
    for other in node.id_data.nodes:
        other.select = other == node
    node.id_data.nodes.active = node


class NodeGrid:
    """A node tree whose nodes are placed in columns and rows."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self._tree, self._is_shader = tree, tree.bl_idname == SHADER
        self._common = "Shader" if self._is_shader or IS_BLENDER_5 else "Compositor"  # of nodes that both kinds have

    def node(self, kind: str, column: float, *, row: float = 0) -> bpy.types.Node:
        """Return a new node."""
        node = self._tree.nodes.new(kind)
        node.location = (_COLUMN * column, _ROW * row)
        return node

    def link(self, source: Socket, target: Socket) -> None:
        """Link an output to an input."""
        self._tree.links.new(source, target)

    def math(self, operation: str, column: float, row: float, *operands: Operand, kind: str = "Math") -> Socket:
        """Return the socket of a value that a Math node has computed; in shaders also of another kind, "VectorMath"."""
        node = self.node(f"{self._common}Node{kind}", column, row=row)
        node.operation = operation
        for operand, socket in zip(operands, (each for each in node.inputs if each.enabled), strict=False):
            if isinstance(operand, int | float | list):
                socket.default_value = operand
            else:
                self.link(operand, socket)
        return next(socket for socket in node.outputs if socket.enabled)

    def curve(self, colors: Socket, start: float, end: float, column: float, row: float) -> bpy.types.Node:
        """Return an RGB Curves node for the colors from start to end, which the range of its curves, 0 to 1, covers."""
        if self._is_shader:
            node, scale = self.node("ShaderNodeRGBCurve", column, row=row), 1 / (end - start)
            factors, summands = [scale] * 3, [-start * scale] * 3
            scaled = self.math("MULTIPLY_ADD", column - 1, row, colors, factors, summands, kind="VectorMath")
            self.link(scaled, node.inputs["Color"])
            return node
        node = self.node("CompositorNodeCurveRGB", column, row=row)
        self.link(colors, node.inputs["Image"])
        for name, level in (("Black Level", start), ("White Level", end)):
            node.inputs[name].default_value = (level, level, level, 1)
        return node

    def add(self, first: Socket, second: Socket, column: float, row: float) -> Socket:
        """Return the socket of the sum of two colors, with the alpha of the first."""
        node = self.node("ShaderNodeMix" if self._common == "Shader" else "CompositorNodeMixRGB", column, row=row)
        if self._common == "Shader":
            node.data_type = "RGBA"
        node.blend_type, node.inputs[0].default_value = "ADD", 1
        summands = [socket for socket in node.inputs if socket.type == "RGBA"]
        for color, socket in zip((first, second), summands, strict=True):
            self.link(color, socket)
        return next(socket for socket in node.outputs if socket.type == "RGBA")

    def multiply_by_matrix(self, channels: list[Socket], matrix: Float64Array, column: float) -> list[Socket]:
        """Return the sockets of red, green and blue that are multiplied by a matrix, shape (3, 3)."""
        products = []
        for row, factors in enumerate(matrix.tolist()):
            total = self.math("MULTIPLY", column, row, channels[0], factors[0])
            for index in (1, 2):
                added = self.math("MULTIPLY_ADD", column + index, row, channels[index], factors[index])
                self.link(total, added.node.inputs[2])
                total = added
            products.append(total)
        return products

    def transformed(self, colors: Socket, matrix: Float64Array, column: float) -> Socket:
        """Return the socket of a shader's colors that are multiplied by a matrix, shape (3, 3)."""
        joined = self.node("ShaderNodeCombineXYZ", column + 1)
        for row, factors in enumerate(matrix.tolist()):
            product = self.math("DOT_PRODUCT", column, row, colors, factors, kind="VectorMath")
            self.link(product, joined.inputs[row])
        return joined.outputs[0]

    def convert_color_space(self, source: str, target: str, colors: Socket, column: float) -> Socket:
        """Return the socket of colors that are converted from one color space to another."""
        node = self.node("CompositorNodeConvertColorSpace", column)
        node.from_color_space, node.to_color_space = source, target
        self.link(colors, node.inputs["Image"])
        return node.outputs[0]

    def convert_alpha(self, colors: Socket, column: float, *, is_multiplied: bool) -> Socket:
        """Return the socket of colors that are multiplied by their alpha, or divided by it."""
        node = self.node("CompositorNodePremulKey", column)
        if IS_BLENDER_5:
            node.inputs["Type"].default_value = "To Premultiplied" if is_multiplied else "To Straight"
        else:
            node.mapping = "STRAIGHT_TO_PREMUL" if is_multiplied else "PREMUL_TO_STRAIGHT"
        self.link(colors, node.inputs["Image"])
        return node.outputs[0]
