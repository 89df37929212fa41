# SPDX-License-Identifier: GPL-3.0-or-later
"""Find a plate in a compositor or shader, and put its node group behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import bpy

from ..plates import COMPOSITOR, SHADER, SHOWN, Datablock, datablock_of_node
from .building import GAP, IS_BLENDER_5, WIDTH, activate
from .links import LOOK, PLATE, groups_of, holds_group_of, key_nodes, nodes_behind, nodes_of, output_of, tree_of
from .ready_comp import is_free, put_render_over_plate

#: Holds the timing of a sequence: the image user of an editor or texture, or a compositor's Image node.
ImageUser: TypeAlias = bpy.types.ImageUser | bpy.types.CompositorNodeImage

_SAME_EXPOSURE = 1e-5  # difference, in stops, that single precision makes at most


@dataclass(frozen=True)
class FrameTiming:
    """When an image sequence shows which file."""

    duration: int  # frames
    start: int  # the frame of the scene that shows the first file
    offset: int  # the number of the first file, less 1
    is_cyclic: bool = False  # whether it starts again after its end

    @classmethod
    def from_user(cls, user: ImageUser) -> FrameTiming:
        """Return the timing that an editor or a node has."""
        return cls(user.frame_duration, user.frame_start, user.frame_offset, user.use_cyclic)

    @classmethod
    def by_number(cls, frames: Sequence[int], *, start: int) -> FrameTiming:
        """Return the timing that shows the file of the first number on a frame of the scene."""
        return cls(frames[-1] - frames[0] + 1, start, frames[0] - 1)

    def shows_any(self, frames: Sequence[int]) -> bool:
        """Return whether it shows a file of these numbers; a new editor, which shows files 1 to 100, may not."""
        return any(self.offset < frame <= self.offset + self.duration for frame in frames)

    def number_on(self, frame: int) -> int:
        """Return the number of the file that is shown on a frame of the scene, as Blender does; one less before all."""
        step = frame - self.start
        return self.offset + 1 + (step % self.duration if self.is_cyclic else max(-1, min(step, self.duration - 1)))

    def set_on(self, user: ImageUser) -> None:
        """Give it to an editor or a node."""
        user.frame_duration, user.frame_start, user.frame_offset = self.duration, self.start, self.offset
        user.use_cyclic = self.is_cyclic


@dataclass(frozen=True)
class PlateNodes:
    """A plate, its copy of code values and its node group; what its nodes in the compositor need."""

    plate: Datablock
    codes: Datablock
    group: bpy.types.NodeTree
    exposure: float  # of the Exposure socket, in stops
    is_composed: bool = False  # whether the render is put over the plate, see `ready_comp`
    timing: FrameTiming | None = None  # of a node that is added; None for a single file


def timing_of(context: bpy.types.Context, plate: Datablock, frames: Sequence[int]) -> FrameTiming | None:
    """Return the timing of a plate in the active editor, another editor or a node, the first that shows its files.

    Without one, every file is shown on the frame of its number. `frames` are the numbers of the files. Single files,
    which have none, and clips, which keep their own, have no timing: None.
    """
    if not frames or not isinstance(plate, bpy.types.Image):
        return None
    timings = map(FrameTiming.from_user, _users(context, plate))
    set_by_user = (timing for timing in timings if timing.duration > 1 and timing.shows_any(frames))
    return next(set_by_user, FrameTiming.by_number(frames, start=frames[0]))


def compositor_tree(scene: bpy.types.Scene) -> bpy.types.NodeTree:
    """Return the scene's compositor tree; a new one hands the render through, so that the picture stays the same."""
    if not IS_BLENDER_5:
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


def tree_shown_in(context: bpy.types.Context) -> bpy.types.NodeTree | None:
    """Return the compositor tree that the node editor shows, or else the scene's; None if the scene has none yet."""
    tree = getattr(context.space_data, "edit_tree", None)
    return tree if tree is not None and tree.bl_idname == COMPOSITOR else tree_of(context.scene)


def shader_shown_in(context: bpy.types.Context, plate: Datablock) -> bpy.types.NodeTree | None:
    """Return the shader tree that the node editor shows if a node of it shows a plate; else None."""
    tree = getattr(context.space_data, "edit_tree", None)
    return tree if tree is not None and tree.bl_idname == SHADER and _sources(tree, plate) else None


def can_compose(context: bpy.types.Context, plate: Datablock) -> bool:
    """Return whether the render can be put over a plate: the shown tree has an output, and the plate leads nowhere."""
    tree, shader = tree_shown_in(context), shader_shown_in(context, plate)
    if tree is None or shader is not None:
        return shader is None
    return output_of(tree) is not None and not any(n.outputs["Image"].is_linked for n in _sources(tree, plate))


def is_output(node: bpy.types.Node, scene: bpy.types.Scene) -> bool:
    """Return whether a node is the output of a scene's compositor."""
    tree = tree_of(scene)
    return tree is not None and node == output_of(tree)


def is_switched_off(scene: bpy.types.Scene) -> bool:
    """Return whether the user has switched off the compositor of a scene, as Blender 4.5 allows."""
    return not IS_BLENDER_5 and not scene.use_nodes


def apply_group(scene: bpy.types.Scene, tree: bpy.types.NodeTree, wanted: PlateNodes) -> None:
    """Linearize a plate in a compositor or shader tree: its nodes show its code values, and lead to its node group.

    The links from the plate then start at the group. A group that follows already, whatever stands between, is only
    brought up to date, as all nodes of the group are but for those of other scenes: these keep their exposure. If no
    node shows the plate, one is added, with a viewer. On demand the render is put over it; see `can_compose`.
    """
    sources = _sources(tree, wanted.plate)
    if not sources or wanted.is_composed:
        sources = sources or [_add_plate(tree, wanted)]
        _link_on(tree, sources[0], wanted)
    for source in sources:
        setattr(source, SHOWN[source.type], wanted.codes)  # its frame settings stay
        source.label = source.label or f"{wanted.plate.name} code values"
        if not _groups_behind(source, wanted.plate):
            activate(_insert(tree, source, wanted.group))
        _link_alpha(source, wanted.plate)
    for node in groups_of(wanted.plate, scene):
        if node.node_tree.bl_idname == tree.bl_idname:
            node.node_tree = wanted.group
        node.mute = False
        node.inputs["Exposure"].default_value = wanted.exposure


def set_exposure(plate: Datablock, scene: bpy.types.Scene, exposure: float) -> None:
    """Set the exposure, in stops, of all nodes of a plate's node group or Camera Look; not of other scenes."""
    for node in groups_of(plate, scene, PLATE) + groups_of(plate, scene, LOOK):
        node.inputs["Exposure"].default_value = exposure


def is_linearized(plate: Datablock, context: bpy.types.Context) -> bool:
    """Return whether a node shows a plate or its code values, and leads to its node group; not in another scene.

    If the editor shows a shader with the plate, only the nodes of this count.
    """
    groups, shader = groups_of(plate, context.scene), shader_shown_in(context, plate)
    sources = nodes_of(plate) if shader is None else _sources(shader, plate)
    return any(node in groups for source in sources for node in _groups_behind(source, plate))


def has_exposure(plate: Datablock, scene: bpy.types.Scene, exposure: float) -> bool:
    """Return whether all nodes of a plate's group have an exposure, but for those of other scenes and linked ones."""
    sockets = [node.inputs["Exposure"] for node in groups_of(plate, scene)]
    return all(socket.is_linked or abs(socket.default_value - exposure) < _SAME_EXPOSURE for socket in sockets)


def _groups_behind(source: bpy.types.Node, plate: Datablock) -> list[bpy.types.Node]:
    """Return the nodes of a plate's group that a node leads to."""
    return [node for node in nodes_behind(source) if holds_group_of(node, plate)]


def _insert(tree: bpy.types.NodeTree, source: bpy.types.Node, group: bpy.types.NodeTree) -> bpy.types.Node:
    """Return a new node of the group between a plate's node and the nodes that it was linked to."""
    node = tree.nodes.new(tree.bl_idname.replace("NodeTree", "NodeGroup"))
    node.node_tree = group
    node.width = WIDTH
    node.location = (source.location.x + source.width + GAP, source.location.y)
    node.parent = source.parent
    _make_room(source, node)
    for target in [link.to_socket for link in source.outputs[0].links]:
        tree.links.new(node.outputs[0], target)
    tree.links.new(source.outputs[0], node.inputs[0])
    return node


def _link_alpha(source: bpy.types.Node, plate: Datablock) -> None:
    """Link the alpha of a texture to those of its groups that divide by it."""
    for node in _groups_behind(source, plate):
        if "Alpha" in node.inputs and "Alpha" in source.outputs and node.id_data == source.id_data:
            source.id_data.links.new(source.outputs["Alpha"], node.inputs["Alpha"])


def _make_room(source: bpy.types.Node, node: bpy.types.Node) -> None:
    """Move the nodes behind a plate's node to the right, so that a new node has room between them."""
    behind = [other for other in nodes_behind(source) if other != node and other.id_data == node.id_data]
    nearest = min((other.location_absolute.x for other in behind), default=None)
    if nearest is None:
        return
    missing = node.location_absolute.x + node.width + GAP - nearest
    if missing > 0:
        for other in behind:
            other.location.x += missing


def _add_plate(tree: bpy.types.NodeTree, wanted: PlateNodes) -> bpy.types.Node:
    """Return a new node for the plate, below all others."""
    bottom = min((node.location_absolute.y - node.height for node in tree.nodes), default=0)
    if isinstance(wanted.plate, bpy.types.Image):
        node = tree.nodes.new("CompositorNodeImage")
        node.image = wanted.codes
        if wanted.timing is not None:
            wanted.timing.set_on(node)
    else:
        node = tree.nodes.new("CompositorNodeMovieClip")
    node.location, node.width = (0, bottom - 300), WIDTH
    return node


def _link_on(tree: bpy.types.NodeTree, source: bpy.types.Node, wanted: PlateNodes) -> None:
    """Link the node of a plate to the ready comp, or to a viewer that shows nothing else."""
    place = (source.location_absolute.x + source.width + GAP, source.location_absolute.y)
    output = output_of(tree)
    if wanted.is_composed and output is not None:
        target = put_render_over_plate(output, place)
    else:
        viewer = next((node for node in tree.nodes if node.type == "VIEWER" and is_free(node)), None)
        if viewer is None:
            viewer = tree.nodes.new("CompositorNodeViewer")
            viewer.location = place
        tree.nodes.active, target = viewer, viewer.inputs["Image"]
    tree.links.new(source.outputs["Image"], target)


def _sources(tree: bpy.types.NodeTree, plate: Datablock) -> list[bpy.types.Node]:
    """Return the nodes of a tree that show a plate or its code values."""
    return [node for node in key_nodes(tree) if datablock_of_node(node) == plate]


def _users(context: bpy.types.Context, plate: bpy.types.Image) -> Iterator[ImageUser]:
    """Yield the editors, then the nodes, that show an image and may have set its timing."""
    areas = [area for screen in bpy.data.screens for area in screen.areas]
    for space in (context.space_data, *(area.spaces.active for area in areas)):
        if space is not None and space.type == "IMAGE_EDITOR" and space.image == plate:
            yield space.image_user
    yield from (getattr(node, "image_user", node) for node in nodes_of(plate))
