# SPDX-License-Identifier: GPL-3.0-or-later
"""Which nodes lie behind a node, through reroutes, other nodes and node groups."""

from __future__ import annotations

from collections.abc import Iterator

import bpy


def nodes_behind(node: bpy.types.Node) -> Iterator[bpy.types.Node]:
    """Yield every node that the outputs of a node lead to, nearest first.

    Where the links enter a node group, the nodes in it follow; where they leave the tree of the node, the nodes behind
    every node that holds this tree.
    """
    seen, waiting = {_key(node)}, [node]
    while waiting:
        for follower in _followers(waiting.pop(0)):
            if _key(follower) not in seen:
                seen.add(_key(follower))
                waiting.append(follower)
                yield follower


def neighbors_behind(node: bpy.types.Node) -> list[bpy.types.Node]:
    """Return the nodes of the same tree that the outputs of a node lead to."""
    return [other for other in nodes_behind(node) if other.id_data == node.id_data]


def compositor_trees() -> Iterator[bpy.types.NodeTree]:
    """Yield every compositor tree of the file, node groups included."""
    yield from (tree for tree in bpy.data.node_groups if tree.bl_idname == "CompositorNodeTree")
    if bpy.app.version < (5, 0, 0):  # later, these are node groups, too
        yield from (scene.node_tree for scene in bpy.data.scenes if scene.node_tree is not None)


def _followers(node: bpy.types.Node) -> Iterator[bpy.types.Node]:
    """Yield the nodes that a node is linked to, and those where its links enter or leave a node group."""
    for output in node.outputs:
        for link in output.links:
            yield link.to_node
    if node.type == "GROUP" and node.node_tree is not None:
        yield from (inner for inner in node.node_tree.nodes if inner.type == "GROUP_INPUT")
    if node.type == "GROUP_OUTPUT":
        for tree in compositor_trees():
            yield from (outer for outer in tree.nodes if getattr(outer, "node_tree", None) == node.id_data)


def _key(node: bpy.types.Node) -> tuple[int, str]:
    """Return what tells a node from all others."""
    return node.id_data.as_pointer(), node.name
