"""Plates that are logarithmic or linear are warned of, by their color space or by what their file says."""

import numpy as np
import pytest

from crfnet_core.response.curve import ResponseCurve
from tests.helpers.images import read_image, write_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.mark.parametrize("color_space", ["AgX Log", "Linear Rec.709"])
def test_log_and_linear_color_spaces_are_warned_of(image, color_space):
    image.colorspace_settings.name = color_space
    with pytest.raises(RuntimeError, match="is logarithmic or linear"):
        bpy.ops.crf.estimate_response(image=image.name)
    assert "camera_response" not in image
    assert bpy.ops.crf.estimate_response(image=image.name, force=True) == {"FINISHED"}


def test_a_stored_response_is_not_applied_to_them_either(image):
    """The plate may have got the color space, or the response of another plate, after its estimate."""
    bpy.ops.crf.estimate_response(image=image.name)
    image.colorspace_settings.name = "Linear Rec.709"
    with pytest.raises(RuntimeError, match="is logarithmic or linear, so it has no camera response"):
        bpy.ops.crf.apply_response(image=image.name, apply="NODES")
    assert not any(tree.name.startswith("Camera Response") for tree in bpy.data.node_groups)
    assert bpy.ops.crf.apply_response(image=image.name, apply="NODES", force=True) == {"FINISHED"}


def test_a_dpx_that_is_neither(addon, tmp_path, codes, estimate):
    """Blender takes every DPX for linear; its header says otherwise."""
    from blender_addon.scene.stored_estimate import restored

    path = write_image(tmp_path / "video.dpx", codes)
    image = bpy.data.images.load(str(path))
    assert bpy.ops.crf.estimate_response(image=image.name) == {"FINISHED"}
    expected = estimate(path)
    assert restored(image).weights.tolist() == expected.weights.tolist()


def test_linear_files_are_refused_and_no_choice_is_offered_that_is_no_help(addon, tmp_path):
    path = write_image(tmp_path / "render.exr", np.ones((256, 256, 3), np.float32))
    image = bpy.data.images.load(str(path))
    for force in (False, True):
        with pytest.raises(RuntimeError, match="OpenEXR holds scene-linear values") as problem:
            bpy.ops.crf.estimate_response(image=image.name, force=force)
        assert "Estimate Anyway" not in str(problem.value)


def test_what_is_recognized_is_named_and_applied_at_the_users_word_only(addon, tmp_path, in_editor):
    from tests.blender.test_addon_panel import drawn_in, labels, operators
    from tests.helpers.footage import limited_range_picture

    image = bpy.data.images.load(str(write_image(tmp_path / "limited.png", limited_range_picture())))
    assert bpy.ops.crf.estimate_response(image=image.name, apply="NODES") == {"FINISHED"}
    assert not [tree for tree in bpy.data.node_groups if tree.name.startswith("Camera Response")]
    image.camera_response_settings.apply = "NODES"
    drawn = drawn_in(image, in_editor)
    assert next(entry for entry in drawn if entry[0] == "label") == ("label", "Do not trust: limited range", "ERROR")
    words = " ".join(labels(drawn))
    assert "Expand the range first" in words
    assert ("crf.apply_response", "Apply Anyway") in operators(drawn)
    with pytest.raises(RuntimeError, match="Apply Anyway"):
        bpy.ops.crf.apply_response(image=image.name)
    assert bpy.ops.crf.apply_response(image=image.name, anyway=True, apply="NODES") == {"FINISHED"}


def test_an_exr_plate_is_baked_and_shown_once_it_is_called_encoded(addon, tmp_path, codes, in_editor):
    from crfnet.luts.files import write_lut
    from crfnet.luts.lut1d import inverse_response_lut

    curve = ResponseCurve.gamma(2.2)
    write_lut(tmp_path / "camera.cube", inverse_response_lut(curve))
    path = write_image(tmp_path / "plate.exr", (codes / 255).astype(np.float32))
    image = bpy.data.images.load(str(path))
    lut = {"image": image.name, "filepath": str(tmp_path / "camera.cube")}
    with pytest.raises(RuntimeError, match="choose for it a color space that is not linear"):
        bpy.ops.crf.load_lut(**lut)
    image.colorspace_settings.name = "Non-Color"
    assert bpy.ops.crf.load_lut(**lut) == {"FINISHED"}
    assert bpy.ops.crf.apply_response(image=image.name, apply="BAKE", depth="float") == {"FINISHED"}
    linear = curve.inverse(codes / 255)
    assert np.abs(read_image(tmp_path / "plate_linear.exr") - linear).max() < 1e-5
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        assert bpy.ops.crf.compare(is_after=True) == {"FINISHED"}
        shown = np.array(space.image.pixels[:]).reshape(*codes.shape[:2], 4)[::-1, :, :3]
        assert bpy.ops.crf.compare(is_after=False) == {"FINISHED"}
    assert np.abs(shown - linear).max() < 1e-4  # 16-bit codes are looked up
