"""What no longer fits an estimate is named: another file, nodes that show the earlier one or linearize twice."""

import os

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import apply, bpy, curve_of, estimate, group_node, load, load_sequence, paint, reopen, words_in

pytestmark = pytest.mark.usefixtures("estimated")

CHANGED = "The file has changed since the estimate"
EARLIER = "Its nodes show the earlier file"
UNSAVED = "Its nodes lack the unsaved changes"
GONE = "Its file is not found: find it with File, External Data."
PAINTED = "Its nodes do not follow your painting: apply it again."
TWICE = "Linearized twice"
WITHOUT = "shows code values without the node group"


@pytest.fixture
def lines_of(in_editor):
    """Return which of the warnings the panel draws for an image."""

    def draw(image):
        words = words_in(image, in_editor)
        return [warning for warning in (CHANGED, EARLIER, GONE, UNSAVED, PAINTED, TWICE, WITHOUT) if warning in words]

    return draw


def other_file(folder, codes, name="other.png"):
    return write_image(folder / name, 255 - codes)


class TestAnotherFile:
    def test_nothing_is_told_while_it_is_the_same(self, image, lines_of, tmp_path):
        assert lines_of(image) == []
        apply(image)
        reopen(tmp_path / "shot.blend")
        assert lines_of(bpy.data.images["plate.png"]) == []

    def test_a_copy_of_the_project_is_the_same(self, image, lines_of, plate_file, tmp_path):
        (tmp_path / "moved").mkdir()
        copy = tmp_path / "moved" / plate_file.name
        copy.write_bytes(plate_file.read_bytes())
        time = plate_file.stat().st_mtime + 1.9  # as an archive rounds it
        os.utime(copy, (time, time))
        image.filepath = str(copy)
        assert lines_of(image) == []

    def test_a_new_file_is_told_until_it_is_estimated_and_its_nodes_until_they_are_applied(
        self, image, lines_of, tmp_path, codes, composited
    ):
        apply(image)
        image.filepath = str(other_file(tmp_path, codes))
        apply(image, "EXPORT")  # the estimate is still the earlier file's
        assert lines_of(image) == [CHANGED, EARLIER]
        estimate(image)
        assert lines_of(image) == [EARLIER]
        apply(image)
        assert lines_of(image) == []
        expected = curve_of(image).inverse((255 - codes) / 255)
        assert np.abs(composited(group_node().outputs[0])[..., :3] - expected).max() < 1e-5

    def test_nodes_read_a_file_that_was_written_anew(self, image, plate_file, codes, composited):
        apply(image)
        linear, curve = group_node().outputs[0], curve_of(image)
        assert np.abs(composited(linear)[..., :3] - curve.inverse(codes / 255)).max() < 1e-5
        other_file(plate_file.parent, codes, plate_file.name)
        apply(image)
        assert np.abs(composited(linear)[..., :3] - curve.inverse((255 - codes) / 255)).max() < 1e-5

    def test_a_file_that_is_gone_is_not_to_be_applied(self, image, lines_of, plate_file):
        apply(image)
        plate_file.unlink()
        assert lines_of(image) == [GONE]

    def test_of_a_sequence_a_frame_may_be_missing(self, addon, lines_of, tmp_path, codes):
        frames = [write_image(tmp_path / f"shot.{number:04d}.png", codes) for number in (1, 2, 3)]
        image = load_sequence(frames[0])
        estimate(image, "NODES")
        frames[0].unlink()
        assert lines_of(image) == []
        apply(image)

    def test_packed_images_say_nothing(self, addon, plate_file, lines_of):
        image = load(plate_file)
        image.pack()
        estimate(image, "NODES")
        plate_file.unlink()
        assert lines_of(image) == []

    def test_a_response_from_elsewhere_is_not_that_of_a_file(self, image, lines_of, tmp_path, codes):
        other = load(other_file(tmp_path, codes))
        bpy.ops.crf.copy_response(image=image.name, targets=[{"name": other.name, "is_clip": False, "is_chosen": True}])
        other.filepath = image.filepath
        assert lines_of(other) == [EARLIER]  # of the nodes alone

    def test_a_file_that_is_read_anew_by_the_plate_alone_is_told(self, image, lines_of, plate_file, codes):
        apply(image)
        write_image(plate_file, (255 - codes)[:-10])
        image.reload()
        assert lines_of(image) == [CHANGED, EARLIER]


def test_the_nodes_of_a_packed_plate_survive_the_loss_of_the_file(image, plate_file, composited, tmp_path, lines_of):
    apply(image)
    image.pack()
    assert lines_of(image) == [EARLIER]
    scene = str(tmp_path / "shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=scene)
    assert lines_of(image) == []
    expected = composited(group_node().outputs[0])
    plate_file.unlink()
    bpy.ops.wm.open_mainfile(filepath=scene)
    assert np.abs(composited(group_node().outputs[0]) - expected).max() < 1e-5
    assert expected[..., :3].max() > 0.5


class TestPainted:
    @pytest.mark.parametrize("is_packed", [False, True])
    def test_unsaved_changes_are_told_until_they_are_in_the_nodes(self, image, lines_of, plate_file, is_packed):
        if is_packed:
            image.pack()
        apply(image)
        for given_up_or_kept, warnings in ((image.reload, []), (image.pack, [EARLIER])):
            assert lines_of(image) == []
            image.pixels[0] = 0.5
            assert lines_of(image) == [UNSAVED]
            given_up_or_kept()
            assert lines_of(image) == warnings
            apply(image)

    def test_of_an_image_without_a_file_it_is_always_told(self, addon, codes, lines_of):
        image = bpy.data.images.new("painted", 256, 256)
        paint(image, codes / 255)
        estimate(image)
        assert lines_of(image) == []
        apply(image)
        assert lines_of(image) == [PAINTED]
        image.pack()
        apply(image)
        assert lines_of(image) == []


class TestWithoutTheGroup:
    def test_code_values_that_go_on_as_they_are_are_told(self, image, lines_of, tree, in_editor):
        apply(image)
        group = group_node()
        source = group.inputs["Image"].links[0].from_socket
        targets = [link.to_socket for link in group.outputs[0].links]
        tree.nodes.remove(group)
        assert lines_of(image) == []  # nothing shows them
        for target in targets:
            tree.links.new(source, target)
        assert lines_of(image) == [WITHOUT]
        applied = "Applied with these settings."
        assert applied not in words_in(image, in_editor)
        apply(image)
        assert lines_of(image) == []
        assert applied in words_in(image, in_editor)

    def test_a_muted_group_counts_as_absent_until_it_is_applied(self, image, lines_of):
        apply(image)
        group_node().mute = True
        assert lines_of(image) == [WITHOUT]
        apply(image)
        assert lines_of(image) == []
        assert not group_node().mute


class TestTwice:
    def test_a_group_behind_the_plate_itself_is_told_until_it_is_applied(
        self, image, lines_of, tree, codes, composited
    ):
        apply(image)
        group = group_node().node_tree
        for node in list(tree.nodes):
            if node.type in ("IMAGE", "GROUP"):
                tree.nodes.remove(node)
        source, node = tree.nodes.new("CompositorNodeImage"), tree.nodes.new("CompositorNodeGroup")
        source.image, node.node_tree = image, group
        tree.links.new(source.outputs["Image"], node.inputs["Image"])
        assert lines_of(image) == [TWICE]
        image.colorspace_settings.name = "Non-Color"  # now these are code values
        assert lines_of(image) == []
        image.colorspace_settings.name = "sRGB"
        apply(image)
        assert lines_of(image) == []
        (link,) = source.outputs["Image"].links
        expected = curve_of(image).inverse(codes / 255)
        assert np.abs(composited(link.to_node.outputs[0])[..., :3] - expected).max() < 1e-5

    def test_the_look_behind_the_group_is_no_second_one(self, image, lines_of, tree):
        apply(image)
        bpy.ops.crf.add_look(image=image.name)
        tree.links.new(group_node().outputs[0], group_node("Look").inputs["Image"])
        assert lines_of(image) == []
