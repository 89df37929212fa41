"""docs/CAMERAS.md: its commands run, in order, and its list of cameras is that of the library."""

import re
import shlex

import pytest

from crfnet.configs.files import load_config
from crfnet_core.library import CameraLibrary
from tests.helpers.cameras import photograph
from tests.helpers.stacks import StackOptions, light_of, make_stack


@pytest.fixture(scope="module")
def page(root):
    return (root / "docs" / "CAMERAS.md").read_text(encoding="utf-8")


@pytest.fixture
def run(page, crfnet, tmp_path, monkeypatch):
    """Run the commands of a section in an empty folder, with an empty library; return what they print."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))

    def run_section(heading):
        section = page.partition(f"## {heading}\n")[2].partition("\n## ")[0]
        (commands,) = re.findall(r"^```\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
        printed = []
        for line in commands.splitlines():
            program, *arguments = shlex.split(line)
            assert program == "crfnet"
            done = crfnet(*(path for word in arguments for path in expanded(word)))
            assert (done.code, done.err) == (0, ""), line
            printed.append(done.out)
        return printed

    def expanded(word):
        return sorted(tmp_path.glob(word)) if "*" in word else [word]

    return run_section


def test_a_camera_from_its_photographs(run, plate, tmp_path):
    for seed, name in enumerate(("plate01", "IMG_1", "IMG_2", "IMG_3")):
        photograph(plate, tmp_path / f"{name}.jpg", seed=seed)
    printed = run("A camera from its photographs")
    assert "estimated from 3 photographs" in printed[2]
    assert (tmp_path / "linear" / "plate01.exr").is_file()
    assert load_config(tmp_path / "show" / "config.ocio").getColorSpace("CRF a7") is not None


def test_a_camera_that_was_measured(run, root, true_response, tmp_path):
    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::2, ::2]
    (tmp_path / "stack").mkdir()
    header = {"Make": "SONY", "Model": "ILCE-7M3", "Exif__PhotographicSensitivity": 100}
    make_stack(tmp_path / "stack", light, true_response, StackOptions(frames=6, quality=95), **header)
    *_, listed = run("A camera that was measured")
    assert "  A7 III: SONY ILCE-7M3; measured from 6 exposures, ISO 100\n" in listed


def test_it_says_how_many_cameras_there_are(page):
    cameras = CameraLibrary.shipped().cameras()
    models = {camera.settings.camera for camera in cameras}
    assert f"{len(models)} measured cameras ({len(cameras)} settings) come with crfnet" in page
