"""docs/CAMERAS.md: its commands run, in order, and its number of cameras is that of the library."""

import re
import shlex

import pytest

from crfnet_core.library import CameraLibrary
from tests.helpers.cameras import photograph
from tests.helpers.stacks import StackOptions, light_of, make_stack


@pytest.fixture(scope="module")
def page(root):
    return (root / "docs" / "CAMERAS.md").read_text(encoding="utf-8")


def test_its_commands_run(page, crfnet, root, plate, true_response, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    photograph(plate, tmp_path / "plate01.jpg")
    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::2, ::2]
    (tmp_path / "stack").mkdir()
    header = {"Make": "SONY", "Model": "ILCE-7M3", "Exif__PhotographicSensitivity": 100}
    make_stack(tmp_path / "stack", light, true_response, StackOptions(frames=6, quality=95), **header)
    (commands,) = re.findall(r"^```\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    for line in commands.splitlines():
        program, *words = shlex.split(line)
        paths = [path for word in words for path in (sorted(tmp_path.glob(word)) if "*" in word else [word])]
        assert program == "crfnet"
        done = crfnet(*paths)
        assert (done.code, done.err) == (0, ""), line
    assert (tmp_path / "linear" / "plate01.exr").is_file()
    assert (tmp_path / "a7.spi1d").is_file()


def test_it_says_how_many_cameras_there_are(page):
    cameras = CameraLibrary.shipped().cameras()
    models = {camera.settings.camera for camera in cameras}
    assert f"{len(models)} measured cameras ({len(cameras)} settings) come with crfnet" in page
