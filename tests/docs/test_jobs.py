"""docs/JOBS.md: its commands run, in order, and do what the text says."""

import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.configs.files import load_config
from crfnet_core.photograph.image_io import read_photo
from tests.helpers.movies import write_movie

JOBS = Path(__file__).parents[2] / "docs" / "JOBS.md"


def blocks(heading, language=""):
    """Return the code blocks of a section."""
    section = JOBS.read_text(encoding="utf-8").partition(f"## {heading}")[2].partition("\n## ")[0]
    return re.findall(rf"^```{language}\n(.*?)^```", section, re.MULTILINE | re.DOTALL)


def header(path):
    source = oiio.ImageInput.open(str(path))
    try:
        return source.spec()
    finally:
        source.close()


@pytest.fixture
def run(crfnet, tmp_path, monkeypatch):
    """Run the commands of a section in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run_section(heading):
        (commands,) = blocks(heading)
        for line in commands.splitlines():
            program, *arguments = shlex.split(line)
            assert program == "crfnet"
            done = crfnet(*arguments)
            assert (done.code, done.err) == (0, ""), line

    return run_section


def test_phone_footage(run, plate, tmp_path):
    codes = (read_photo(plate).pixels * 255).round().astype(np.uint8)
    height, width = (side // 2 * 2 for side in codes.shape[:2])
    images = [np.ascontiguousarray(codes[:height, :width])] * 6
    tags = {"color_range": 1, "colorspace": 1}
    write_movie(tmp_path / "clip.mp4", size=(width, height), images=images, tags=tags)
    run("Phone footage into Blender or a compositor")
    frames = sorted((tmp_path / "linear").iterdir())
    assert [frame.name for frame in frames] == [f"clip.{number:04d}.exr" for number in range(1, 7)]
    assert header(frames[0]).getattribute("FramesPerSecond") is not None


def test_a_photograph_into_a_studio_s_config(run, oiiotool, plate, tmp_path):
    shutil.copy(plate, tmp_path / "plate01.jpg")
    run("A photograph into a studio's ACES config")
    assert header(tmp_path / "look" / "plate01_linear.exr").get_string_attribute("colorInteropID") == "lin_ap1_scene"
    config = load_config(tmp_path / "show" / "config.ocio")
    assert config.getColorSpace("CRF plate01") is not None
    assert config.getColorSpaceFromFilepath("/anywhere/plate01.jpg")[0] == "CRF plate01"
    convert = ("--colorconvert", "CRF plate01", "ACEScg", "-o", tmp_path / "by_oiiotool.exr")
    oiiotool("--colorconfig", tmp_path / "show" / "config.ocio", plate, *convert)


def test_thousands_of_photographs(run, plate, tmp_path):
    (tmp_path / "photographs").mkdir()
    for name in ("plate01.jpg", "plate02.jpg"):
        shutil.copy(plate, tmp_path / "photographs" / name)
    heading = "Thousands of photographs for a data set"
    run(heading)
    names: dict[str, object] = {}
    (snippet,) = blocks(heading, "python")
    exec(snippet, names)
    assert len(names["records"]) == 2
    assert names["failed"] == []
    assert names["linear"].shape == (256,)
