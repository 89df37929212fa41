"""Plates: open them, choose how the response is applied, read what was stored, render and compare linear values."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
import editors
import numpy as np

#: The custom property that holds an estimate.
KEY = "camera_response"


def open_image(path: str, *, names: tuple[str, ...] = (), finds_tiles: bool = True, sequence: bool = False) -> str:
    """Open a file, or several as in the file browser, in the Image Editor; return the name of its image."""
    found = Path(path)
    files = [{"name": name} for name in (names or (found.name,))]
    with editors.context("IMAGE_EDITOR"):
        bpy.ops.image.open(
            "EXEC_DEFAULT",
            True,
            filepath=path,
            directory=str(found.parent),
            files=files,
            relative_path=False,
            use_sequence_detection=sequence,
            use_udim_detecting=finds_tiles,
        )
        image = bpy.context.space_data.image
        bpy.ops.image.view_zoom_ratio(ratio=min(1, bpy.context.region.width / 2 / max(1, image.size[0])))
    bpy.ops.ed.undo_push(message="Open")
    return image.name


def show_image(name: str) -> None:
    """Show an image in the Image Editor."""
    editors.area("IMAGE_EDITOR").spaces.active.image = bpy.data.images[name]


def choose(name: str, **settings: Any) -> None:
    """Set settings of the panel on an image."""
    for setting, value in settings.items():
        setattr(bpy.data.images[name].camera_response_settings, setting, value)
    bpy.ops.ed.undo_push(message="Choose")


def stored(name: str) -> dict[str, Any] | None:
    """Return the stored estimate of an image; None if it has none."""
    entries = bpy.data.images[name].get(KEY)
    return None if entries is None else entries.to_dict()


def window_sides(name: str) -> list[list[float]]:
    """Return where the middle of the left side of each analysed window that agrees with the others is on the screen."""
    image, region = bpy.data.images[name], editors.region("IMAGE_EDITOR", "WINDOW")
    places, agrees = image[KEY]["window_places"], image[KEY]["window_kept"]
    found = []
    for index in (index for index, kept in enumerate(agrees) if kept):
        x, y, step, _ = places[4 * index : 4 * index + 4]
        middle = y + (226 * step + 1) / 2
        view = region.view2d.view_to_region(x / image.size[0], 1 - middle / image.size[1], clip=False)
        found.append([region.x + view[0], editors.window().height - region.y - view[1]])
    return found


def state() -> dict[str, Any]:
    """Return what a run could change: images with their color spaces and estimates, groups, nodes and links."""
    trees = [*bpy.data.node_groups, *(s.node_tree for s in bpy.data.scenes if getattr(s, "node_tree", None))]
    return {
        "images": {i.name: [i.colorspace_settings.name, i.source, KEY in i] for i in bpy.data.images},
        "groups": sorted(group.name for group in bpy.data.node_groups),
        "nodes": sorted(f"{tree.name}/{node.name}" for tree in trees for node in tree.nodes),
        "links": sorted(f"{link.from_node.name} > {link.to_node.name}" for tree in trees for link in tree.links),
    }


def tree() -> Any:
    """Return the compositor tree of the scene."""
    scene = bpy.context.scene
    return scene.compositing_node_group if bpy.app.version >= (5, 0, 0) else scene.node_tree


def plate_nodes(name: str) -> list[bpy.types.Node]:
    """Return the nodes of the compositor that show the file of an image."""
    file = bpy.path.abspath(bpy.data.images[name].filepath)
    shown = [node for node in tree().nodes if node.type == "IMAGE" and node.image]
    return [node for node in shown if bpy.path.abspath(node.image.filepath) == file]


def groups_behind(name: str) -> list[str]:
    """Return the names of the node groups that the light of an image goes through, whatever stands in between."""
    found, waiting = [], plate_nodes(name)
    while waiting:
        node = waiting.pop()
        found += [node.node_tree.name] if node.type == "GROUP" else []
        waiting += [link.to_node for socket in node.outputs for link in socket.links]
    return found


def put_between(name: str, kind: str) -> None:
    """Put a node, such as ``NodeReroute``, between a plate and what it is linked to."""
    (plate,) = plate_nodes(name)
    node = tree().nodes.new(kind)
    for target in [link.to_socket for link in plate.outputs["Image"].links]:
        tree().links.new(node.outputs[0], target)
    tree().links.new(plate.outputs["Image"], node.inputs[0])


def last_socket(name: str) -> bpy.types.NodeSocket:
    """Return the socket at which the light of a plate leaves its last node group."""
    (node,) = plate_nodes(name)
    socket = node.outputs["Image"]
    waiting = [link.to_node for link in socket.links]
    while waiting:
        node = waiting.pop()
        socket = node.outputs[0] if node.type == "GROUP" else socket
        waiting += [link.to_node for output in node.outputs for link in output.links]
    return socket


def render(name: str, path: str) -> str:
    """Render what the compositor makes of a plate, behind its last node group, to a float EXR file of its size."""
    scene, image = bpy.context.scene, bpy.data.images[name]
    wanted = "GROUP_OUTPUT" if bpy.app.version >= (5, 0, 0) else "COMPOSITE"
    output = next(node for node in tree().nodes if node.type == wanted)
    tree().links.new(last_socket(name), output.inputs[0])
    for node in [node for node in tree().nodes if node.type == "R_LAYERS"]:
        tree().nodes.remove(node)  # nothing is to be rendered
    settings = scene.render
    settings.resolution_x, settings.resolution_y = image.size
    settings.resolution_percentage, settings.dither_intensity, settings.use_sequencer = 100, 0, False
    settings.compositor_device, settings.compositor_precision = "CPU", "FULL"
    if hasattr(settings.image_settings, "media_type"):
        settings.image_settings.media_type = "IMAGE"
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_depth, settings.image_settings.color_mode = "32", "RGBA"
    settings.filepath = path
    bpy.ops.render.render(write_still=True)
    return path


def decoded(name: str, path: str) -> str:
    """Write the pixels of an image, decoded by its color space to scene-linear light, to a float EXR file."""
    scene, image = bpy.context.scene, bpy.data.images[name]
    if bpy.app.version >= (5, 0, 0):
        made = bpy.data.node_groups.new("Decoded", "CompositorNodeTree")
        made.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group, output = made, made.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        scene.node_tree.nodes.clear()
        output = scene.node_tree.nodes.new("CompositorNodeComposite")
    node = tree().nodes.new("CompositorNodeImage")
    node.image = image
    tree().links.new(node.outputs["Image"], output.inputs[0])
    return render(name, path)


def largest_difference(path: str, expected: str) -> float:
    """Return the largest absolute difference between the colors of two EXR files, in linear values."""
    found, wanted = _pixels(path)[..., :3], _pixels(expected)[..., :3]
    if found.shape != wanted.shape:
        raise ValueError(f"{path} is {found.shape}, {expected} is {wanted.shape}")
    return float(np.abs(found - wanted).max())


def _pixels(path: str) -> Any:
    """Return the pixels of a file, float32, shape (H, W, C)."""
    import OpenImageIO as oiio

    return oiio.ImageBuf(path).get_pixels(oiio.FLOAT)
