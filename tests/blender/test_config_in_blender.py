"""Blender starts with our config and linearises a plate with it, on the CPU compositor."""

import importlib.util
import json
import os
import subprocess
import sys

import numpy as np
import pytest

from crfnet.configs.files import write_config
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.images import read_image, write_image

pytestmark = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="needs Blender's bpy module")

SIZE = 16

# Run in a process of its own: Blender reads its config once, at start.
SCRIPT = """
import json, sys
import bpy

def compositor_tree(scene):
    if bpy.app.version >= (5, 0, 0):
        tree = bpy.data.node_groups.new("CRF", "CompositorNodeTree")
        scene.compositing_node_group = tree
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        return tree, tree.nodes.new("NodeGroupOutput")
    scene.use_nodes = True
    scene.node_tree.nodes.clear()
    return scene.node_tree, scene.node_tree.nodes.new("CompositorNodeComposite")

job = json.loads(sys.argv[-1])
scene = bpy.context.scene
render = scene.render
render.resolution_x = render.resolution_y = job["size"]
render.resolution_percentage = 100
render.use_sequencer = False
render.dither_intensity = 0
render.compositor_device = "CPU"
render.compositor_precision = "FULL"
if hasattr(render.image_settings, "media_type"):
    render.image_settings.media_type = "IMAGE"
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth = "32"
render.image_settings.color_mode = "RGB"
tree, output = compositor_tree(scene)
source = tree.nodes.new("CompositorNodeImage")
tree.links.new(source.outputs["Image"], output.inputs["Image"])
for plate, linear in job["plates"]:
    image = bpy.data.images.load(plate)
    image.colorspace_settings.name = job["space"]
    source.image = image
    render.filepath = linear
    bpy.ops.render.render(write_still=True)
spaces = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()
views = []
for view in ("Standard", "Raw", "AgX", "Filmic"):
    try:
        scene.view_settings.view_transform = view
        views.append(view)
    except TypeError:
        pass
print("FOUND " + json.dumps({"spaces": spaces, "views": views, "version": bpy.app.version_string}))
"""


@pytest.fixture(scope="module")
def blender(tmp_path_factory):
    """The plates' code values, and what Blender made of them under our config."""
    folder = tmp_path_factory.mktemp("plate")
    lut = inverse_response_lut(ResponseCurve.gamma(2.2), length=5101, domain=(-0.125, 1.125))
    write_lut(folder / "plate01.spi1d", lut)
    space = PlateColorSpace("CRF plate01", "plate01.spi1d", aliases=("crf_plate01",))
    write_config(folder / "config.ocio", portable_config([space]), check={"CRF plate01": lut})

    codes = np.repeat(np.arange(256, dtype=np.uint8).reshape(SIZE, SIZE, 1), 3, axis=2)
    floats = np.random.default_rng(0).uniform(-0.1, 1.1, (SIZE, SIZE, 3)).astype(np.float32)
    write_image(folder / "codes.png", codes)
    write_image(folder / "floats.exr", floats)

    plates = [[str(folder / name), str(folder / f"linear_{name[:-4]}.exr")] for name in ("codes.png", "floats.exr")]
    job = json.dumps({"size": SIZE, "space": space.name, "plates": plates})
    environment = {**os.environ, "OCIO": str(folder / "config.ocio"), "BLENDER_USER_RESOURCES": str(folder / "user")}
    environment.pop("BLENDER_OCIO", None)
    command = [sys.executable, "-c", SCRIPT, job]
    run = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    found = next(line for line in run.stdout.splitlines() if line.startswith("FOUND "))
    linear = {name: read_image(path) for (_, path), name in zip(plates, ("codes", "floats"), strict=True)}
    log = run.stdout + run.stderr
    return {"lut": lut, "codes": codes / 255, "floats": floats, "linear": linear, "log": log} | json.loads(found[6:])


def test_the_color_space_is_in_blenders_list(blender):
    assert "CRF plate01" in blender["spaces"]


def test_blender_did_not_fall_back_to_its_own_config(blender):
    assert "AgX Log" not in blender["spaces"]
    assert blender["views"] == ["Standard", "Raw"]
    assert "color management: error" not in blender["log"].lower()
    assert "fallback" not in blender["log"].lower()


def test_blender_linearizes_all_codes_of_an_8_bit_plate(blender, tolerance):
    expected = blender["lut"].apply(blender["codes"])
    assert np.abs(blender["linear"]["codes"] - expected).max() < tolerance.plate


def test_blender_linearizes_a_float_plate_with_super_whites(blender, tolerance):
    expected = blender["lut"].apply(blender["floats"])
    assert expected.max() > 1.1
    assert np.abs(blender["linear"]["floats"] - expected).max() < tolerance.plate
