"""Blender starts with our portable config and linearizes a plate with it, on the CPU compositor."""

import numpy as np
import pytest

from crfnet.configs.files import write_config
from crfnet.configs.portable import portable_config
from crfnet.luts.files import write_lut
from tests.helpers.configs import LUT, SPACE
from tests.helpers.images import write_image

from .helpers import load, scene_tree

#: All 8-bit codes; and floats below 0 and above 1.
CODES = np.repeat(np.arange(256, dtype=np.uint8).reshape(16, 16, 1), 3, axis=2)
FLOATS = np.random.default_rng(0).uniform(-0.1, 1.1, (16, 16, 3)).astype(np.float32)

CODE = """
for image in bpy.data.images:
    if image.filepath:
        image.colorspace_settings.name = "CRF plate01"
spaces = bpy.types.ColorManagedInputColorspaceSettings.bl_rna.properties["name"].enum_items.keys()
assert "AgX Log" not in spaces  # of Blender's own config
bpy.context.scene.view_settings.view_transform = "Standard"
"""


@pytest.mark.parametrize(("name", "samples"), [("codes.png", CODES), ("floats.exr", FLOATS)])
def test_blender_linearizes_a_plate(addon, composited, rendered_anew, tmp_path, tolerance, name, samples):
    write_lut(tmp_path / SPACE.lut_file, LUT)
    write_config(tmp_path / "config.ocio", portable_config([SPACE]), check={SPACE.name: LUT})
    node = scene_tree().nodes.new("CompositorNodeImage")
    node.image = load(write_image(tmp_path / name, samples))
    composited(node.outputs["Image"], size=(16, 16))
    pixels, log = rendered_anew(tmp_path / "config.ocio", CODE)
    assert "color management: error" not in log.lower()
    assert "fallback" not in log.lower()
    expected = LUT.apply(samples / 255 if samples.dtype == np.uint8 else samples)
    assert np.abs(pixels[..., :3] - expected).max() < tolerance.plate
