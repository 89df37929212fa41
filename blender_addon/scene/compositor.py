# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a plate's node group goes in the compositor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy

from .plates import Datablock, node_plate

_GAP = 60


def compositor_tree(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    """Return the scene's compositor tree; a new one passes the render through, so that nothing looks different."""
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
    """Put a node group behind every node of a tree that shows the plate.

    What the plate was linked to is linked to the group; a group that is there already is only brought up to date. If
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
        For the Exposure socket.
    frames : sequence of int
        The plate's frame numbers, for a new node.
    """
    sources = [node for node in tree.nodes if node_plate(node) == datablock] or [_plate_node(tree, datablock, frames)]
    for source in sources:
        node = next(_followers(source, group), None) or _inserted(tree, source, group)
        node.inputs["Exposure"].default_value = exposure


def show_frames(user: bpy.types.ImageUser | bpy.types.CompositorNodeImage, frames: Sequence[int]) -> None:
    """Let an image sequence show the file of each frame number on that frame."""
    if frames:
        user.frame_duration = frames[-1] - frames[0] + 1
        user.frame_start, user.frame_offset = frames[0], frames[0] - 1


def _followers(source: bpy.types.Node, group: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """Yield the nodes of the group that a plate is linked to."""
    for link in source.outputs["Image"].links:
        if getattr(link.to_node, "node_tree", None) == group:
            yield link.to_node


def _inserted(tree: bpy.types.NodeTree, source: bpy.types.Node, group: bpy.types.NodeTree) -> bpy.types.Node:
    """Return a new node of the group between a plate and what the plate was linked to."""
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree = group
    node.width = 220
    node.location = (source.location.x + source.width + _GAP, source.location.y)
    node.parent = source.parent
    for target in [link.to_socket for link in source.outputs["Image"].links]:
        tree.links.new(node.outputs["Image"], target)
    tree.links.new(source.outputs["Image"], node.inputs["Image"])
    return node


def _plate_node(tree: bpy.types.NodeTree, datablock: Datablock, frames: Sequence[int]) -> bpy.types.Node:
    """Return a new node that shows the plate, below the others, linked to a viewer."""
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
