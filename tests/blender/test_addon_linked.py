"""Plates that are linked from another file: nothing is changed on them, because it would not be saved."""

import numpy as np
import pytest

from .helpers import apply, bpy, linear_shown, words_in

pytestmark = pytest.mark.usefixtures("estimated")

WHY = "plate.png is linked from another file: make it local first"


def link(blend):
    """Open an empty file, and link all images of another one; returns the plate."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(str(blend), link=True) as (source, linked):
        linked.images = list(source.images)
    return bpy.data.images["plate.png"]


@pytest.fixture
def linked(image, tmp_path):
    image.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    return link(tmp_path / "other.blend")


def state(plate):
    return plate.camera_response_settings.gray, plate.camera_response_settings.anchor


def test_operators_that_would_change_its_settings_are_refused_and_say_why(linked, in_editor):
    before = state(linked)
    with in_editor("IMAGE_EDITOR") as space:
        space.image = linked
        assert not bpy.ops.crf.pick_gray.poll()
        with pytest.raises(RuntimeError, match=WHY):
            bpy.ops.crf.pick_gray("INVOKE_DEFAULT")
    assert state(linked) == before
    assert WHY in words_in(linked, in_editor)


def test_its_linear_plate_may_be_looked_at(linked, in_editor, codes, estimate, plate_file):
    expected = estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(linear_shown(linked, in_editor)[..., :3] - expected).max() < 1e-6


def test_saving_leaves_the_code_values_of_the_other_file_alone(image, tmp_path):
    """The plate was packed after its nodes had read the file, so its code values are not packed yet."""
    from blender_addon.ui import handlers

    apply(image)
    image.pack()
    bpy.app.handlers.save_pre.remove(handlers.prepare_saving)  # as by a Blender without the add-on
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "other.blend"))
    bpy.app.handlers.save_pre.append(handlers.prepare_saving)
    bpy.context.scene["kept"] = plate = link(tmp_path / "other.blend")
    before = {(found.name, found.library) for found in bpy.data.images}
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    assert {(found.name, found.library) for found in bpy.data.images} == before
    assert plate.library is not None
