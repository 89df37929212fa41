"""Nodes that were made under Blender's own config, in a Blender that was started with an ACES config."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

pytestmark = pytest.mark.usefixtures("estimated")

ACES = "cg-config-v1.0.0_aces-v1.3_ocio-v2.1"


@pytest.mark.parametrize("has_look", [False, True])
def test_they_give_the_same_light(image, composited, rendered_anew, codes, tmp_path, has_look):
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
    elif bpy.app.version < (5, 0, 0):  # later, the file keeps its working space, linear Rec.709
        config.getProcessor("Linear Rec.709 (sRGB)", "ACEScg").getDefaultCPUProcessor().applyRGB(expected)
    (tmp_path / "aces.ocio").write_text(config.serialize())
    pixels, log = rendered_anew(tmp_path / "aces.ocio")
    assert np.abs(pixels[..., :3] - expected).max() < 1e-5, log
