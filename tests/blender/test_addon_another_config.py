"""Nodes that were made under Blender's own config, in a Blender that was started with an ACES config, and back."""

import numpy as np
import pytest

from .helpers import IS_BLENDER_5, apply, bpy, curve_of, group_node

pytestmark = pytest.mark.usefixtures("estimated")

ACES = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"

SAVE = "bpy.ops.wm.save_as_mainfile(filepath={!r})"


@pytest.mark.parametrize("has_look", [False, True])
def test_they_give_the_same_light(image, composited, rendered_anew, codes, tmp_path, has_look):
    import PyOpenColorIO as OCIO

    apply(image)
    composited(group_node().outputs[0])
    config = OCIO.Config.CreateFromFile(ACES)
    expected = curve_of(image).inverse(codes / 255).astype(np.float32)
    if has_look:
        bpy.ops.crf.add_look(image=image.name)
        composited(group_node("Camera Look").outputs["Code Values"])
        expected = codes / 255
    elif not IS_BLENDER_5:  # later, the file keeps its working space, linear Rec.709
        config.getProcessor("Linear Rec.709 (sRGB)", "ACEScg").getDefaultCPUProcessor().applyRGB(expected)
    back = str(tmp_path / "back.blend")
    pixels, log = rendered_anew(ACES, SAVE.format(back))
    assert np.abs(pixels[..., :3] - expected).max() < 1e-5, log
    bpy.ops.wm.open_mainfile(filepath=back)  # made under ACES, as far as Blender knows
    if has_look:
        assert np.abs(composited(group_node("Look").outputs["Code Values"])[..., :3] - codes / 255).max() < 1e-5
    light = curve_of(bpy.data.images["plate.png"]).inverse(codes / 255)
    assert np.abs(composited(group_node("Response").outputs[0])[..., :3] - light).max() < 1e-5
