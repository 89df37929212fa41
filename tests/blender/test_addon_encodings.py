"""Plates that are logarithmic or linear are warned of, by their colour space or by what their file says."""

import numpy as np
import pytest

from tests.helpers.images import write_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.fixture
def image(addon, plate_file):
    return bpy.data.images.load(str(plate_file))


@pytest.mark.parametrize("color_space", ["Filmic Log", "AgX Log", "Linear Rec.709", "ACEScg"])
def test_log_and_linear_color_spaces_are_warned_of(image, color_space):
    image.colorspace_settings.name = color_space
    with pytest.raises(RuntimeError, match="is logarithmic or linear"):
        bpy.ops.crf.estimate_response(image=image.name)
    assert "camera_response" not in image
    assert bpy.ops.crf.estimate_response(image=image.name, force=True) == {"FINISHED"}


@pytest.mark.parametrize("color_space", ["sRGB", "Non-Color", "Display P3", "Rec.1886", "Rec.2020"])
def test_other_color_spaces_are_not(image, color_space):
    image.colorspace_settings.name = color_space
    assert bpy.ops.crf.estimate_response(image=image.name) == {"FINISHED"}


def test_log_metadata_is_warned_of(addon, tmp_path, codes):
    path = write_image(tmp_path / "scan.dpx", codes, dpx__Transfer="Logarithmic")
    image = bpy.data.images.load(str(path))
    with pytest.raises(RuntimeError, match=r"calls itself (KodakLog|Logarithmic)"):
        bpy.ops.crf.estimate_response(image=image.name)


def test_a_dpx_that_is_neither(addon, tmp_path, codes, estimate):
    """Blender takes every DPX for linear; its header says otherwise."""
    from blender_addon.scene.stored_estimate import restored

    path = write_image(tmp_path / "video.dpx", codes)
    image = bpy.data.images.load(str(path))
    assert bpy.ops.crf.estimate_response(image=image.name) == {"FINISHED"}
    expected = estimate(path)
    assert restored(image).weights.tolist() == expected.weights.tolist()


def test_linear_files_are_refused(addon, tmp_path):
    path = write_image(tmp_path / "render.exr", np.ones((256, 256, 3), np.float32))
    image = bpy.data.images.load(str(path))
    with pytest.raises(RuntimeError, match="linear"):
        bpy.ops.crf.estimate_response(image=image.name)
