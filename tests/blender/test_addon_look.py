"""The node group "Camera Look": after the linearizing group, it gives the plate again."""

import numpy as np
import pytest

from crfnet.luts.lut1d import inverse_response_lut
from tests.blender.conftest import rendered
from tests.helpers.images import read_image, write_image

from .helpers import apply, bpy, curve_of, drawn_in, estimate, group_node, load, output, scene_tree, words_in

pytestmark = pytest.mark.usefixtures("estimated")

#: Largest difference from the code values of the plate, white = 1.
ROUND_TRIP = 1e-5


@pytest.fixture
def look(addon):
    """Linearize a file in the compositor, and add its look behind it; returns the image and the node of the look."""

    def run(path, **choices):
        image = load(path)
        estimate(image, "NODES", **choices)
        for target in (output(), next(node for node in scene_tree().nodes if node.type == "VIEWER")):
            scene_tree().links.new(group_node().outputs[0], target.inputs[0])
        assert bpy.ops.crf.add_look(image=image.name) == {"FINISHED"}
        return image, group_node("Camera Look")

    return run


def save(path, size=(256, 256)):
    """Save the output of the compositor as an 8-bit PNG file, and read the file."""
    scene = bpy.context.scene
    rendered(scene, path.with_suffix(".exr"), size)
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_depth, scene.render.image_settings.color_mode = "8", "RGBA"
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return np.round(read_image(path) * 255)


@pytest.mark.parametrize("choices", [{}, {"exposure": -1.5}, {"exposure": 2, "anchor": "GRAY"}])
def test_it_undoes_the_linearizing_group(look, composited, plate_file, codes, choices):
    _, node = look(plate_file, **choices)
    assert np.abs(composited(node.outputs["Code Values"])[..., :3] - codes / 255).max() < ROUND_TRIP


def test_it_undoes_a_bake_at_16_bits(look, composited, codes, tmp_path):
    """The look is exact; between its entries the LUT is linear and the inverse response is not, by a code or so."""
    samples = codes.astype(np.uint16) * 256 + np.random.default_rng(0).integers(0, 256, codes.shape, np.uint16)
    image, node = look(write_image(tmp_path / "deep.png", samples))
    curve = curve_of(image)
    light = inverse_response_lut(curve).apply(samples / 65535).astype(np.float32)
    baked = scene_tree().nodes.new("CompositorNodeImage")
    baked.image = load(write_image(tmp_path / "light.exr", light))
    scene_tree().links.new(baked.outputs[0], node.inputs["Image"])
    expected = curve.forward(light)
    assert np.abs(composited(node.outputs["Code Values"])[..., :3] - expected).max() < ROUND_TRIP
    assert np.abs(expected - samples / 65535).max() < 2 / 65535


def test_it_undoes_it_in_another_working_space(look, plate_file, codes, tmp_path, set_working_space):
    set_working_space("ACEScg")
    look(plate_file)
    assert np.abs(save(tmp_path / "saved.png")[..., :3] - codes).max() <= 1


def test_saved_through_standard_it_is_the_plate_and_its_code_values_are_through_raw(look, plate_file, codes, tmp_path):
    assert bpy.context.scene.view_settings.view_transform == "AgX"
    _, node = look(plate_file, exposure=1)
    assert np.array_equal(save(tmp_path / "saved.png")[..., :3], codes)
    scene_tree().links.new(node.outputs["Code Values"], output().inputs[0])
    bpy.context.scene.view_settings.view_transform = "Raw"
    assert np.array_equal(save(tmp_path / "saved.png")[..., :3], codes)


def test_light_beyond_the_camera_clips(look, composited, plate_file):
    _, node = look(plate_file)
    scene_tree().links.remove(node.inputs["Image"].links[0])
    light = [-1, 0.5, 16, 1]
    source = scene_tree().nodes.new("CompositorNodeRGB")
    source.outputs[0].default_value = light
    plate = next(other for other in scene_tree().nodes if other.type == "IMAGE")
    mix = scene_tree().nodes.new("CompositorNodeAlphaOver")  # gives the color the size of the plate
    images = [socket for socket in mix.inputs if socket.type == "RGBA"]
    scene_tree().links.new(plate.outputs[0], images[0])
    scene_tree().links.new(source.outputs[0], images[1])
    scene_tree().links.new(mix.outputs[0], node.inputs["Image"])
    red, green, blue = composited(node.outputs["Code Values"])[128, 128, :3]
    assert (red, blue) == pytest.approx((0, 1), abs=1e-6)
    assert 0 < green < 1


def test_it_stands_before_the_output_once_and_the_panel_says_so(look, plate_file, in_editor):
    image, node = look(plate_file)
    assert "The output has the Camera Look: it is not linear." in words_in(image, in_editor)
    assert ("prop", node, "mute", "Mute Camera Look") in drawn_in(image, in_editor)
    node.mute = True
    assert "Camera Look:" not in words_in(image, in_editor)
    ends = {link.to_node.type for link in node.outputs["Image"].links}
    assert ends == {"VIEWER", output().type}
    assert node.inputs["Image"].links[0].from_node == group_node()
    group_node().inputs["Exposure"].default_value = 0.75
    bpy.ops.crf.add_look(image=image.name)
    assert group_node("Camera Look") == node
    assert not node.mute
    assert node.inputs["Exposure"].default_value == 0.75
    assert node.inputs["Image"].links[0].from_node == group_node()


def test_another_plates_look_takes_its_place(look, plate_file, tmp_path, codes):
    _, node = look(plate_file)
    other = load(write_image(tmp_path / "other.png", codes))
    estimate(other)
    bpy.ops.crf.add_look(image=other.name)
    assert output().inputs[0].links[0].from_node == node
    assert node.node_tree["camera_response_look_of"] == other


def test_it_follows_a_response_that_is_applied_again(look, composited, plate_file, codes):
    image, node = look(plate_file)
    apply(image, exposure=-2)
    assert node.inputs["Exposure"].default_value == -2
    assert np.abs(composited(node.outputs["Code Values"])[..., :3] - codes / 255).max() < ROUND_TRIP


def test_the_file_of_the_plate_need_not_be_there(image, plate_file):
    plate_file.unlink()
    assert bpy.ops.crf.add_look(image=image.name) == {"FINISHED"}
    assert any(group.name.startswith("Camera Look plate") for group in bpy.data.node_groups)


def test_it_says_why_it_cannot_be_added(image, in_editor):
    with in_editor("NODE_EDITOR"), pytest.raises(RuntimeError, match="Estimate the camera response"):
        bpy.ops.crf.add_look()
