"""Nodes that were made under Blender's own config, in a Blender that was started with an ACES config, and back."""

import numpy as np
import pytest

from .helpers import IS_BLENDER_5, apply, bpy, curve_of, group_node

pytestmark = pytest.mark.usefixtures("estimated")

ACES = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"

APPEND = """
with bpy.data.libraries.load({other!r}, link={link}) as (source, here):
    here.node_groups = [name for name in source.node_groups if "Response" in name]
    here.images = [name for name in source.images if "code values" in name]
(convert,) = (node for node in here.node_groups[0].nodes if node.bl_idname.endswith("ConvertColorSpace"))
print("imported:", convert.from_color_space + ",", here.images[0].colorspace_settings.name)
"""

SAVE = "bpy.ops.wm.save_as_mainfile(filepath={!r})"

STANDARD = "bpy.ops.crf.standard_view(); print('view:', bpy.context.scene.view_settings.view_transform)"


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
    pixels, log = rendered_anew(ACES, f"{SAVE.format(back)}; {STANDARD}")
    assert "view: Un-tone-mapped" in log
    assert np.abs(pixels[..., :3] - expected).max() < 1e-5, log
    bpy.ops.wm.open_mainfile(filepath=back)  # made under ACES, as far as Blender knows
    if has_look:
        assert np.abs(composited(group_node("Look").outputs["Code Values"])[..., :3] - codes / 255).max() < 1e-5
    light = curve_of(bpy.data.images["plate.png"]).inverse(codes / 255)
    assert np.abs(composited(group_node("Response").outputs[0])[..., :3] - light).max() < 1e-5


@pytest.mark.parametrize("link", [False, True])
def test_appended_and_linked_nodes_get_the_names_of_the_config(image, composited, rendered_anew, tmp_path, link):
    apply(image)
    composited(group_node().outputs[0])
    other = str(tmp_path / "other.blend")
    bpy.ops.wm.save_as_mainfile(filepath=other, copy=True)
    _, log = rendered_anew(ACES, APPEND.format(other=other, link=link))
    assert "imported: Linear Rec.709 (sRGB), Raw" in log
