"""The copy of a plate with its code values: which of the two Blender hands out, and which of them can be changed."""

import pytest

from .helpers import apply, bpy, plates, reopen, scene_tree

pytestmark = pytest.mark.usefixtures("estimated")


class TestOpenedAgain:
    """Blender hands out the image that has the file already, the first in the order of names."""

    def test_the_plate_is_found_and_not_its_code_values(self, image, plate_file):
        apply(image)
        assert bpy.data.images.load(str(plate_file), check_existing=True) == image

    def test_an_editor_that_shows_the_code_values_has_the_panel_of_the_plate(self, image, in_editor):
        apply(image)
        with in_editor("IMAGE_EDITOR") as space:
            space.image = bpy.data.images["plate.png code values"]
            assert plates.active_datablock(bpy.context) == image
            assert bpy.ops.crf.compare(is_after=True) == {"FINISHED"}
            assert bpy.ops.crf.compare(is_after=False) == {"FINISHED"}
            assert space.image == image

    def test_the_code_values_are_no_plate_of_their_own(self, image):
        apply(image)
        with pytest.raises(RuntimeError, match="open the photograph itself"):
            bpy.ops.crf.estimate_response(image="plate.png code values", apply="ESTIMATE")

    @pytest.mark.parametrize("letter", ["n", "Z", "ü", "图"])
    def test_the_plate_is_found_however_long_its_name_is(self, image, plate_file, letter):
        """Blender cuts names at 63 bytes, from version 5 on at 255."""
        for count in (56, 255):
            image.name = letter * count
            apply(image)
            assert bpy.data.images.load(str(plate_file), check_existing=True) == image


def test_a_plate_that_was_linked_and_made_local_gets_a_copy_of_its_own(image, tmp_path):
    """The copy of the other file cannot be changed."""
    apply(image)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(tmp_path / "other.blend"), link=True) as (_, linked):
        linked.images = ["plate.png", "plate.png code values"]
    for found in linked.images:
        scene_tree().nodes.new("CompositorNodeImage").image = found
    reopen(tmp_path / "shot.blend")
    plate = bpy.data.images["plate.png"].make_local()
    apply(plate)
    (copy,) = (found for found in bpy.data.images if found.library is None and found.name.endswith("code values"))
    assert copy["camera_response_code_values_of"] == plate
