"""The alpha setting of an image counts, whatever its file says: in the nodes, in baked files and in the comparison."""

import numpy as np
import pytest

from tests.helpers.images import read_image, write_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

from .test_addon_image_tools import pixels_of, show  # noqa: E402 - after the skip
from .test_addon_movies import CODECS, encode, load, stored_curve  # noqa: E402

MODES = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")

#: The curve is linear between 8-bit codes; brightnesses that were divided by alpha lie between them.
BETWEEN = 3e-4


@pytest.fixture
def alpha():
    """Code values of alpha, shape (256, 256, 1), some of them 0 and some 255."""
    drawn = np.random.default_rng(1).integers(0, 256, (256, 256, 1)).astype(np.uint8)
    drawn[:8], drawn[8:16] = 0, 255
    return drawn


@pytest.fixture(params=["png of 8 bits", "png of 16 bits", "tif of 8 bits", "tif of 16 bits, tagged premultiplied"])
def image(request, addon, tmp_path, codes, alpha):
    """Codes with alpha, and what the file says of it."""
    kind, _, bits, *_ = request.param.split()
    stored = np.concatenate([codes, alpha], axis=2)
    stored = stored.astype(np.uint16) * 257 if bits == "16" else stored
    path = write_image(tmp_path / f"plate.{kind}", stored, oiio__UnassociatedAlpha=int("tagged" not in request.param))
    return bpy.data.images.load(str(path))


def expected(image, codes, alpha, mode):
    """Return the linear plate, shape (H, W, 4), by the meaning of Blender's setting."""
    from crfnet.luts.lut1d import inverse_response_lut

    brightness, alpha = codes / 255, alpha / 255
    if mode == "PREMUL":
        brightness = np.divide(brightness, alpha, out=np.zeros_like(brightness), where=alpha > 0).clip(0, 1)
    linear = inverse_response_lut(stored_curve(image)).apply(brightness)
    if mode in ("STRAIGHT", "PREMUL"):
        linear = linear * alpha
    return np.concatenate([linear, np.ones_like(alpha) if mode == "NONE" else alpha], axis=2)


@pytest.mark.parametrize("mode", MODES)
def test_nodes_and_baked_files_take_it_alike(image, codes, alpha, mode, composited, tmp_path):
    from blender_addon.scene.compositor import compositor_tree

    image.alpha_mode = mode
    bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    tree = compositor_tree(bpy.context.scene)
    (group,) = (node for node in tree.nodes if node.type == "GROUP")
    should = expected(image, codes, alpha, mode)
    assert np.abs(composited(group.outputs[0]) - should).max() < (BETWEEN if mode == "PREMUL" else 1e-5)
    bpy.ops.crf.apply_response(image=image.name, apply="BAKE", depth="float")
    baked = read_image(tmp_path / "plate_linear.exr")
    assert np.abs(baked - should[..., : baked.shape[2]]).max() < 1e-6
    node = tree.nodes.new("CompositorNodeImage")
    node.image = bpy.data.images["plate_linear.exr"]
    assert np.abs(composited(node.outputs["Image"]) - should).max() < 1e-6


def shown_as_linear(image, in_editor):
    """What "Linear" shows of a plate in the Image Editor, which then shows the plate again."""
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        show(after=True)
        found = pixels_of(space.image)
        show(after=False)
    return found


@pytest.mark.parametrize("mode", MODES)
def test_the_comparison_takes_it_alike(image, codes, alpha, mode, in_editor):
    image.alpha_mode = mode
    bpy.ops.crf.estimate_response(image=image.name)
    should = expected(image, codes, alpha, "NONE" if mode == "CHANNEL_PACKED" else mode)
    assert np.abs(shown_as_linear(image, in_editor) - should).max() < 1e-4


def test_a_plate_that_is_baked_again_has_the_alpha_of_the_new_setting(addon, codes, alpha, tmp_path):
    path = write_image(tmp_path / "plate.png", np.concatenate([codes, alpha], axis=2), oiio__UnassociatedAlpha=1)
    image = bpy.data.images.load(str(path))
    bpy.ops.crf.estimate_response(image=image.name)
    for mode in ("CHANNEL_PACKED", "STRAIGHT"):
        image.alpha_mode = mode
        bpy.ops.crf.apply_response(image=image.name, apply="BAKE", depth="float", overwrite=True)
        baked = bpy.data.images["plate_linear.exr"]
        pixels = np.array(baked.pixels[:]).reshape(256, 256, 4)[::-1]
        assert baked.alpha_mode == ("CHANNEL_PACKED" if mode == "CHANNEL_PACKED" else "PREMUL")
        assert np.abs(pixels - expected(image, codes, alpha, mode)).max() < 1e-6


@pytest.mark.parametrize("kind", ["image", "clip"])
def test_in_movies_it_is_straight(addon, codes, tmp_path, composited, monkeypatch, kind):
    """So Blender takes it whatever the setting, and hands frames of 8 bits on multiplied by it."""
    from blender_addon.scene.compositor import compositor_tree

    alpha = np.maximum(codes[..., :1], 1)  # colors without coverage are not in a movie
    frames = [
        write_image(tmp_path / f"{number}.png", np.dstack([codes, alpha]), oiio__UnassociatedAlpha=1)
        for number in (1, 2)
    ]
    monkeypatch.setitem(CODECS, "alpha.mkv", ("MKV", "FFV1", "8"))
    encode(tmp_path / "alpha.mkv", frames, color_mode="RGBA")
    plate = load(kind, tmp_path / "alpha.mkv")
    if kind == "image":
        plate.alpha_mode = "CHANNEL_PACKED"
    bpy.ops.crf.estimate_response(**{kind: plate.name}, apply="NODES")
    (group,) = (node for node in compositor_tree(bpy.context.scene).nodes if node.type == "GROUP")
    should = expected(plate, codes, alpha, "STRAIGHT")
    assert np.abs(composited(group.outputs[0]) - should).max() < 1e-4


@pytest.mark.parametrize("mode", ["STRAIGHT", "PREMUL"])
def test_what_was_painted_is_not_multiplied_by_alpha_whatever_the_setting(
    addon, codes, alpha, mode, composited, in_editor, tmp_path
):
    """Blender divides by alpha where it reads a file; its compositor takes what is in memory for straight."""
    from blender_addon.scene.compositor import compositor_tree

    image = bpy.data.images.new("painted", 256, 256)
    image.alpha_mode = mode
    pixels = np.concatenate([codes, alpha], axis=2)[::-1] / 255
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    tree = compositor_tree(bpy.context.scene)
    (group,) = (node for node in tree.nodes if node.type == "GROUP")
    should = expected(image, codes, alpha, "STRAIGHT")
    assert np.abs(composited(group.outputs[0]) - should).max() < (BETWEEN if mode == "PREMUL" else 1e-5)
    bpy.ops.crf.apply_response(image=image.name, apply="BAKE", depth="float", folder=str(tmp_path))
    assert np.abs(read_image(tmp_path / "painted_linear.exr") - should).max() < 1e-6
    assert np.abs(shown_as_linear(image, in_editor) - should).max() < 1e-4
    as_it_is = tree.nodes.new("CompositorNodeImage")
    as_it_is.image = image
    color = codes[40, 100] / 255
    light = np.where(color > 0.04045, ((color + 0.055) / 1.055) ** 2.4, color / 12.92) * (alpha[40, 100] / 255)
    assert np.abs(composited(as_it_is.outputs["Image"])[40, 100, :3] - light).max() < 0.01  # of 8 bits
