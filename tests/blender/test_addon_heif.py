"""HEIC and AVIF, which Blender cannot show: the estimator reads them."""

import sys

import numpy as np
import pytest

from crfnet_core.photograph.image_io import read_photo
from tests.helpers.images import read_image

from .helpers import bpy, linear_shown, load, stored_estimate
from .helpers import estimate as run


@pytest.fixture
def heic(root, tmp_path):
    """A HEIC file in a name that Blender does not know."""
    path = tmp_path / "phone.heic"
    path.write_bytes((root / "tests" / "data" / "heif" / "rgb8.heic").read_bytes())
    return path


def test_a_plate_that_blender_cannot_show_is_estimated_and_baked_and_its_light_is_shown(
    addon, codes, tmp_path, estimate, in_editor
):
    pillow = pytest.importorskip("PIL.Image", reason="needs Pillow to write AVIF")
    avif = tmp_path / "phone.avif"
    pillow.fromarray(codes).save(avif, quality=100, subsampling="4:4:4")
    image = load(avif)
    run(image, "BAKE", depth="float")
    found = stored_estimate.restored(image)
    assert found.weights.tolist() == estimate(avif).weights.tolist()
    linear = found.curve.inverse(read_photo(avif).pixels)
    assert np.abs(read_image(tmp_path / "phone_linear.exr") - linear).max() < 1e-6
    assert np.abs(linear_shown(image, in_editor)[..., :3] - linear).max() < 1e-5


def test_where_blender_would_have_to_show_it_the_message_says_what_to_do(addon, heic):
    image = load(heic)
    with pytest.raises(RuntimeError, match=r"phone\.heic: Blender cannot show this format; choose Bake"):
        bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    assert "camera_response" not in image


def test_a_heic_is_decoded(addon, heic):
    """It is smaller than a window, which is known only once it has been decoded."""
    image = load(heic)
    with pytest.raises(RuntimeError, match="64 x 48"):
        bpy.ops.crf.estimate_response(image=image.name)


def test_without_its_decoder_the_message_says_what_to_do_in_blender(addon, heic, monkeypatch):
    monkeypatch.setitem(sys.modules, "pi_heif", None)
    image = load(heic)
    with pytest.raises(RuntimeError, match=r"HEIC needs the package pi_heif"):
        bpy.ops.crf.estimate_response(image=image.name)
