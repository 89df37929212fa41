"""The bundled photograph is what training/synthesis/demo_plate.py makes of the studio light in this Blender."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from crfnet_core.photograph.image_io import read_photo
from training.synthesis.demo_plate import camera_response, photograph, read_scene, write_photograph

pytestmark = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="needs Blender's bpy module")


@pytest.fixture(scope="module")
def codes():
    """What the simulated camera makes of the scene, before JPEG."""
    blender = Path(importlib.util.find_spec("bpy").origin).parent
    (studio_light,) = blender.glob("*/datafiles/studiolights/world/forest.exr")
    return photograph(read_scene(studio_light))


def test_the_jpeg_holds_it(codes, plate, tmp_path):
    """Compressed again, by whichever libjpeg is here, it is the bundled photograph to one code."""
    write_photograph(tmp_path / "again.jpg", codes)
    kept, again = (np.rint(255 * read_photo(path).pixels) for path in (plate, tmp_path / "again.jpg"))
    assert np.abs(kept - again).max() <= 1
    assert np.abs(kept - codes).mean() < np.abs(kept - np.roll(codes, 1, axis=1)).mean() / 3


def test_windows_of_it_cover_the_range(codes):
    assert np.unique(codes).size == 256


def test_the_kept_response_is_its_own(true_response):
    np.testing.assert_allclose(true_response.brightness, camera_response(np.linspace(0, 1, 1024)), atol=2e-4)
