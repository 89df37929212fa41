# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes from which the compositor node groups are built, placed in columns and rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from crfnet_core.types import Float64Array

#: Whether this is Blender 5.0 or later, whose nodes have other names and sockets.
IS_BLENDER_5 = bpy.app.version >= (5, 0, 0)

#: The distance between a group's node and its neighbors, and its width, in units of the node editor.
GAP, WIDTH = 60, 220

#: The beginning of the names of nodes that Blender 5.0 replaced by shader nodes.
SHADER = "Shader" if IS_BLENDER_5 else "Compositor"

#: The sockets of the nodes that separate and combine colors.
CHANNELS = ("Red", "Green", "Blue")

#: Distances between the nodes of neighbouring columns and rows, in units of the node editor.
_COLUMN, _ROW = 190, -230


class NodeGrid:
    """A node tree whose nodes are placed in columns and rows."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self._tree = tree

    def node(self, kind: str, column: float, *, row: float = 0) -> bpy.types.Node:
        """Return a new node."""
        node = self._tree.nodes.new(kind)
        node.location = (_COLUMN * column, _ROW * row)
        return node

    def link(self, source: bpy.types.NodeSocket, target: bpy.types.NodeSocket) -> None:
        """Link an output to an input."""
        self._tree.links.new(source, target)


def math_node(
    grid: NodeGrid, operation: str, column: float, row: float, value: bpy.types.NodeSocket, *numbers: float
) -> bpy.types.NodeSocket:
    """Return the socket of a value that a Math node has computed, with numbers as its further operands."""
    node = grid.node(f"{SHADER}NodeMath", column, row=row)
    node.operation = operation
    grid.link(value, node.inputs[0])
    for index, number in enumerate(numbers, 1):
        node.inputs[index].default_value = number
    return node.outputs[0]


def multiply_by_matrix(
    grid: NodeGrid, channels: Sequence[bpy.types.NodeSocket], matrix: Float64Array, column: float
) -> list[bpy.types.NodeSocket]:
    """Return the sockets of red, green and blue that are multiplied by a matrix, shape (3, 3)."""
    products = []
    for row, factors in enumerate(matrix.tolist()):
        total = math_node(grid, "MULTIPLY", column, row, channels[0], factors[0])
        for index in (1, 2):
            added = math_node(grid, "MULTIPLY_ADD", column + index, row, channels[index], factors[index])
            grid.link(total, added.node.inputs[2])
            total = added
        products.append(total)
    return products


def convert_color_space(
    grid: NodeGrid, source: str, target: str, colors: bpy.types.NodeSocket, column: float
) -> bpy.types.NodeSocket:
    """Return the socket of colors that are converted from one color space to another."""
    node = grid.node("CompositorNodeConvertColorSpace", column)
    node.from_color_space = source
    node.to_color_space = target
    grid.link(colors, node.inputs["Image"])
    return node.outputs[0]


def multiply_by_alpha(grid: NodeGrid, colors: bpy.types.NodeSocket, column: float) -> bpy.types.NodeSocket:
    """Return the socket of colors that are multiplied by their alpha."""
    return _alpha_node(grid, colors, column, "To Premultiplied", "STRAIGHT_TO_PREMUL")


def divide_by_alpha(grid: NodeGrid, colors: bpy.types.NodeSocket, column: float) -> bpy.types.NodeSocket:
    """Return the socket of colors that are divided by their alpha."""
    return _alpha_node(grid, colors, column, "To Straight", "PREMUL_TO_STRAIGHT")


def _alpha_node(
    grid: NodeGrid, colors: bpy.types.NodeSocket, column: float, kind: str, earlier_kind: str
) -> bpy.types.NodeSocket:
    """Return the socket of an Alpha Convert node; its kind has another name in Blender 4.5."""
    node = grid.node("CompositorNodePremulKey", column)
    if IS_BLENDER_5:
        node.inputs["Type"].default_value = kind
    else:
        node.mapping = earlier_kind
    grid.link(colors, node.inputs["Image"])
    return node.outputs[0]
