"""Pictures that Blender rendered are recognized by what Blender writes into the files."""

import importlib.util
import subprocess
import sys

import pytest

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata import file_origin

pytestmark = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="needs Blender's bpy module")

# Run in a process of its own: rendering changes the scene of other tests.
SCRIPT = """
import sys
import bpy
scene = bpy.context.scene
scene.render.engine, scene.cycles.samples = "CYCLES", 1
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 32, 24, 100
if hasattr(scene.render.image_settings, "media_type"):
    scene.render.image_settings.media_type = "IMAGE"
for path in sys.argv[1:]:
    scene.render.image_settings.file_format = "PNG" if path.endswith(".png") else "JPEG"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
"""


def test_a_render_names_blender(tmp_path):
    paths = [tmp_path / "render.png", tmp_path / "render.jpg"]
    subprocess.run([sys.executable, "-c", SCRIPT, *map(str, paths)], check=True, capture_output=True, timeout=300)
    for path in paths:
        origin = file_origin(read_photo(path).metadata)
        assert origin.renderer == "Blender"
        assert origin.words[0] == "rendered by Blender"
