"""The plate's node group in materials and worlds: rendered by Cycles, it gives what numpy gives."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.helpers.configs import converted, loaded
from tests.helpers.images import write_image

from .conftest import rendered
from .helpers import IS_BLENDER_5, Panel, apply, bpy, compositor, curve_of, group_node, labels, load, operators
from .test_addon_another_config import ACES


@pytest.fixture
def shader(addon, in_editor, tmp_path):
    """A plane that fills the camera and glows with the colors of a texture: its tree, nodes, and two functions."""
    scene, material = bpy.context.scene, bpy.data.materials.new("plane")
    bpy.ops.object.camera_add()
    scene.camera = bpy.context.object
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 1
    bpy.ops.mesh.primitive_plane_add(size=1, location=(0, 0, -1))
    bpy.context.object.data.materials.append(material)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    texture, glow, end = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "Emission", "OutputMaterial"))
    texture.interpolation, tree.nodes.active = "Closest", glow
    tree.links.new(texture.outputs["Color"], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], end.inputs["Surface"])
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01

    def show(plate, act=lambda: None, tree=tree):
        """Do something in a Shader Editor, and have its panel drawn; returns what is drawn."""
        from blender_addon.ui.panel import ResponsePanel

        texture.image = texture.image or plate
        panel = Panel()
        with in_editor("ShaderNodeTree") as space:
            space.pin, space.node_tree = True, tree
            act()
            assert ResponsePanel.poll(bpy.context)
            ResponsePanel.draw(panel, bpy.context)
        return panel.layout.drawn

    def light():
        return rendered(scene, tmp_path / "light.exr", (256, 256), has_render=True)[..., :3]

    return SimpleNamespace(tree=tree, texture=texture, glow=glow, show=show, light=light)


def response(**choices):
    """Estimate the response of the plate that the editor shows, and apply it as nodes."""
    assert bpy.ops.crf.estimate_response(apply="NODES", **choices) == {"FINISHED"}


def words(drawn):
    return " ".join(labels(drawn))


def group_in(tree):
    (node,) = (node for node in tree.nodes if node.type == "GROUP")
    return node


def test_it_goes_between_the_texture_and_what_follows_and_gives_the_light_of_every_code(shader, image, codes):
    drawn = shader.show(image, response)
    assert ("crf.apply_response", "Apply Again") in operators(drawn)
    assert "Look at the linear plate" not in words(drawn)  # no button shows it here
    node = group_in(shader.tree)
    assert node.inputs["Color"].links[0].from_node == shader.texture
    assert shader.glow.inputs["Color"].links[0].from_node == node
    assert (shader.texture.image.colorspace_settings.name, image.colorspace_settings.name) == ("Non-Color", "sRGB")
    assert compositor.tree_shown_in(bpy.context) is None  # no compositor was made
    image.camera_response_settings.exposure = 1.5
    light, expected = shader.light(), curve_of(image).inverse(codes / 255) * 2**1.5
    assert np.abs(np.log2(light[codes > 7] / expected[codes > 7])).max() < 1e-5
    assert np.abs(light - expected).max() < 1e-5
    group = node.node_tree
    apply(image, exposure=-1)  # in the compositor: the shader is brought up to date
    assert group_in(shader.tree).node_tree == group
    assert node.inputs["Exposure"].default_value == group_node().inputs["Exposure"].default_value == -1
    image.camera_response_settings.apply = "BAKE"
    drawn = shader.show(image, lambda: apply(image, "BAKE"))
    assert 'The linear plate is "plate_linear.exr": choose it in a new node.' in words(drawn).replace(". exr", ".exr")


@pytest.mark.parametrize("alpha_mode", ["STRAIGHT", "PREMUL", "CHANNEL_PACKED"])
def test_16_bits_with_alpha(shader, tmp_path, alpha_mode):
    samples = np.arange(65536, dtype=np.uint16).reshape(256, 256, 1).repeat(4, axis=2)
    samples[..., 3] = 65535 - 128 * np.arange(256)
    is_divided = alpha_mode == "PREMUL"
    if is_divided:
        samples[..., :3] = np.minimum(samples[..., :3], samples[..., 3:])
    plate = load(write_image(tmp_path / "deep.png", samples, oiio__UnassociatedAlpha=1))
    shader.show(plate, lambda: response(device="camera"))  # as gray pictures need
    plate.alpha_mode = alpha_mode
    shader.show(plate, lambda: apply(plate))
    brightness = samples[..., :3] / (samples[..., 3:] if is_divided else 65535)
    light, expected = shader.light(), curve_of(plate).inverse(brightness)
    is_bright = brightness > 7 / 255
    assert np.abs(np.log2(light[is_bright] / expected[is_bright])).max() < 0.001


def test_a_file_made_under_another_config_gives_the_same_light(shader, image, codes, rendered_anew):
    shader.show(image, response)
    shader.light()
    expected = curve_of(image).inverse(codes / 255)
    if not IS_BLENDER_5:  # later, the file keeps its working space, linear Rec.709
        expected = converted(loaded(ACES), "Linear Rec.709 (sRGB)", "ACEScg", expected)
    pixels, log = rendered_anew(ACES)
    assert np.abs(pixels[..., :3] - expected).max() < 1e-5, log


def test_a_working_space_that_was_changed_counts_when_the_plate_is_applied_again(
    shader, image, codes, set_working_space
):
    from blender_addon.scene.color_management import running_config

    shader.show(image, response)
    set_working_space("ACEScg")
    assert "The working space has changed" in words(shader.show(image))
    assert "The working space has changed" not in words(shader.show(image, lambda: apply(image)))
    light = converted(loaded(running_config()), "ACEScg", "Linear Rec.709", shader.light())
    assert np.abs(light - curve_of(image).inverse(codes / 255)).max() < 1e-5


def test_a_group_that_is_muted_or_missing_is_told_and_mended(shader, image):
    shader.show(image, response)
    node = group_in(shader.tree)
    node.mute = True
    assert "shows code values without the node group" in words(shader.show(image))
    assert "without the node group" not in words(shader.show(image, lambda: apply(image)))
    apply(image)  # in the compositor, too
    shader.tree.nodes.remove(node)
    shader.tree.links.new(shader.texture.outputs["Color"], shader.glow.inputs["Color"])
    drawn = shader.show(image)
    assert "Its nodes keep the earlier response" not in words(drawn)
    assert "without the node group" in words(drawn)
    assert ("crf.apply_response", "Apply") in operators(drawn)
    shader.show(image, lambda: apply(image))
    assert shader.glow.inputs["Color"].links[0].from_node == group_in(shader.tree)


def test_the_world_of_a_full_copy_keeps_its_exposure(shader, image):
    window = bpy.context.window_manager.windows[0]
    first = bpy.context.scene.world = bpy.data.worlds.new("world")
    first.use_nodes = True
    first.node_tree.nodes.new("ShaderNodeTexEnvironment").image = image
    shader.show(image, response, tree=first.node_tree)
    with bpy.context.temp_override(window=window):
        bpy.ops.scene.new(type="FULL_COPY")
    image.camera_response_settings.exposure = 2
    nodes = [group_in(world.node_tree) for world in (first, window.scene.world)]
    assert [node.inputs["Exposure"].default_value for node in nodes] == [0, 2]
