"""A plate that is tagged with other primaries than Rec.709 is converted, whichever way its response is applied."""

import numpy as np
import pytest

from tests.helpers.images import read_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.fixture
def image(addon, tmp_path, codes):
    """The plate, encoded in Display P3, with its estimate."""
    from crfnet_core.colorimetry import DISPLAY_P3
    from tests.helpers.color_profiles import matrix_profile, write_tagged

    image = bpy.data.images.load(str(write_tagged(tmp_path / "p3.png", codes, matrix_profile(DISPLAY_P3))))
    bpy.ops.crf.estimate_response(image=image.name)
    return image


@pytest.fixture
def expected(image, codes):
    """Its light in linear Rec.709, white = 1."""
    from blender_addon.scene import stored_estimate
    from crfnet_core.colorimetry import DISPLAY_P3, REC709, conversion_matrix

    light = stored_estimate.restored(image).curve.inverse(codes / 255)
    return light @ conversion_matrix(DISPLAY_P3, REC709).T


def apply(image, mode, **choices):
    assert bpy.ops.crf.apply_response(image=image.name, apply=mode, **choices) == {"FINISHED"}


def group_node(part):
    from blender_addon.scene.node_links import compositor_trees

    nodes = (node for tree in compositor_trees() for node in tree.nodes if node.type == "GROUP")
    return next(node for node in nodes if part in node.node_tree.name)


def test_in_nodes(image, expected, composited):
    apply(image, "NODES")
    assert np.abs(composited(group_node("Response").outputs[0])[..., :3] - expected).max() < 1e-5
    assert expected.min() < -0.1  # colors outside Rec.709 are kept


def test_in_baked_files(image, expected, tmp_path):
    apply(image, "BAKE", depth="float")
    assert np.abs(read_image(tmp_path / "p3_linear.exr")[..., :3] - expected).max() < 1e-6


def test_in_a_config(image, expected, tmp_path, codes):
    import PyOpenColorIO as OCIO

    apply(image, "EXPORT", folder=str(tmp_path / "config"))
    config = OCIO.Config.CreateFromFile(str(tmp_path / "config" / "config.ocio"))
    linear = "Linear Rec.709" if config.getColorSpace("Linear Rec.709") else "lin_rec709_scene"
    pixels = (codes / 255).astype(np.float32)
    config.getProcessor("CRF p3", linear).getDefaultCPUProcessor().applyRGB(pixels)
    assert np.abs(pixels - expected).max() < 5e-6


def test_in_the_comparison(image, expected, in_editor):
    from blender_addon.ui.image_editor import comparison

    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        assert bpy.ops.crf.compare(is_after=True) == {"FINISHED"}
        pixels = np.empty(256 * 256 * 4, np.float32)
        space.image.pixels.foreach_get(pixels)
        comparison.end_all()
    assert np.abs(pixels.reshape(256, 256, 4)[::-1, :, :3] - expected).max() < 1e-6


def test_the_look_gives_the_code_values_back(image, codes, composited):
    apply(image, "NODES")
    bpy.ops.crf.add_look(image=image.name)
    linear, look = group_node("Response"), group_node("Look")
    look.id_data.links.new(linear.outputs[0], look.inputs["Image"])
    assert np.abs(composited(look.outputs["Code Values"])[..., :3] - codes / 255).max() < 5e-6


def test_a_loaded_response_is_for_the_same_primaries(image, expected, tmp_path, in_editor):
    before = image["camera_response"]["primaries"]
    apply(image, "EXPORT", folder=str(tmp_path / "luts"))
    bpy.ops.crf.load_lut(image=image.name, filepath=str(tmp_path / "luts" / "p3.spi1d"))
    assert image["camera_response"]["primaries"] == before


def test_plates_without_tags_have_no_matrix(addon, plate_file):
    image = bpy.data.images.load(str(plate_file))
    bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    assert "Rec.709" in image["camera_response"]["primaries"]
    assert len([node for node in group_node("Response").node_tree.nodes if node.type == "MATH"]) < 16


def test_a_new_file_has_its_own_primaries(image, plate_file):
    """The file is read again only where it differs from the estimate."""
    apply(image, "NODES")
    assert "Display P3" in image["camera_response"]["primaries"]
    image.filepath = str(plate_file)
    apply(image, "NODES")
    assert "Rec.709" in image["camera_response"]["primaries"]
