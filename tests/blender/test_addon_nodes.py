"""Compositor nodes: rendered to EXR, they give what numpy gives."""

import numpy as np
import pytest

from tests.helpers.images import write_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

IS_BLENDER_5 = bpy.app.version >= (5, 0, 0)

#: Largest difference against numpy on 8-bit plates.
CODES = 1e-5


@pytest.fixture
def load(addon):
    """Load a file and estimate; returns the image and its group node."""

    def run(path, **choices):
        image = bpy.data.images.load(str(path))
        assert bpy.ops.crf.estimate_response(image=image.name, apply="NODES", **choices) == {"FINISHED"}
        return image, next(node for node in scene_tree().nodes if node.type == "GROUP")

    return run


def scene_tree():
    scene = bpy.context.scene
    return scene.compositing_node_group if IS_BLENDER_5 else scene.node_tree


def test_every_8_bit_code(load, composited, plate_file, codes, estimate):
    _, group = load(plate_file)
    expected = estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < CODES


def test_a_16_bit_plate_is_linear_between_8_bit_codes(load, composited, tmp_path, estimate):
    samples = np.random.default_rng(0).integers(0, 65536, (256, 256, 3)).astype(np.uint16)
    path = write_image(tmp_path / "deep.png", samples)
    _, group = load(path)
    eight_bits = np.arange(256) / 255
    expected = np.interp(samples / 65535, eight_bits, estimate(path).curve.inverse(eight_bits))
    assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < CODES


def test_exposure_is_a_socket_in_stops(load, composited, plate_file, codes, estimate):
    _, group = load(plate_file, exposure=1.5)
    assert group.inputs["Exposure"].default_value == 1.5
    expected = estimate(plate_file).curve.inverse(codes / 255) * 2**1.5
    assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < 3 * CODES


@pytest.mark.skipif(not IS_BLENDER_5, reason="the working space is the config's before Blender 5.0")
@pytest.mark.parametrize("space", ["ACEScg", "Linear Rec.2020"])
def test_another_working_space(load, composited, plate_file, codes, estimate, space):
    """The EXR, which Blender writes as linear Rec.709 or says otherwise, holds the same light."""
    import PyOpenColorIO as OCIO

    from blender_addon.scene.color_management import running_config

    _, group = load(plate_file)
    bpy.ops.wm.set_working_color_space(working_space=space, convert_colors=False)
    try:
        pixels = np.ascontiguousarray(composited(group.outputs[0])[..., :3])
    finally:
        bpy.ops.wm.set_working_color_space(working_space="Linear Rec.709", convert_colors=False)
    config = OCIO.Config.CreateFromFile(running_config())
    config.getProcessor(space, "Linear Rec.709").getDefaultCPUProcessor().applyRGB(pixels)
    expected = estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(pixels - expected).max() < 5e-6


def test_the_group_goes_between_the_plate_and_what_it_was_linked_to(addon, plate_file):
    image = bpy.data.images.load(str(plate_file))
    tree = new_tree()
    plate, blur = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("CompositorNodeBlur")
    plate.image = image
    tree.links.new(plate.outputs["Image"], blur.inputs["Image"])
    for exposure in (0, 1):  # the second time it is only brought up to date
        bpy.ops.crf.estimate_response(image=image.name, apply="NODES", exposure=exposure)
        (group,) = (node for node in tree.nodes if node.type == "GROUP")
        assert blur.inputs["Image"].links[0].from_node == group
        assert group.inputs["Image"].links[0].from_node == plate
        assert group.inputs["Exposure"].default_value == exposure
        assert len([g for g in bpy.data.node_groups if g.name.startswith("Camera Response plate")]) == 1


def test_the_active_node_of_the_compositor(addon, plate_file, in_editor):
    tree = new_tree()
    node = tree.nodes.new("CompositorNodeImage")
    node.image = bpy.data.images.load(str(plate_file))
    tree.nodes.active = node
    with in_editor("NODE_EDITOR") as space:
        space.node_tree = tree
        assert bpy.ops.crf.estimate_response.poll()
        assert bpy.ops.crf.estimate_response(apply="NODES") == {"FINISHED"}
    assert node.outputs["Image"].links[0].to_node.node_tree.name.startswith("Camera Response plate ")


def test_a_clip(addon, plate_file, composited, codes, estimate):
    clip = bpy.data.movieclips.load(str(plate_file))
    assert bpy.ops.crf.estimate_response(clip=clip.name, apply="NODES") == {"FINISHED"}
    group = next(node for node in scene_tree().nodes if node.type == "GROUP")
    shown = group.inputs["Image"].links[0].from_node.clip
    assert (shown.filepath, shown.colorspace_settings.name) == (clip.filepath, "Non-Color")
    assert clip.colorspace_settings.name == "sRGB"
    expected = estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < CODES


def new_tree():
    """Return the scene's empty compositor tree."""
    from blender_addon.scene.compositor import compositor_tree

    tree = compositor_tree(bpy.context.scene)
    tree.nodes.clear()
    return tree


def test_the_frames_of_a_sequence(addon, tmp_path, codes, composited, estimate):
    """A new node shows the file of each frame number on that frame."""
    frames = {number: np.roll(codes, number, axis=0) for number in (7, 8, 10)}
    paths = [write_image(tmp_path / f"shot.{number:04d}.png", pixels) for number, pixels in frames.items()]
    image = bpy.data.images.load(str(paths[0]))
    image.source = "SEQUENCE"
    bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    group = next(node for node in scene_tree().nodes if node.type == "GROUP")
    curve = estimate(*paths).curve
    for number in (10, 8):
        bpy.context.scene.frame_set(number)
        expected = curve.inverse(frames[number] / 255)
        assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < CODES
