# SPDX-License-Identifier: GPL-3.0-or-later
"""Find a plate in the compositor, and put its node group behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy

from .plates import Datablock, datablock_of_node

#: Distance between a plate's node and its node group, in units of the node editor.
_GAP = 60


def compositor_tree(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    """Return the scene's compositor tree; a new one hands the render through, so that the picture stays the same."""
    if bpy.app.version < (5, 0, 0):
        scene.use_nodes = True
        return scene.node_tree
    if scene.compositing_node_group is None:
        tree = bpy.data.node_groups.new("Compositor Nodes", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        render, output = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("NodeGroupOutput")
        output.location.x = 500
        tree.links.new(render.outputs["Image"], output.inputs[0])
        scene.compositing_node_group = tree
    return scene.compositing_node_group


def apply_group(
    tree: bpy.types.NodeTree,
    datablock: Datablock,
    group: bpy.types.NodeTree,
    exposure: float,
    *,
    frames: Sequence[int] = (),
) -> None:
    """Insert a node group after every node of a tree that shows the plate.

    The links from the plate then start at the group. Where the group was inserted before, only its exposure is set. If
    no node shows the plate, one is added, with a viewer.

    Parameters
    ----------
    tree : NodeTree
        The compositor's tree.
    datablock : Image or MovieClip
        The plate.
    group : NodeTree
        The plate's node group.
    exposure : float
        The value of the Exposure socket, in stops.
    frames : sequence of int
        The frame numbers of the plate, for a node that is added; empty for a single file.
    """
    sources = [node for node in tree.nodes if datablock_of_node(node) == datablock]
    for source in sources or [_add_plate(tree, datablock, frames)]:
        node = next(_group_nodes(source, group), None) or _insert(tree, source, group)
        node.inputs["Exposure"].default_value = exposure


def show_frames(user: bpy.types.ImageUser | bpy.types.CompositorNodeImage, frames: Sequence[int]) -> None:
    """Make an image sequence show every file on the frame of its number."""
    if frames:
        user.frame_duration = frames[-1] - frames[0] + 1
        user.frame_start, user.frame_offset = frames[0], frames[0] - 1


def _group_nodes(source: bpy.types.Node, group: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """Yield the nodes of the group that a plate's node is linked to."""
    for link in source.outputs["Image"].links:
        if getattr(link.to_node, "node_tree", None) == group:
            yield link.to_node


def _insert(tree: bpy.types.NodeTree, source: bpy.types.Node, group: bpy.types.NodeTree) -> bpy.types.Node:
    """Return a new node of the group between a plate's node and the nodes that it was linked to."""
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree = group
    node.width = 220
    node.location = (source.location.x + source.width + _GAP, source.location.y)
    node.parent = source.parent
    for target in [link.to_socket for link in source.outputs["Image"].links]:
        tree.links.new(node.outputs["Image"], target)
    tree.links.new(source.outputs["Image"], node.inputs["Image"])
    return node


def _add_plate(tree: bpy.types.NodeTree, datablock: Datablock, frames: Sequence[int]) -> bpy.types.Node:
    """Return a new node that shows the plate, below all others and linked to a viewer."""
    bottom = min((node.location.y - node.height for node in tree.nodes), default=0)
    if isinstance(datablock, bpy.types.Image):
        node = tree.nodes.new("CompositorNodeImage")
        node.image = datablock
        show_frames(node, frames)
    else:
        node = tree.nodes.new("CompositorNodeMovieClip")
        node.clip = datablock
    viewer = tree.nodes.new("CompositorNodeViewer")
    node.location, viewer.location = (0, bottom - 200), (700, bottom - 200)
    tree.links.new(node.outputs["Image"], viewer.inputs["Image"])
    return node
