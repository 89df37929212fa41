"""HEIC and AVIF, which Blender cannot show: the estimator reads them."""

import numpy as np
import pytest

from tests.helpers.images import read_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.fixture
def avif(addon, tmp_path, codes):
    """A lossless AVIF file."""
    pillow = pytest.importorskip("PIL.Image", reason="needs Pillow to write AVIF")
    path = tmp_path / "phone.avif"
    pillow.fromarray(codes).save(path, quality=100, subsampling="4:4:4")
    return path


@pytest.fixture
def heic(root, tmp_path):
    """A HEIC file in a name that Blender does not know."""
    path = tmp_path / "phone.heic"
    path.write_bytes((root / "tests" / "data" / "heif" / "rgb8.heic").read_bytes())
    return path


def file_pixels(path):
    from crfnet_core.photograph.image_io import read_photo

    return read_photo(path).pixels


def test_a_plate_that_blender_cannot_show_is_estimated_and_baked(addon, avif, tmp_path, estimate):
    from blender_addon.scene import stored_estimate

    image = bpy.data.images.load(str(avif))
    assert bpy.ops.crf.estimate_response(image=image.name, apply="BAKE", depth="float") == {"FINISHED"}
    found = stored_estimate.restored(image)
    assert found.weights.tolist() == estimate(avif).weights.tolist()
    assert np.abs(read_image(tmp_path / "phone_linear.exr") - found.curve.inverse(file_pixels(avif))).max() < 1e-6


def test_where_blender_would_have_to_show_it_the_message_says_what_to_do(addon, heic):
    image = bpy.data.images.load(str(heic))
    with pytest.raises(RuntimeError, match=r"phone\.heic: Blender cannot show this format; choose Bake"):
        bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    assert "camera_response" not in image


def test_its_linear_plate_is_shown(addon, avif, in_editor):
    from blender_addon.scene import stored_estimate

    image = bpy.data.images.load(str(avif))
    bpy.ops.crf.estimate_response(image=image.name)
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        assert bpy.ops.crf.compare(is_after=True) == {"FINISHED"}
        width, height = space.image.size
        shown = np.array(space.image.pixels).reshape(height, width, 4)[::-1, :, :3]
        bpy.ops.crf.compare(is_after=False)
    expected = stored_estimate.restored(image).curve.inverse(file_pixels(avif))
    assert np.abs(shown - expected).max() < 1e-5


def test_a_heic_is_decoded(addon, heic):
    """It is smaller than a window, which is known only once it has been decoded."""
    image = bpy.data.images.load(str(heic))
    with pytest.raises(RuntimeError, match="64 x 48"):
        bpy.ops.crf.estimate_response(image=image.name)


def test_without_its_decoder_the_message_says_what_to_do_in_blender(addon, heic, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "pi_heif", None)
    image = bpy.data.images.load(str(heic))
    with pytest.raises(RuntimeError, match=r"HEIC needs the package pi_heif"):
        bpy.ops.crf.estimate_response(image=image.name)
