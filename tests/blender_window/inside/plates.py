"""Plates: open them, choose how the response is applied, read what was stored, render and compare linear values."""

from __future__ import annotations

from typing import Any

import bpy
import editors
import numpy as np
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

#: Pixels by which a rendered object is larger than its outline.
EDGE = 2

#: The custom property that holds an estimate.
KEY = "camera_response"


def open_image(path: str) -> str:
    """Open a file in the Image Editor; return the name of its image."""
    with editors.context("IMAGE_EDITOR"):
        bpy.ops.image.open("EXEC_DEFAULT", True, filepath=path, relative_path=False)
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


def comp() -> list[str]:
    """Return the kinds of the linked nodes in the scene's compositor."""
    scene = bpy.context.scene
    tree = scene.compositing_node_group if bpy.app.version >= (5, 0, 0) else scene.node_tree
    return sorted(node.type for node in tree.nodes if any(socket.is_linked for socket in (*node.inputs, *node.outputs)))


def render(name: str, path: str) -> str:
    """Render the scene, with all that its compositor does, to a float EXR file of the size of an image."""
    settings, image = bpy.context.scene.render, bpy.data.images[name]
    settings.resolution_x, settings.resolution_y = image.size
    settings.resolution_percentage, settings.dither_intensity, settings.use_sequencer = 100, 0, False
    settings.compositor_device, settings.compositor_precision = "CPU", "FULL"
    settings.engine = "BLENDER_WORKBENCH"  # the fastest without a graphics card
    if hasattr(settings.image_settings, "media_type"):
        settings.image_settings.media_type = "IMAGE"
    settings.image_settings.file_format = "OPEN_EXR"
    settings.image_settings.color_depth, settings.image_settings.color_mode = "32", "RGBA"
    settings.filepath = path
    bpy.ops.render.render(write_still=True)
    return path


def largest_difference(path: str, expected: str, *, beside: str = "") -> float:
    """Return the largest absolute difference of the colors of two EXR files, in linear values, beside an object."""
    found, wanted = _pixels(path)[..., :3], _pixels(expected)[..., :3]
    if found.shape != wanted.shape:
        raise ValueError(f"{path} is {found.shape}, {expected} is {wanted.shape}")
    difference = np.abs(found - wanted)
    if beside:
        difference[_box(bpy.data.objects[beside], *found.shape[:2])] = 0
    return float(difference.max())


def _box(thing: bpy.types.Object, height: int, width: int) -> tuple[slice, ...]:
    """Return the rows and columns of a rendered picture that an object fills, its soft edge among them."""
    scene = bpy.context.scene
    corners = [thing.matrix_world @ Vector(corner) for corner in thing.bound_box]
    places = np.array([world_to_camera_view(scene, scene.camera, corner)[:2] for corner in corners])
    columns, rows = places[:, 0] * width, (1 - places[:, 1]) * height
    return tuple(slice(int(each.min()) - EDGE, int(each.max()) + EDGE + 1) for each in (rows, columns))


def _pixels(path: str) -> Any:
    """Return the pixels of a file, float32, shape (H, W, C)."""
    import OpenImageIO as oiio

    return oiio.ImageBuf(path).get_pixels(oiio.FLOAT)
