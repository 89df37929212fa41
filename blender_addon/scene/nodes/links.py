# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the nodes behind a node, through reroutes, other nodes and node groups, and plates linearized twice or never."""

from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from typing import Any

import bpy

from ..plates import NODE_TREES, SHADER, SHOWN, Datablock, datablock_of_node, shown_by_node

# Custom properties of the add-on's node groups:
PLATE = "camera_response_of"  # the plate's image or clip
LOOK = "camera_response_look_of"  # the same, of a "Camera Look"
WORKING_SPACE = "camera_response_working_space"  # of a shader's, the name of the working space that it converts to

#: The types of nodes that may show an image or clip, or hold a node group.
_KEY_TYPES = ("GROUP", *SHOWN)

#: The answers of functions that are `_asked_once`, by function and arguments; None but for `trees_at_rest`.
_answers: dict[Any, Any] | None = None


class _Way(StrEnum):
    """How a path comes to a node."""

    LINKED = "the path has not entered the tree of the node"
    ENTERED = "the path has entered the tree of the node from a node that holds it"
    LEFT = "the path has left the tree that the node holds"


@contextmanager
def trees_at_rest() -> Iterator[None]:
    """Read every tree only once in a block that changes none, as where a panel is drawn."""
    global _answers
    _answers = {}
    try:
        yield
    finally:
        _answers = None


def _asked_once(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of trees, nodes or plates that keeps its answers while trees are at rest."""

    def asked(*about: Any) -> Any:
        if _answers is None:
            with trees_at_rest():
                return asked(*about)
        if (function, about) not in _answers:
            _answers[function, about] = function(*about)
        return _answers[function, about]

    return asked


@_asked_once
def key_nodes(tree: bpy.types.NodeTree) -> list[bpy.types.Node]:
    """Return the nodes of a tree that may show an image or clip, or hold a node group; a file has thousands."""
    return [node for node in tree.nodes if node.type in _KEY_TYPES]


@_asked_once
def _targets(tree: bpy.types.NodeTree) -> dict[bpy.types.Node, list[bpy.types.Node]]:
    """Return the nodes that each node of a tree is linked to: Blender goes through all links for those of a socket."""
    targets = defaultdict(list)
    for link in tree.links:
        targets[link.from_node].append(link.to_node)
    return targets


@_asked_once
def nodes_behind(node: bpy.types.Node) -> list[bpy.types.Node]:
    """Return every other node that the outputs of a node lead to, nearest first.

    Where the links enter a node group, the nodes in it follow; where they leave the tree of the node, the nodes behind
    every node that holds this tree. A path that entered a tree does not leave it, because other nodes that hold it,
    such as in another scene, are not behind this one.
    """
    steps, seen = [(node, _Way.LINKED)], {(node, _Way.LINKED)}
    for step in steps:  # more and more
        for follower in _followers(*step):
            if follower not in seen:
                seen.add(follower)
                steps.append(follower)
    return [other for other in dict.fromkeys(other for other, _ in steps) if other != node]


def node_trees() -> Iterator[bpy.types.NodeTree]:
    """Yield every compositor and shader tree of the file, node groups included; shaders once they have a group."""
    yield from (tree for tree in bpy.data.node_groups if tree.bl_idname in NODE_TREES)
    owners = list(bpy.data.scenes) if bpy.app.version < (5, 0, 0) else []  # later, their trees are node groups, too
    if any(PLATE in tree and tree.bl_idname == SHADER for tree in bpy.data.node_groups):  # a file may have thousands
        owners += (*bpy.data.materials, *bpy.data.worlds, *bpy.data.lights, *bpy.data.linestyles)
    yield from (owner.node_tree for owner in owners if owner.node_tree is not None)


def tree_of(scene: bpy.types.Scene) -> bpy.types.NodeTree | None:
    """Return the compositor tree of a scene; None if it has none yet."""
    return scene.node_tree if bpy.app.version < (5, 0, 0) else scene.compositing_node_group


@_asked_once
def trees_here(scene: bpy.types.Scene) -> list[bpy.types.NodeTree]:
    """Return the node trees of the file, but for those of other scenes only, such as of a full copy of this."""
    of_others = {tree for other in bpy.data.scenes if other != scene for tree in _trees_of(other)}
    apart = of_others.difference(_trees_of(scene))
    return [tree for tree in node_trees() if tree not in apart]


def _trees_of(scene: bpy.types.Scene) -> Iterator[bpy.types.NodeTree]:
    """Yield the trees of a scene's compositor, world and lights, which a full copy has of its own; not of materials."""
    yield from _trees_in(tree_of(scene))
    lights = {item.data for item in scene.objects if item.type == "LIGHT"}
    for owner in filter(None, (scene.world, *lights)):
        yield from _trees_in(owner.node_tree)


def _trees_in(tree: bpy.types.NodeTree | None) -> Iterator[bpy.types.NodeTree]:
    """Yield a tree, unless it is None, and the node groups in it."""
    if tree is not None:
        yield tree
        for inner in {node.node_tree for node in key_nodes(tree) if node.type == "GROUP"}:
            yield from _trees_in(inner)


def has_groups() -> bool:
    """Return whether the file has node groups of the add-on."""
    return any(PLATE in group or LOOK in group for group in bpy.data.node_groups)


@_asked_once
def nodes_of(plate: Datablock) -> list[bpy.types.Node]:
    """Return the nodes of the file that show a plate or its code values."""
    return [node for tree in node_trees() for node in key_nodes(tree) if datablock_of_node(node) == plate]


@_asked_once
def groups_of(plate: Datablock, scene: bpy.types.Scene, name: str = PLATE) -> list[bpy.types.Node]:
    """Return the nodes that hold a plate's node group, or look, and are not those of other scenes only."""
    return [node for tree in trees_here(scene) for node in key_nodes(tree) if holds_group_of(node, plate, name)]


def holds_group_of(node: bpy.types.Node, plate: Datablock, name: str = PLATE) -> bool:
    """Return whether a node holds a plate's node group, or look, muted or not."""
    tree = node.node_tree if node.type == "GROUP" else None
    return tree is not None and tree.get(name) == plate


def linearized_twice(plate: Datablock) -> str:
    """Return why a plate is linearized twice in nodes of the file, and what to do; else an empty text."""
    for node in nodes_of(plate):
        groups = [other for other in nodes_behind(node) if linearizes(other)]
        if groups and shown_by_node(node) == plate and not plate.colorspace_settings.is_data:
            return f'Linearized twice: "{_title(node)}" shows no code values. Apply as Nodes to mend it.'
        if any(linearizes(other) for group in groups for other in nodes_behind(group)):
            return f'Linearized twice: two node groups follow "{_title(node)}". Remove one.'
    return ""


def without_group(plate: Datablock) -> str:
    """Return that nodes of the file show a plate's code values without its group, and what to do; else an empty text.

    The node group is muted, or it was deleted and the links around it were made again.
    """
    for node in nodes_of(plate):
        behind = nodes_behind(node)
        if shown_by_node(node) != plate and behind and not any(map(linearizes, behind)):
            return f'"{_title(node)}" shows code values without the node group. Apply as Nodes to mend it.'
    return ""


def in_earlier_space(plate: Datablock) -> str:
    """Return that a plate's shader nodes convert to an earlier working space, and what to do; else an empty text."""
    spaces = {group.get(WORKING_SPACE) for group in bpy.data.node_groups if group.get(PLATE) == plate} - {None}
    return "The working space has changed: apply as Nodes for the shaders." if spaces - {file_space()} else ""


def file_space() -> str:
    """Return the name of the file's working space; an empty text before Blender 5.0, where it is the config's."""
    return getattr(getattr(bpy.data, "colorspace", None), "working_space", "")


def linearizes(node: bpy.types.Node) -> bool:
    """Return whether a node holds the node group of any plate, and is not muted."""
    return node.type == "GROUP" and node.node_tree is not None and PLATE in node.node_tree and not node.mute


def output_of(tree: bpy.types.NodeTree) -> bpy.types.Node | None:
    """Return the node whose input is rendered; None if the tree has none."""
    kinds = ("COMPOSITE", "GROUP_OUTPUT")
    return next((node for node in tree.nodes if node.type in kinds and node.inputs), None)


def _title(node: bpy.types.Node) -> str:
    """Return the text in the head of a node."""
    return node.label or node.name


def _followers(node: bpy.types.Node, way: _Way) -> Iterator[tuple[bpy.types.Node, _Way]]:
    """Yield the nodes that a node is linked to, and those where its links enter or leave a node group.

    A path does not leave a tree that it entered, nor enter at once the tree that it left.
    """
    for target in _targets(node.id_data).get(node, ()):
        yield target, _Way.ENTERED if way is _Way.ENTERED else _Way.LINKED
    if node.type == "GROUP" and node.node_tree is not None and way is not _Way.LEFT:
        yield from ((inner, _Way.ENTERED) for inner in node.node_tree.nodes if inner.type == "GROUP_INPUT")
    if node.type == "GROUP_OUTPUT" and way is not _Way.ENTERED:
        for outer in (outer for tree in node_trees() for outer in key_nodes(tree) if outer.type == "GROUP"):
            if outer.node_tree == node.id_data:
                yield outer, _Way.LEFT
