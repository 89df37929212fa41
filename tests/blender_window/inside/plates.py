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


def choose(name: str, **settings: Any) -> None:
    """Set settings of the panel on an image."""
    for setting, value in settings.items():
        setattr(bpy.data.images[name].camera_response_settings, setting, value)
    bpy.ops.ed.undo_push(message="Choose")


def stored(name: str) -> dict[str, Any] | None:
    """Return the stored estimate of an image; None if it has none."""
    entries = bpy.data.images[name].get(KEY)
    return None if entries is None else entries.to_dict()


def state() -> dict[str, Any]:
    """Return what a run could change: images with their color spaces and estimates, groups, nodes, links, the film."""
    trees = [*bpy.data.node_groups, *(s.node_tree for s in bpy.data.scenes if getattr(s, "node_tree", None))]
    return {
        "images": {i.name: [i.colorspace_settings.name, i.source, KEY in i] for i in bpy.data.images},
        "film": bpy.context.scene.render.film_transparent,
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
