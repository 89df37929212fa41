"""Nodes that were made under Blender's own config, in a Blender that was started with an ACES config."""

import os
import subprocess
import sys

import numpy as np
import pytest

from tests.helpers.images import read_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

ACES = "cg-config-v1.0.0_aces-v1.3_ocio-v2.1"

# Run in a process of its own: Blender reads its config once, at start.
SCRIPT = """
import sys
import bpy
import addon_utils
assert addon_utils.enable("blender_addon", default_set=True)
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
"""


@pytest.mark.parametrize("has_look", [False, True])
def test_they_give_the_same_light(image, composited, codes, tmp_path, root, has_look):
    import PyOpenColorIO as OCIO

    from blender_addon.scene.compositor import compositor_tree
    from blender_addon.scene.stored_estimate import restored

    bpy.ops.crf.apply_response(image=image.name, apply="NODES")
    tree = compositor_tree(bpy.context.scene)
    (group,) = (node for node in tree.nodes if node.type == "GROUP")
    composited(group.outputs[0])
    config = OCIO.Config.CreateFromBuiltinConfig(ACES)
    expected = restored(image).curve.inverse(codes / 255).astype(np.float32)
    if has_look:
        bpy.ops.crf.add_look(image=image.name)
        look = next(node for node in tree.nodes if node.type == "GROUP" and node != group)
        composited(look.outputs["Code Values"])
        expected = codes / 255
    else:
        config.getProcessor("Linear Rec.709 (sRGB)", "ACEScg").getDefaultCPUProcessor().applyRGB(expected)
    (tmp_path / "aces.ocio").write_text(config.serialize())
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    command = [sys.executable, "-c", SCRIPT, str(tmp_path / "shot.blend"), str(tmp_path / "aces.exr")]
    environment = {**os.environ, "PYTHONPATH": str(root), "OCIO": str(tmp_path / "aces.ocio")}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert np.abs(read_image(tmp_path / "aces.exr")[..., :3] - expected).max() < 1e-5, done.stdout + done.stderr
