# SPDX-License-Identifier: GPL-3.0-or-later
"""Find a plate in the compositor, and put its node group behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import bpy

from .node_building import GAP, WIDTH
from .node_links import is_group_of, linearizes, neighbors_behind, nodes_behind, nodes_of
from .plates import Datablock, datablock_of_node

#: What shows an image and knows the frames of a sequence: an editor's, or a compositor's Image node itself.
ImageUser: TypeAlias = bpy.types.ImageUser | bpy.types.CompositorNodeImage


@dataclass(frozen=True)
class FrameTiming:
    """When an image sequence shows which file.

    Parameters
    ----------
    duration : int
        The number of frames.
    start : int
        The frame of the scene that shows the first one.
    offset : int
        Is added to the frame within the sequence, 1 for the first one, to get the number of the file.
    is_cyclic : bool
        Whether it starts again after its end.
    """

    duration: int
    start: int
    offset: int
    is_cyclic: bool = False

    @classmethod
    def of_user(cls, user: ImageUser) -> FrameTiming:
        """Return the timing that an editor or a node has."""
        return cls(user.frame_duration, user.frame_start, user.frame_offset, user.use_cyclic)

    @classmethod
    def by_number(cls, frames: Sequence[int]) -> FrameTiming:
        """Return the timing that shows every file on the frame of its number."""
        return cls(frames[-1] - frames[0] + 1, frames[0], frames[0] - 1)

    @classmethod
    def from_scene_start(cls, frames: Sequence[int]) -> FrameTiming:
        """Return the timing that shows the first file on frame 1 of the scene, as where Blender opens a sequence."""
        return cls(frames[-1] - frames[0] + 1, 1, frames[0] - 1)

    def shows_any(self, frames: Sequence[int]) -> bool:
        """Return whether it shows one of the files of these numbers; that of a new editor, files 1 to 100, may not."""
        return any(self.offset < frame <= self.offset + self.duration for frame in frames)

    def set_on(self, user: ImageUser) -> None:
        """Give it to an editor or a node."""
        user.frame_duration, user.frame_start, user.frame_offset = self.duration, self.start, self.offset
        user.use_cyclic = self.is_cyclic


@dataclass(frozen=True)
class PlateNodes:
    """A plate, and what its nodes in the compositor need.

    Parameters
    ----------
    plate : Image or MovieClip
        The plate.
    name : str
        Its name, by which earlier versions marked its node group.
    codes : Image or MovieClip
        Its copy whose pixels are code values.
    group : NodeTree
        Its node group.
    exposure : float
        The value of the Exposure socket, in stops.
    timing : FrameTiming or None
        When a node that is added shows which frame of a sequence; None for a single file.
    """

    plate: Datablock
    name: str
    codes: Datablock
    group: bpy.types.NodeTree
    exposure: float
    timing: FrameTiming | None = None


def timing_of(context: bpy.types.Context, plate: Datablock, frames: Sequence[int]) -> FrameTiming | None:
    """Return the timing of a plate where it is shown already, in the active editor, another one or a node.

    Where it is shown nowhere, or with a timing that nobody has set, every file is shown on the frame of its number.

    Parameters
    ----------
    context : Context
        Its editor comes first.
    plate : Image or MovieClip
        The plate.
    frames : sequence of int
        The numbers of its files; empty for a single file, which has no timing, as clips, which keep their own.
    """
    if not frames or not isinstance(plate, bpy.types.Image):
        return None
    timings = map(FrameTiming.of_user, _users(context, plate))
    set_by_user = (timing for timing in timings if timing.duration > 1 and timing.shows_any(frames))
    return next(set_by_user, FrameTiming.by_number(frames))


def compositor_tree(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    """Return the scene's compositor tree; a new one hands the render through, so that the picture stays the same."""
    if bpy.app.version < (5, 0, 0):
        if scene.node_tree is None:
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


def is_switched_off(scene: bpy.types.Scene) -> bool:
    """Return whether the user has switched off the compositor of a scene, as Blender 4.5 allows."""
    return bpy.app.version < (5, 0, 0) and not scene.use_nodes


def apply_group(tree: bpy.types.NodeTree, wanted: PlateNodes) -> None:
    """Linearise a plate in a compositor tree: every node that shows it shows its code values, with the group behind.

    The links from the plate then start at the group. Where the group follows already, whatever stands between, it is
    brought up to date only, and so is every other node of the group in the file. If no node shows the plate, one is
    added, with a viewer.
    """
    sources = [node for node in tree.nodes if datablock_of_node(node) == wanted.plate]
    for source in sources or [_add_plate(tree, wanted)]:
        _show(source, wanted.codes)
        if next(_groups_behind(source, wanted.plate, wanted.name), None) is None:
            _activate(_insert(tree, source, wanted.group))
        for node in _groups_behind(source, wanted.plate, wanted.name):
            node.node_tree = wanted.group
            node.inputs["Exposure"].default_value = wanted.exposure


def linearized_nodes(plate: Datablock, name: str) -> list[bpy.types.Node]:
    """Return the nodes of the file that show a plate or its code values, and have its node group behind them."""
    return [node for node in nodes_of(plate) if next(_groups_behind(node, plate, name), None) is not None]


def _groups_behind(source: bpy.types.Node, plate: Datablock, name: str) -> Iterator[bpy.types.Node]:
    """Yield the nodes of a plate's group that a node leads to."""
    for node in nodes_behind(source):
        if is_group_of(getattr(node, "node_tree", None), plate, name):
            yield node


def _show(node: bpy.types.Node, codes: Datablock) -> None:
    """Show the code values of a plate in a node; its frame settings stay."""
    if node.type == "IMAGE":
        node.image = codes
    else:
        node.clip = codes
    node.label = node.label or codes.name


def _insert(tree: bpy.types.NodeTree, source: bpy.types.Node, group: bpy.types.NodeTree) -> bpy.types.Node:
    """Return a new node of the group between a plate's node and the nodes that it was linked to."""
    node = tree.nodes.new("CompositorNodeGroup")
    node.node_tree = group
    node.width = WIDTH
    node.location = (source.location.x + source.width + GAP, source.location.y)
    node.parent = source.parent
    _make_room(source, node)
    for target in [link.to_socket for link in source.outputs["Image"].links]:
        tree.links.new(node.outputs["Image"], target)
    tree.links.new(source.outputs["Image"], node.inputs["Image"])
    return node


def _make_room(source: bpy.types.Node, node: bpy.types.Node) -> None:
    """Move the nodes behind a plate's node to the right, so that a new node has room between them."""
    behind = [other for other in neighbors_behind(source) if other != node]
    nearest = min((_left(other) for other in behind), default=None)
    if nearest is None:
        return
    missing = _left(node) + node.width + GAP - nearest
    if missing > 0:
        for other in behind:
            other.location.x += missing


def _left(node: bpy.types.Node) -> float:
    """Return the left edge of a node, whatever frame it is in."""
    return node.location_absolute.x


def _activate(node: bpy.types.Node) -> None:
    """Select a node, and no other one of its tree."""
    for other in node.id_data.nodes:
        other.select = other == node
    node.id_data.nodes.active = node


def _add_plate(tree: bpy.types.NodeTree, wanted: PlateNodes) -> bpy.types.Node:
    """Return a new node for the plate, below all others and linked to a viewer; one that shows something else stays."""
    bottom = min((node.location_absolute.y - node.height for node in tree.nodes), default=0)
    if isinstance(wanted.plate, bpy.types.Image):
        node = tree.nodes.new("CompositorNodeImage")
        node.image = wanted.codes
        if wanted.timing is not None:
            wanted.timing.set_on(node)
    else:
        node = tree.nodes.new("CompositorNodeMovieClip")
    node.location = (0, bottom - 200)
    viewer = next((other for other in tree.nodes if other.type == "VIEWER" and _is_free(other)), None)
    if viewer is None:
        viewer = tree.nodes.new("CompositorNodeViewer")
        viewer.location = (700, bottom - 200)
    tree.links.new(node.outputs["Image"], viewer.inputs["Image"])
    tree.nodes.active = viewer
    return node


def _is_free(viewer: bpy.types.Node) -> bool:
    """Return whether a viewer shows nothing, or a plate behind its node group."""
    return all(linearizes(link.from_node) for link in viewer.inputs["Image"].links)


def _users(context: bpy.types.Context, plate: bpy.types.Image) -> Iterator[ImageUser]:
    """Yield what shows an image and may have set its timing: editors, then nodes."""
    areas = [area for screen in bpy.data.screens for area in screen.areas]
    for space in (context.space_data, *(area.spaces.active for area in areas)):
        if space is not None and space.type == "IMAGE_EDITOR" and space.image == plate:
            yield space.image_user
    yield from (node for node in nodes_of(plate) if node.type == "IMAGE")
