import json
import re
import shlex
import sys
from pathlib import Path

import numpy as np
import pytest

from crfnet.luts.files import read_lut
from crfnet.movies.frames import WHITE, MovieFrames
from crfnet_core.photograph.image_io import read_photo
from tests.helpers.folders import listed
from tests.helpers.movies import run_ffmpeg, write_movie
from tests.helpers.plates import read_exr
from tests.helpers.schemas import problems_by, read_schema


@pytest.fixture(scope="module")
def movie(tmp_path_factory):
    """24 frames of 320 x 240, large enough for windows."""
    return write_movie(tmp_path_factory.mktemp("movie") / "clip.mp4", 24, size=(320, 240), options={"g": "6"})


@pytest.fixture
def linearize(crfnet, look, movie, tmp_path):
    """Run `crfnet linearize` on the movie into tmp_path/linear, with the LUT of the bundled photograph."""
    out = tmp_path / "linear" / "l.%04d.exr"
    return lambda *more: crfnet("linearize", movie, "--lut", look / "plate.spi1d", "--out", out, *more)


def test_every_frame_becomes_a_linear_plate(linearize, movie, look, tmp_path):
    done = linearize("--depth", "float")
    assert done.code == 0
    assert done.out.startswith("clip.mp4: H.264, 320 x 240, 8 bits, 24 frames at 24 per second; BT.601, limited range")
    assert listed(tmp_path / "linear") == [f"l.{number:04d}.exr" for number in range(1, 25)]
    pixels, header = read_exr(tmp_path / "linear" / "l.0013.exr")
    assert header.getattribute("FramesPerSecond") == (24, 1)
    samples = next(MovieFrames.find(movie, "13").loaders([0]))().samples / WHITE
    np.testing.assert_allclose(pixels, read_lut(look / "plate.spi1d").apply(samples), rtol=1e-5, atol=1e-6)


def test_some_frames_become_linear_plates(linearize, tmp_path):
    document = json.loads(linearize("--frames", "5-30x5", "--json").out)
    assert [Path(path).name for path in document["written"]] == [f"l.00{number}.exr" for number in ("05", 10, 15, 20)]
    assert document["missing"] == [25, 30]
    assert document["movie"].startswith("clip.mp4: H.264")


def test_an_estimate_of_a_movie(crfnet, fixed_model, movie, tmp_path):
    assert crfnet("estimate", movie, "--out", tmp_path / "look", "--model", fixed_model, "--no-sheet").code == 0
    names = {"clip.spi1d", "clip.cube", "clip.clf", "config.ocio", "clip_linear.exr", "clip.json"}
    assert set(listed(tmp_path / "look")) == names
    found = json.loads((tmp_path / "look" / "clip.json").read_text())
    assert problems_by(read_schema("estimate"))(found) == []
    assert found["movies"][0].startswith("clip.mp4: H.264")
    assert found["metadata"][0]["encoding"] == "movie"
    first = {"name": "clip.mp4 frame 2", "width": 320, "height": 240, "bit_depth": 8, "has_gain_map": False}
    assert found["photographs"][0] == first
    assert read_exr(tmp_path / "look" / "clip_linear.exr")[0].shape == (240, 320, 3)


@pytest.mark.parametrize("command", ["estimate", "linearize"])
def test_without_pyav_it_says_what_to_do(crfnet, look, movie, tmp_path, monkeypatch, command):
    monkeypatch.setitem(sys.modules, "av", None)
    out = ("--lut", look / "plate.spi1d", "--out", tmp_path / "a.%d.exr")
    done = crfnet(command, movie, *(out if command == "linearize" else ("--out", tmp_path / "out")))
    assert (done.refusal, done.out) == ("pyav_missing", "")
    line = shlex.split(done.err.partition("extract its frames: ")[2])
    assert line[0] == "ffmpeg"
    run_ffmpeg(*line[1:])
    written = sorted(movie.parent.glob("clip.*.png"))
    assert (len(written), read_photo(written[0]).bit_depth) == (24, 16)
    for path in written:
        path.unlink()
    assert listed(tmp_path) == []


def test_log_footage_is_refused_with_its_color_space_unless_metadata_is_ignored(crfnet, fixed_model, tmp_path):
    path = write_movie(tmp_path / "hdr.mp4", size=(320, 240), tags={"color_trc": 16})
    commands = ("estimate", path, "--out", tmp_path / "out"), ("linearize", path, "--out", tmp_path / "%d.exr")
    for command in commands:
        done = crfnet(*command)
        assert done.refusal == "tagged_color_space"
        assert 'in ACES configs "Rec.2100-PQ - Display"' in done.err
    assert listed(tmp_path) == ["hdr.mp4"]
    assert [crfnet(*command, "--ignore-metadata", "--model", fixed_model).code for command in commands] == [0, 0]


def test_a_movie_that_is_linear_already_is_refused_with_a_lut_too(crfnet, look, tmp_path):
    path = write_movie(tmp_path / "linear.mp4", size=(320, 240), tags={"color_trc": 8})
    command = ("linearize", path, "--lut", look / "plate.spi1d", "--out", tmp_path / "%d.exr")
    assert crfnet(*command).refusal == "tagged_linear"
    assert crfnet(*command, "--ignore-metadata").code == 0


def test_an_interlaced_movie_is_estimated_from_but_linearized_after_deinterlacing(
    crfnet, fixed_model, look, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    write_movie(tmp_path / "clip.mp4", 24, size=(320, 240), is_interlaced=True)
    done = crfnet("estimate", "clip.mp4", "--out", "look", "--model", fixed_model, "--no-sheet")
    assert (done.code, "; interlaced: its frames mix two moments" in done.out) == (0, True)
    done = crfnet("linearize", "clip.mp4", "--lut", look / "plate.spi1d", "--out", "linear/clip.%04d.exr")
    assert done.refusal == "movie_interlaced"
    run_ffmpeg(*shlex.split(re.search(r"ffmpeg (-i .*\.png) \(leave", done.err)[1]))
    assert {"clip.0001.png", "clip.0003.png"} <= set(listed(tmp_path))
    done = crfnet("linearize", "clip.%04d.png", "--lut", look / "plate.spi1d", "--out", "linear/clip.%04d.exr")
    assert (done.code, listed(tmp_path / "linear")[:1]) == (0, ["clip.0001.exr"])
