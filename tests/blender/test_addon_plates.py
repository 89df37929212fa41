"""Which image or clip is meant, and which are refused, with what to do instead."""

from pathlib import Path

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import apply, bpy, drawn_in, estimate, group_node, load, load_sequence, operators, paint, plates


def test_the_node_group_of_a_plate_stands_for_the_plate(image, tree, in_editor):
    def active(node):
        tree.nodes.active = node
        with in_editor("NODE_EDITOR") as space:
            space.node_tree = tree
            return plates.active_datablock(bpy.context)

    estimate(image, "NODES")
    group = group_node()
    (source,) = (node for node in tree.nodes if node.type == "IMAGE")
    assert active(source) == image
    assert active(group) == image
    first, second = tree.nodes.new("NodeReroute"), tree.nodes.new("NodeReroute")
    tree.links.new(source.outputs["Image"], first.inputs[0])
    tree.links.new(first.outputs[0], second.inputs[0])
    tree.links.new(second.outputs[0], group.inputs["Image"])
    assert active(group) == image
    tree.links.remove(group.inputs["Image"].links[0])
    assert active(group) is None


def test_errors_name_a_packed_plate_and_not_the_temporary_file(addon, tmp_path, codes):
    image = load(write_image(tmp_path / "small.png", codes[:30, :40]))
    image.pack()
    with pytest.raises(RuntimeError, match=r"Error: small\.png: "):
        bpy.ops.crf.estimate_response(image=image.name)


def test_a_picture_of_two_eyes_is_refused(addon, tmp_path, codes):
    """Baked, it would be one picture of double width."""
    image = load(write_image(tmp_path / "eyes.png", codes))
    image.use_multiview, image.views_format = True, "STEREO_3D"
    assert "untick Use Multi-View" in plates.obstacle(image)
    with pytest.raises(RuntimeError, match="two eyes"):
        bpy.ops.crf.estimate_response(image=image.name)


def test_frames_taken_for_udim_tiles_become_a_sequence_as_the_message_says(addon, tmp_path, codes, in_editor):
    from blender_addon.work.frame_files import frames_of

    names = [write_image(tmp_path / f"shot.{n}.png", codes.repeat(8, 0)).name for n in range(1001, 1006)]
    files = [{"name": name} for name in names]
    first = str(tmp_path / names[0])
    bpy.ops.image.open(filepath=first, directory=str(tmp_path), files=files, use_udim_detecting=True)
    (image,) = (image for image in bpy.data.images if image.source == "TILED")
    assert "set Source to Image Sequence" in plates.obstacle(image)
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        assert ("crf.read_as_sequence", "SEQUENCE") in operators(drawn_in(image, in_editor))
        assert bpy.ops.crf.read_as_sequence() == {"FINISHED"}
        assert not bpy.ops.crf.read_as_sequence.poll()
        assert space.zoom_percentage < 100  # as it fits
        bpy.context.scene.frame_set(1)
        assert Path(image.filepath_from_user(image_user=space.image_user)).name == "shot.1001.png"
    assert (image.source, image.name) == ("SEQUENCE", "shot.1001.png")
    assert plates.obstacle(image) == ""
    assert frames_of(plates.plate_of(image)).numbers == (1001, 1002, 1003, 1004, 1005)


@pytest.mark.parametrize("kind", ["BLANK", "UV_GRID", "COLOR_GRID"])
def test_what_blender_generates_is_refused_until_it_is_painted(addon, codes, kind):
    image = bpy.data.images.new("made", 256, 256)
    image.generated_type = kind
    with pytest.raises(RuntimeError, match="Blank images and test grids have no camera response"):
        bpy.ops.crf.estimate_response(image=image.name)
    paint(image, codes / 255)
    estimate(image, "NODES")


def test_a_packed_image_that_blender_generates_is_not_taken_from_its_packed_file(addon, tmp_path, codes):
    """Blender shows a test grid, until Source is set back."""
    image = load(write_image(tmp_path / "plate.png", codes))
    image.pack()
    estimate(image)
    image.source = "GENERATED"
    for operator in (bpy.ops.crf.estimate_response, bpy.ops.crf.apply_response):
        with pytest.raises(RuntimeError, match="not its packed file: set Source to Single Image"):
            operator(image=image.name, apply="BAKE", folder=str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()
    image.source = "FILE"
    apply(image, "BAKE", folder=str(tmp_path / "out"))


def test_what_is_painted_over_a_packed_image_counts_where_blender_shows_it(addon, tmp_path, codes):
    image = load(write_image(tmp_path / "plate.png", codes))
    image.pack()
    image.source = "GENERATED"
    image.generated_width = image.generated_height = 256
    paint(image, codes[::-1] / 255)
    np.testing.assert_array_equal(plates.plate_of(image).content, codes[::-1])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("shot.0001.png", r"shot\.####\.png: frames that exist: none"),
        ("still.png", r"still\.png: does not exist; .*; find it with File, External Data\s*$"),
    ],
)
def test_frames_that_are_gone_are_told_in_the_words_of_blender(addon, tmp_path, codes, name, words):
    """Without a placeholder such as %04d, which the command has; a still is a sequence as a movie clip."""
    frame = write_image(tmp_path / name, codes)
    clip = load(frame, "clip")
    frame.unlink()
    assert clip.source == "SEQUENCE"
    with pytest.raises(RuntimeError, match=words):
        bpy.ops.crf.estimate_response(clip=clip.name)


def test_frames_that_are_no_sequence_are_told(addon, tmp_path, codes):
    for number in ("0001", "20260101"):
        write_image(tmp_path / f"IMG_{number}.png", codes)
    image = load_sequence(tmp_path / "IMG_0001.png")
    with pytest.raises(RuntimeError, match=r"IMG_####\.png: .* too far apart; .*; move those away"):
        bpy.ops.crf.estimate_response(image=image.name)
