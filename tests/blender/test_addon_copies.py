"""The copy of a plate with its code values: which of the two Blender hands out, and which of them can be changed."""

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import IS_BLENDER_5, apply, bpy, curve_of, group_node, load, plates, reopen, scene_tree
from .helpers import estimate as run

pytestmark = pytest.mark.usefixtures("estimated")


def code_values_of(plate):
    return next(image for image in bpy.data.images if image.get("camera_response_code_values_of") == plate)


class TestOpenedAgain:
    """Blender hands out the image that has the file already, the first in the order of names."""

    def test_where_the_code_values_are_shown_the_plate_counts_and_they_are_no_plate(self, image, in_editor):
        apply(image)
        with in_editor("IMAGE_EDITOR") as space:
            space.image = code_values_of(image)
            assert plates.active_datablock(bpy.context) == image
            assert bpy.ops.crf.compare(is_after=True) == {"FINISHED"}
            assert bpy.ops.crf.compare(is_after=False) == {"FINISHED"}
            assert space.image == image
        with pytest.raises(RuntimeError, match="open the photograph itself"):
            bpy.ops.crf.estimate_response(image=code_values_of(image).name, apply="ESTIMATE")

    @pytest.mark.parametrize("letter", ["n", "Z", "ü", "图"])
    def test_the_plate_is_found_and_not_its_code_values_however_long_its_name_is(self, image, plate_file, letter):
        """Blender cuts names at 63 bytes, from version 5 on at 255."""
        for count in (1, 56, 255):
            image.name = letter * count
            apply(image)
            assert bpy.data.images.load(str(plate_file), check_existing=True) == image


def test_a_plate_that_was_linked_and_made_local_gets_a_copy_of_its_own(image, tmp_path):
    """The copy of the other file cannot be changed."""
    apply(image)
    names = [image.name, code_values_of(image).name]
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(tmp_path / "other.blend"), link=True) as (_, linked):
        linked.images = names
    for found in linked.images:
        scene_tree().nodes.new("CompositorNodeImage").image = found
    reopen(tmp_path / "shot.blend")
    plate = bpy.data.images["plate.png"].make_local()
    apply(plate)
    (copy,) = (found for found in bpy.data.images if found.library is None and "code values" in found.name)
    assert copy["camera_response_code_values_of"] == plate


@pytest.mark.skipif(not IS_BLENDER_5, reason="before, nodes pasted into another file lose their image and their group")
def test_nodes_pasted_beside_a_plate_of_the_same_name_keep_picture_and_response(
    addon, in_editor, tmp_path, codes, composited
):
    for folder, camera in (("a", "Canon EOS 6D"), ("b", "NIKON D90 (1)")):
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        (tmp_path / folder).mkdir()
        path = write_image(tmp_path / folder / "IMG_0001.png", codes if folder == "a" else codes[::-1])
        run(load(path), "NODES", camera=camera)
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"{folder}.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    expected = curve_of(bpy.data.images["IMG_0001.png"]).inverse(codes / 255)
    with in_editor("NODE_EDITOR") as space:
        space.node_tree = scene_tree()
        for node in scene_tree().nodes:
            node.select = node.type in ("IMAGE", "GROUP")
        bpy.ops.node.clipboard_copy()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "b.blend"))
    own = group_node()
    with in_editor("NODE_EDITOR") as space:
        space.node_tree = scene_tree()
        bpy.ops.node.clipboard_paste()
    apply(bpy.data.images["IMG_0001.png"], exposure=1)
    (pasted,) = (node for node in scene_tree().nodes if node.type == "GROUP" and node != own)
    assert (own.inputs["Exposure"].default_value, pasted.inputs["Exposure"].default_value) == (1, 0)
    assert np.abs(composited(pasted.outputs[0])[..., :3] - expected).max() < 1e-5
