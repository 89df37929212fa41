"""Compositor nodes: rendered to EXR, they give what numpy gives."""

import numpy as np
import pytest

from tests.helpers.configs import converted, loaded
from tests.helpers.images import write_image

from .helpers import bpy, group_node, load, load_sequence
from .helpers import estimate as run

#: Largest difference against numpy on 8-bit plates.
CODES = 1e-5


@pytest.mark.parametrize("space", ["ACEScg", "Linear Rec.2020"])
def test_another_working_space(image, composited, plate_file, codes, estimate, set_working_space, space):
    """The EXR, which Blender writes as linear Rec.709 or says otherwise, holds the same light."""
    from blender_addon.scene.color_management import running_config

    run(image, "NODES")
    set_working_space(space)
    written = composited(group_node().outputs[0])[..., :3]
    light = converted(loaded(running_config()), space, "Linear Rec.709", written)
    assert np.abs(light - estimate(plate_file).curve.inverse(codes / 255)).max() < 5e-6


def test_the_group_goes_between_the_plate_of_the_active_node_and_what_it_was_linked_to(image, tree, in_editor):
    tree.nodes.clear()
    plate, blur = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("CompositorNodeBlur")
    plate.image = image
    tree.links.new(plate.outputs["Image"], blur.inputs["Image"])
    tree.nodes.active = plate
    for exposure in (0, 1):  # the second time it is only brought up to date
        with in_editor("NODE_EDITOR") as space:
            space.node_tree = tree
            assert bpy.ops.crf.estimate_response(apply="NODES", exposure=exposure) == {"FINISHED"}
        group = group_node()
        assert blur.inputs["Image"].links[0].from_node == group
        assert group.inputs["Image"].links[0].from_node == plate
        assert group.inputs["Exposure"].default_value == exposure
        assert len([g for g in bpy.data.node_groups if g.name.startswith("Camera Response plate")]) == 1


def test_a_clip(addon, plate_file, composited, codes, estimate):
    clip = load(plate_file, "clip")
    run(clip, "NODES")
    group = group_node()
    shown = group.inputs["Image"].links[0].from_node.clip
    assert (shown.filepath, shown.colorspace_settings.name) == (clip.filepath, "Non-Color")
    assert clip.colorspace_settings.name == "sRGB"
    expected = estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < CODES


def test_the_frames_of_a_sequence(addon, tmp_path, codes, composited, estimate):
    frames = {number: np.roll(codes, number, axis=0) for number in (7, 8, 10)}
    paths = [write_image(tmp_path / f"shot.{number:04d}.png", pixels) for number, pixels in frames.items()]
    run(load_sequence(paths[0]), "NODES")
    group = group_node()
    curve = estimate(*paths).curve
    for number in (10, 8):
        bpy.context.scene.frame_set(number)
        expected = curve.inverse(frames[number] / 255)
        assert np.abs(composited(group.outputs[0])[..., :3] - expected).max() < CODES
