"""The ready comp: the render over the linear plate, at the output and in a viewer, after two clicks."""

import shutil

import numpy as np
import pytest

from tests.blender.conftest import rendered

from .helpers import apply, bpy, curve_of, drawn_in, group_node, groups, labels, load, operators, output, scene_tree

pytestmark = pytest.mark.usefixtures("estimated")


def over():
    """The node before the output or the Camera Look, with the nodes that lead to its background and its foreground."""
    node = output().inputs[0].links[0].from_node
    node = node.inputs["Image"].links[0].from_node if node.type == "GROUP" else node
    assert node.type == "ALPHAOVER"
    return node, *(socket.links[0].from_node for socket in node.inputs if socket.type == "RGBA")


def test_the_render_stands_over_the_linear_plate(image, codes, tmp_path):
    """It shows a gray cube before the camera, in the middle of the picture."""
    scene = bpy.context.scene
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.camera_add(location=(0, 0, 8))
    scene.camera, scene.world = bpy.context.object, bpy.data.worlds.new("gray")
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    assert image.camera_response_settings.compose
    apply(image)
    assert scene.render.film_transparent
    assert not image.camera_response_settings.compose  # there is a comp now
    (viewer,) = (node for node in scene_tree().nodes if node.type == "VIEWER")
    assert viewer.inputs["Image"].links[0].from_node == over()[0] == output().inputs[0].links[0].from_node
    assert over()[0].location_absolute.y == output().location_absolute.y  # the render's link passes behind no node
    comp = rendered(scene, tmp_path / "comp.exr", (256, 256), has_render=True)
    scene_tree().links.new(over()[2].outputs[0], output().inputs[0])
    render = rendered(scene, tmp_path / "render.exr", (256, 256), has_render=True)
    is_cube, is_plate = render[..., 3] == 1, ~render.any(axis=2)
    assert is_cube[128, 128]
    assert is_plate[0, 0]
    assert np.abs(comp - render)[is_cube].max() < 1e-6
    light = curve_of(image).inverse(codes / 255)
    assert np.abs(comp[..., :3] - light)[is_plate].max() < 1e-5


def test_a_plate_of_another_shape_fills_the_frame(image, tmp_path):
    apply(image)
    pixels = rendered(bpy.context.scene, tmp_path / "wide.exr", (128, 64))
    assert pixels.shape[:2] == (64, 128)
    assert (pixels[..., 3] == 1).all()
    assert pixels.min() < 0.1  # it is not hidden where there is no render


def place_of(image, in_editor):
    """The panel's words on where the applied plate is seen."""
    words = " ".join(labels(drawn_in(image, in_editor)))
    return words.partition("Applied with these settings. ")[2].partition("AgX")[0].strip()


def test_the_panel_says_where_an_applied_plate_is_seen(image, tree, plate_file, tmp_path, in_editor):
    apply(image)
    assert place_of(image, in_editor) == "It is in the compositor: F12 renders it."
    other = load(shutil.copy(plate_file, tmp_path / "other.png"))
    bpy.ops.crf.estimate_response(image=other.name, apply="NODES")  # the comp has its plate
    assert place_of(other, in_editor).startswith("A Viewer in the compositor shows it; the render does not.")
    (viewer,) = (link for link in tree.links if link.to_node.type == "VIEWER" and link.from_node in groups(tree))
    tree.links.remove(viewer)
    assert place_of(other, in_editor) == "Its node group in the compositor leads nowhere: link it on."
    if bpy.app.version >= (5, 0, 0):
        bpy.context.scene.compositing_node_group = None
        assert "the render does not" in place_of(image, in_editor)


@pytest.mark.parametrize("choices", [{}, {"compose": True}])
def test_nodes_of_the_artist_are_left_alone_or_on_demand_stay_in_front(image, tree, choices):
    layers, blur = (tree.nodes.new(f"CompositorNode{kind}") for kind in ("RLayers", "Blur"))
    tree.links.new(layers.outputs["Image"], blur.inputs["Image"])
    tree.links.new(blur.outputs["Image"], output().inputs[0])
    bpy.ops.crf.add_look(image=image.name)
    assert not image.camera_response_settings.compose
    apply(image, **choices)
    assert bpy.context.scene.render.film_transparent == bool(choices)
    assert output().inputs[0].links[0].from_node == group_node("Camera Look")
    if choices:
        assert over()[1].inputs["Image"].links[0].from_node == group_node()
        assert over()[2] == blur
    else:
        assert group_node("Camera Look").inputs["Image"].links[0].from_node == blur


def test_a_node_of_the_plate_that_leads_nowhere_becomes_part_of_it(image, tree):
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    apply(image)
    assert over()[1].inputs["Image"].links[0].from_node == group_node()
    assert group_node().inputs["Image"].links[0].from_node == node
    apply(image)
    assert len(groups(tree)) == 1


def test_a_view_that_darkens_highlights_is_named_and_one_click_sets_standard(image, in_editor):
    view = bpy.context.scene.view_settings
    view.view_transform, view.exposure, view.gamma = "AgX", 1, 2
    buttons = {("crf.standard_view", "Standard View"), ("crf.add_look", "Match the Photograph")}
    assert not buttons & set(operators(drawn_in(image, in_editor)))  # nothing is linear yet
    apply(image)
    drawn = drawn_in(image, in_editor)
    assert "AgX darkens the highlights of the plate." in " ".join(labels(drawn))
    assert buttons <= set(operators(drawn))
    assert drawn[drawn.index(("label", "AgX darkens the", "INFO")) - 4][0] == "box"  # apart from offers of cameras
    assert bpy.ops.crf.standard_view() == {"FINISHED"}
    assert (view.view_transform, view.look, view.exposure, view.gamma) == ("Standard", "None", 0, 1)
    assert not buttons & set(operators(drawn_in(image, in_editor)))


def test_the_exposure_of_the_panel_moves_the_nodes_at_once(image):
    settings = image.camera_response_settings
    settings.exposure = 1
    apply(image, anchor="GRAY")
    bpy.ops.crf.add_look(image=image.name)
    nodes = [group_node("Camera Response"), group_node("Camera Look")]
    before = nodes[0].inputs["Exposure"].default_value
    settings.exposure = 0.25
    assert [node.inputs["Exposure"].default_value for node in nodes] == pytest.approx([before - 0.75] * 2)
    apply(image, anchor="GRAY")  # gives the same
    assert nodes[0].inputs["Exposure"].default_value == pytest.approx(before - 0.75)
