"""Plates that are logarithmic or linear are warned of, by their color space or by what their file says."""

import re

import numpy as np
import pytest

from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.footage import limited_range_picture
from tests.helpers.images import read_image, write_image

from .helpers import apply, bpy, drawn_in, estimate, labels, linear_shown, load, operators


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
    apply(image, force=True)


def test_a_dpx_that_is_neither(addon, tmp_path, codes):
    """Blender takes every DPX for linear; its header says otherwise."""
    estimate(load(write_image(tmp_path / "video.dpx", codes)))


def test_linear_files_are_refused_and_no_choice_is_offered_that_is_no_help(addon, tmp_path):
    image = load(write_image(tmp_path / "render.exr", np.ones((256, 256, 3), np.float32)))
    for force in (False, True):
        with pytest.raises(RuntimeError, match="whose values are scene-linear as a rule") as problem:
            bpy.ops.crf.estimate_response(image=image.name, force=force)
        assert "Estimate Anyway" not in str(problem.value)


def test_what_is_recognized_is_named_and_applied_at_the_users_word_only(addon, tmp_path, in_editor):
    image = load(write_image(tmp_path / "limited.png", limited_range_picture()))
    estimate(image)
    image.camera_response_settings.apply = "NODES"
    drawn = drawn_in(image, in_editor)
    before_the_filter = drawn[: drawn.index(("operator", "wm.context_set_string", "Copy the Filter", "COPYDOWN"))]
    cause, remedy = "Probably limited range stored as full:", "If so, expand the range first:"
    assert re.match(f"Do not trust {cause} .* {remedy} .*", " ".join(labels(before_the_filter)))
    assert cause not in " ".join(labels(drawn[len(before_the_filter) :]))  # once
    assert ("set", "value", "scale=in_range=limited:out_range=full") in drawn
    assert ("crf.apply_response", "Apply Anyway") in operators(drawn)
    with pytest.raises(RuntimeError, match="Apply Anyway"):
        bpy.ops.crf.apply_response(image=image.name)
    apply(image, anyway=True)


def test_an_exr_plate_is_baked_and_shown_once_it_is_called_encoded(addon, tmp_path, codes, in_editor):
    curve = ResponseCurve.gamma(2.2)
    write_lut(tmp_path / "camera.cube", inverse_response_lut(curve))
    image = load(write_image(tmp_path / "plate.exr", (codes / 255).astype(np.float32)))
    lut = {"image": image.name, "filepath": str(tmp_path / "camera.cube")}
    with pytest.raises(RuntimeError, match="choose for it a color space that is not linear"):
        bpy.ops.crf.load_lut(**lut)
    image.colorspace_settings.name = "Non-Color"
    assert bpy.ops.crf.load_lut(**lut) == {"FINISHED"}
    apply(image, "BAKE", depth="float")
    linear = curve.inverse(codes / 255)
    assert np.abs(read_image(tmp_path / "plate_linear.exr") - linear).max() < 1e-5
    assert np.abs(linear_shown(image, in_editor)[..., :3] - linear).max() < 1e-4  # 16-bit codes are looked up
