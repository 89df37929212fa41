"""A plate that is tagged with other primaries than Rec.709 is converted, whichever way its response is applied."""

import numpy as np
import pytest

from crfnet_core.colorimetry import DISPLAY_P3, REC709, conversion_matrix
from tests.helpers.color_profiles import matrix_profile, write_tagged
from tests.helpers.configs import converted, loaded
from tests.helpers.images import read_image

from .helpers import apply, bpy, curve_of, estimate, group_node, linear_shown, load


@pytest.fixture
def image(addon, tmp_path, codes):
    """The plate, encoded in Display P3, with its estimate."""
    image = load(write_tagged(tmp_path / "p3.png", codes, matrix_profile(DISPLAY_P3)))
    estimate(image)
    return image


@pytest.fixture
def expected(image, codes):
    """Its light in linear Rec.709, white = 1."""
    return curve_of(image).inverse(codes / 255) @ conversion_matrix(DISPLAY_P3, REC709).T


def test_in_nodes(image, expected, composited):
    apply(image, "NODES")
    assert np.abs(composited(group_node("Response").outputs[0])[..., :3] - expected).max() < 1e-5
    assert expected.min() < -0.1  # colors outside Rec.709 are kept


def test_in_baked_files(image, expected, tmp_path):
    apply(image, "BAKE", depth="float")
    assert np.abs(read_image(tmp_path / "p3_linear.exr")[..., :3] - expected).max() < 1e-6


def test_in_a_config(image, expected, tmp_path, codes):
    apply(image, "EXPORT", folder=str(tmp_path / "config"))
    config = loaded(tmp_path / "config" / "config.ocio")
    linear = "Linear Rec.709" if config.getColorSpace("Linear Rec.709") else "lin_rec709_scene"
    assert np.abs(converted(config, "CRF p3", linear, codes / 255) - expected).max() < 5e-6


def test_in_the_comparison(image, expected, in_editor):
    assert np.abs(linear_shown(image, in_editor)[..., :3] - expected).max() < 1e-6


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
    image = load(plate_file)
    estimate(image, "NODES")
    assert "Rec.709" in image["camera_response"]["primaries"]
    assert len([node for node in group_node("Response").node_tree.nodes if node.type == "MATH"]) < 16


def test_a_new_file_has_its_own_primaries(image, plate_file):
    """The file is read again only where it differs from the estimate."""
    apply(image, "NODES")
    assert "Display P3" in image["camera_response"]["primaries"]
    image.filepath = str(plate_file)
    apply(image, "NODES")
    assert "Rec.709" in image["camera_response"]["primaries"]
