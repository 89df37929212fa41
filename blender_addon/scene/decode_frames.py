# SPDX-License-Identifier: GPL-3.0-or-later
"""A script for another Blender, which `work.decoding` starts: write frames of movies as PNG files.

Every line of the standard input is a request in JSON, with `file`, `frame` and `target`. The pixels are not colour
managed: the image is Non-Color and the view is Raw, so the PNG file holds the decoder's code values, of 8 bits, or of
16 where Blender decodes to floats. The script ends with an error at the first frame that cannot be decoded.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy


def main() -> None:
    """Answer requests until the standard input ends."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    nodes = _add_nodes(scene)
    _set_output(scene)
    for line in sys.stdin:
        request = json.loads(line)
        problem = _decode(scene, nodes, request["file"], request["frame"], Path(request["target"]))
        if problem:
            sys.stderr.write(f"{problem}\n")
            sys.exit(1)


def _add_nodes(scene: bpy.types.Scene) -> tuple[bpy.types.Node, bpy.types.Node]:
    """Return the node of the image that the scene renders, and a node behind it that multiplies by alpha."""
    if bpy.app.version >= (5, 0, 0):
        tree = bpy.data.node_groups.new("Frames", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        scene.compositing_node_group = tree
        output = tree.nodes.new("NodeGroupOutput")
    else:
        scene.use_nodes = True
        tree = scene.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("CompositorNodeComposite")
    node, multiplied = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("CompositorNodePremulKey")
    if bpy.app.version >= (5, 0, 0):
        multiplied.inputs["Type"].default_value = "To Premultiplied"
    else:
        multiplied.mapping = "STRAIGHT_TO_PREMUL"
    tree.links.new(node.outputs["Image"], multiplied.inputs["Image"])
    tree.links.new(multiplied.outputs["Image"], output.inputs["Image"])
    return node, multiplied


def _set_output(scene: bpy.types.Scene) -> None:
    """Let the scene write PNG files without colour management, dither and metadata."""
    render = scene.render
    render.resolution_percentage = 100
    render.use_sequencer = False
    render.dither_intensity = 0
    render.compositor_device, render.compositor_precision = "CPU", "FULL"
    scene.view_settings.view_transform = "Raw"
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "PNG"
    render.image_settings.compression = 10  # percent; the file is read once or twice
    for name in (name for name in dir(render) if name.startswith("use_stamp")):
        setattr(render, name, False)


def _decode(
    scene: bpy.types.Scene, nodes: tuple[bpy.types.Node, bpy.types.Node], file: str, frame: int, target: Path
) -> str:
    """Write one frame to a file, which gets its name when it is whole; return why that is impossible, or nothing."""
    node, multiplied = nodes
    try:
        image = bpy.data.images.load(file, check_existing=True)
    except RuntimeError as problem:
        return str(problem).strip()
    image.colorspace_settings.name = "Non-Color"
    image.use_deinterlace = "--deinterlace" in sys.argv
    node.image = image
    multiplied.mute = not image.is_float  # PNG files are divided by alpha, and codes of 8 bits come multiplied by it
    node.frame_duration, node.frame_start, node.frame_offset = max(1, image.frame_duration), 1, 0
    if not all(image.size):
        return "it is damaged, or of an unknown format"
    render = scene.render
    render.resolution_x, render.resolution_y = image.size
    render.image_settings.color_depth = "16" if image.is_float else "8"
    render.image_settings.color_mode = "RGBA" if image.depth in (32, 128) else "RGB"
    scene.frame_set(frame)
    bpy.ops.render.render()
    unfinished = target.with_suffix(".part")
    bpy.data.images["Render Result"].save_render(str(unfinished), scene=scene)
    unfinished.replace(target)
    return ""


if __name__ == "__main__":
    main()
