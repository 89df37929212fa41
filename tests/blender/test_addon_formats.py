"""BMP, JPEG 2000 and odd JPEG: the estimator reads them itself, with the OpenImageIO of Blender."""

import numpy as np
import pytest

from tests.helpers.images import read_image, write_image

from .helpers import bpy, curve_of, estimate, load


@pytest.mark.parametrize("suffix", ["bmp", "jp2"])
def test_their_code_values_are_exact(addon, tmp_path, codes, plate_file, suffix):
    path = tmp_path / f"other.{suffix}"
    if suffix == "jp2":
        save_jpeg_2000(plate_file, path)
    else:
        write_image(path, codes)
    image = load(path)
    estimate(image, "BAKE", depth="float")
    expected = curve_of(image).inverse(codes / 255)
    assert np.abs(read_image(tmp_path / "other_linear.exr") - expected).max() < 1e-6


def test_names_that_are_not_utf8_are_read(addon, tmp_path, plate_file):
    path = write_image(tmp_path / "a.jpg", read_image(plate_file, kind="uint8"), Make="Voigtl_nder")
    path.write_bytes(path.read_bytes().replace(b"l_n", b"l\xe4n"))
    image = load(path)
    estimate(image)
    assert image.camera_response.is_stored


def save_jpeg_2000(source, target):
    scene, image = bpy.context.scene, load(source)
    image.colorspace_settings.name = "Non-Color"
    scene.view_settings.view_transform = "Raw"
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.quality = "JPEG2000", "RGB", 100
    image.save_render(str(target), scene=scene)
