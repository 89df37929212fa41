"""The alpha setting of an image counts, whatever its file says: in the nodes, in baked files and in the comparison."""

import numpy as np
import pytest

from tests.helpers.images import read_image, write_image

from .helpers import apply, bpy, curve_of, estimate, group_node, linear_shown, load, paint, pixels_of, scene_tree
from .test_addon_movies import CODECS, encode

MODES = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")

#: Curves are linear between their steps; brightnesses that were divided by alpha, and deep ones, lie between them.
BETWEEN = 3e-4


@pytest.fixture
def alpha():
    drawn = np.random.default_rng(1).integers(0, 256, (256, 256, 1)).astype(np.uint8)
    drawn[:8], drawn[8:16] = 0, 255
    return drawn


@pytest.fixture(params=["png of 8 bits", "png of 16 bits", "tif of 8 bits", "tif of 16 bits, tagged premultiplied"])
def image(request, addon, tmp_path, codes, alpha):
    """Codes with alpha, and what the file says of it."""
    kind, _, bits, *_ = request.param.split()
    stored = np.concatenate([codes, alpha], axis=2)
    stored = stored.astype(np.uint16) * 257 if bits == "16" else stored
    return load(
        write_image(tmp_path / f"plate.{kind}", stored, oiio__UnassociatedAlpha=int("tagged" not in request.param))
    )


def expected(image, codes, alpha, mode):
    """Return the linear plate, shape (H, W, 4), by the meaning of Blender's setting."""
    from crfnet.luts.lut1d import inverse_response_lut

    brightness, alpha = codes / 255, alpha / 255
    if mode == "PREMUL":
        brightness = np.divide(brightness, alpha, out=np.zeros_like(brightness), where=alpha > 0).clip(0, 1)
    linear = inverse_response_lut(curve_of(image)).apply(brightness)
    if mode in ("STRAIGHT", "PREMUL"):
        linear = linear * alpha
    return np.concatenate([linear, np.ones_like(alpha) if mode == "NONE" else alpha], axis=2)


@pytest.mark.parametrize("mode", MODES)
def test_nodes_and_baked_files_take_it_alike(image, codes, alpha, mode, composited, tmp_path):
    image.alpha_mode = mode
    estimate(image, "NODES", anyway=True)  # divided by alpha, most samples are white
    should = expected(image, codes, alpha, mode)
    limit = BETWEEN if mode == "PREMUL" or image.is_float else 1e-5
    assert np.abs(composited(group_node().outputs[0]) - should).max() < limit
    apply(image, "BAKE", depth="float", anyway=True)
    baked = read_image(tmp_path / "plate_linear.exr")
    assert np.abs(baked - should[..., : baked.shape[2]]).max() < 1e-6
    node = scene_tree().nodes.new("CompositorNodeImage")
    node.image = bpy.data.images["plate_linear.exr"]
    assert np.abs(composited(node.outputs["Image"]) - should).max() < 1e-6


@pytest.mark.parametrize("mode", MODES)
def test_the_comparison_takes_it_alike(image, codes, alpha, mode, in_editor):
    image.alpha_mode = mode
    estimate(image)
    should = expected(image, codes, alpha, "NONE" if mode == "CHANNEL_PACKED" else mode)
    assert np.abs(linear_shown(image, in_editor) - should).max() < 1e-4


def test_a_plate_that_is_baked_again_has_the_alpha_of_the_new_setting(addon, codes, alpha, tmp_path):
    path = write_image(tmp_path / "plate.png", np.concatenate([codes, alpha], axis=2), oiio__UnassociatedAlpha=1)
    image = load(path)
    estimate(image)
    for mode, baked_mode in (("CHANNEL_PACKED", "CHANNEL_PACKED"), ("STRAIGHT", "PREMUL")):
        image.alpha_mode = mode
        apply(image, "BAKE", depth="float", overwrite=True)
        baked = bpy.data.images["plate_linear.exr"]
        assert baked.alpha_mode == baked_mode
        assert np.abs(pixels_of(baked) - expected(image, codes, alpha, mode)).max() < 1e-6


@pytest.mark.parametrize("kind", ["image", "clip"])
def test_in_movies_it_is_straight(addon, codes, tmp_path, composited, monkeypatch, kind):
    """So Blender takes it whatever the setting, and hands frames of 8 bits on multiplied by it."""
    alpha = np.maximum(codes[..., :1], 1)  # colors without coverage are not in a movie
    frames = [
        write_image(tmp_path / f"{number}.png", np.dstack([codes, alpha]), oiio__UnassociatedAlpha=1)
        for number in (1, 2)
    ]
    monkeypatch.setitem(CODECS, "alpha.mkv", ("MKV", "FFV1", "8"))
    encode(tmp_path / "alpha.mkv", frames, color_mode="RGBA")
    plate = load(tmp_path / "alpha.mkv", kind)
    if kind == "image":
        plate.alpha_mode = "CHANNEL_PACKED"
    estimate(plate, "NODES")
    should = expected(plate, codes, alpha, "STRAIGHT")
    assert np.abs(composited(group_node().outputs[0]) - should).max() < 1e-4


@pytest.mark.parametrize("mode", ["STRAIGHT", "PREMUL"])
def test_what_was_painted_is_not_multiplied_by_alpha_whatever_the_setting(
    addon, codes, alpha, mode, composited, in_editor, tmp_path
):
    """Blender divides by alpha where it reads a file; its compositor takes what is in memory for straight."""
    image = bpy.data.images.new("painted", 256, 256)
    image.alpha_mode = mode
    paint(image, np.concatenate([codes, alpha], axis=2) / 255)
    estimate(image, "NODES")
    should = expected(image, codes, alpha, "STRAIGHT")
    limit = BETWEEN if mode == "PREMUL" or image.is_float else 1e-5
    assert np.abs(composited(group_node().outputs[0]) - should).max() < limit
    apply(image, "BAKE", depth="float", folder=str(tmp_path))
    assert np.abs(read_image(tmp_path / "painted_linear.exr") - should).max() < 1e-6
    assert np.abs(linear_shown(image, in_editor) - should).max() < 1e-4
    as_it_is = scene_tree().nodes.new("CompositorNodeImage")
    as_it_is.image = image
    color = codes[40, 100] / 255
    light = np.where(color > 0.04045, ((color + 0.055) / 1.055) ** 2.4, color / 12.92) * (alpha[40, 100] / 255)
    assert np.abs(composited(as_it_is.outputs["Image"])[40, 100, :3] - light).max() < 0.01  # of 8 bits
