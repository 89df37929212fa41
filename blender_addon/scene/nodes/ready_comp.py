# SPDX-License-Identifier: GPL-3.0-or-later
"""The ready comp: the render stands over a plate that is scaled to its size, and goes to the output and a viewer."""

import bpy

from .building import GAP, IS_BLENDER_5, Socket
from .links import LOOK, linearizes, output_of

_PASSING = ("R_LAYERS", "REROUTE")  # nodes that hand the render on as it is


def is_plain(tree: bpy.types.NodeTree | None) -> bool:
    """Return whether there is no compositor tree yet, or it has an output and only hands the render through."""
    if tree is None:
        return True
    return output_of(tree) is not None and all(link.from_node.type in _PASSING for link in tree.links)


def put_render_over_plate(output: bpy.types.Node, place: tuple[float, float]) -> Socket:
    """Put all that leads to the output of a tree over a plate, and return the input that the plate has to be linked to.

    The nodes stand from a place on to the right. A Camera Look stays the last node before the output. The film of the
    tree's scenes becomes transparent, as the plate would be hidden behind the world.
    """
    tree, end = output.id_data, _end(output)
    render = end.links[0].from_socket if end.links else _render(tree)
    scale, over = _scale_to_render(tree), tree.nodes.new("CompositorNodeAlphaOver")
    viewer = next((node for node in tree.nodes if node.type == "VIEWER" and is_free(node, render)), None)
    viewer = viewer or tree.nodes.new("CompositorNodeViewer")
    background, foreground = (socket for socket in over.inputs if socket.type == "RGBA")
    foreground.default_value = (0, 0, 0, 0)  # of no render: white at first
    tree.links.new(scale.outputs["Image"], background)
    tree.links.new(render, foreground)
    tree.links.new(over.outputs["Image"], end)
    tree.links.new(over.outputs["Image"], viewer.inputs["Image"])
    over.parent = viewer.parent = end.node.parent
    over.location = end.node.location  # so that the link of the render passes above the nodes of the plate
    x, scale.location.y = place
    for node in (scale, over, end.node):
        node.location.x += max(0, x - node.location_absolute.x)
        x = node.location_absolute.x + node.width + GAP
    viewer.location = (end.node.location.x, scale.location.y)
    tree.nodes.active = viewer
    for node in tree.nodes:
        if node.type == "R_LAYERS" and node.scene is not None:
            node.scene.render.film_transparent = True
    return scale.inputs["Image"]


def is_free(viewer: bpy.types.Node, render: Socket | None = None) -> bool:
    """Return whether a viewer shows nothing, a plate behind its node group, or the socket of a render."""
    return all(link.from_socket == render or linearizes(link.from_node) for link in viewer.inputs["Image"].links)


def _end(output: bpy.types.Node) -> Socket:
    """Return the input of the output of a tree, or of a Camera Look before it."""
    end = output.inputs[0]
    if end.links and LOOK in (getattr(end.links[0].from_node, "node_tree", None) or {}):
        return end.links[0].from_node.inputs["Image"]
    return end


def _render(tree: bpy.types.NodeTree) -> Socket:
    """Return the render in a tree whose output shows nothing."""
    layers = next((node for node in tree.nodes if node.type == "R_LAYERS"), None)
    return (layers or tree.nodes.new("CompositorNodeRLayers")).outputs["Image"]


def _scale_to_render(tree: bpy.types.NodeTree) -> bpy.types.Node:
    """Return a node that scales to the size of the render, and crops what has another shape."""
    scale = tree.nodes.new("CompositorNodeScale")
    if IS_BLENDER_5:
        scale.inputs["Type"].default_value, scale.inputs["Frame Type"].default_value = "Render Size", "Crop"
    else:
        scale.space, scale.frame_method = "RENDER_SIZE", "CROP"
    return scale
