import hashlib

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

from crfnet_core.errors import CRFNetError
from training.data.scenes import BAND, LUMINANCE
from training.data.studio_lights import LIGHTS, LIGHTS_FOLDER, copy_lights, read_light


def test_the_lights_are_those_of_blender():
    for light in LIGHTS:
        assert hashlib.sha256((LIGHTS_FOLDER / light.file).read_bytes()).hexdigest() == light.sha256
    assert sum(path.stat().st_size for path in LIGHTS_FOLDER.glob("*.exr")) < 2_500_000
    assert {light.file for light in LIGHTS}.isdisjoint({"sunrise.exr", "sunset.exr", "night.exr"})


def test_a_light_is_the_middle_of_its_panorama():
    scene = read_light(LIGHTS_FOLDER / "studio.exr")
    assert BAND == (0.1, 0.9)
    assert scene.pixels.shape == (410, 1024, 3)
    luminance = scene.pixels @ LUMINANCE
    assert np.exp(np.log(luminance[luminance > 0]).mean()) == pytest.approx(1, rel=1e-3)


def test_lights_are_copied_as_they_are_or_refused(tmp_path):
    copy_lights(LIGHTS_FOLDER, tmp_path)
    assert (tmp_path / "README.md").read_text() == (LIGHTS_FOLDER / "README.md").read_text()
    (tmp_path / "city.exr").write_bytes(b"other")
    with pytest.raises(CRFNetError, match=r"is not the file of Blender 4\.5"):
        copy_lights(tmp_path, tmp_path)
