"""The command refuses bad input on one line, and leaves everything as it was."""

import numpy as np
import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.pipeline import estimates
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.folders import tree
from tests.helpers.images import write_image


def make_bad_inputs(folder):
    """Write one file of each kind that is not a photograph."""
    (folder / "empty.jpg").write_bytes(b"")
    (folder / "text.jpg").write_text("not a photograph")
    (folder / "folder.jpg").mkdir()
    write_image(folder / "small.png", np.zeros((100, 100, 3), np.uint8))
    write_image(folder / "linear.exr", np.zeros((100, 100, 3), np.float16))
    write_lut(folder / "good.spi1d", inverse_response_lut(ResponseCurve.gamma()))
    (folder / "bad.spi1d").write_text("Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n1\n0\n}\n")
    (folder / "bad_model").mkdir()
    (folder / "bad_model" / "model.json").write_text("{}")
    (folder / "file").write_text("in the way")
    (folder / "loop.jpg").symlink_to("loop.jpg")
    (folder / "dangling").mkdir()
    (folder / "dangling" / "plate.spi1d").symlink_to("nowhere")


BAD_ESTIMATES = {
    "absent": ["{in}/none.jpg"],
    "empty": ["{in}/empty.jpg"],
    "folder": ["{in}/folder.jpg"],
    "truncated": ["{in}/truncated.jpg"],
    "too small": ["{in}/small.png"],
    "scene-linear": ["{in}/linear.exr"],
    "absent model": ["{plate}", "--model", "{in}/none"],
    "empty model": ["{plate}", "--model", "{in}/bad_model"],
    "absent prior": ["{plate}", "--prior", "{in}/none.json"],
    "prior without JSON": ["{plate}", "--prior", "{in}/text.jpg"],
    "output is a file": ["{plate}", "--out", "{in}/file"],
    "endless link": ["{in}/loop.jpg"],
    "link to nothing in place of an output": ["{plate}", "--out", "{in}/dangling"],
    "unknown depth": ["{plate}", "--depth", "double"],
    "endless exposure": ["{plate}", "--exposure", "inf"],
    "unknown option": ["{plate}", "--nonsense"],
    "no photograph": [],
    "an empty name for the output": ["{plate}", "--out", ""],
    "workers without --each": ["{plate}", "--workers", "2"],
}

BAD_LINEARIZES = {
    "absent plate": ["{in}/none.jpg", "--lut", "{in}/good.spi1d"],
    "absent frames": ["{in}/none.%04d.jpg", "--lut", "{in}/good.spi1d"],
    "folder": ["{in}", "--lut", "{in}/good.spi1d"],
    "absent LUT": ["{plate}", "--lut", "{in}/none.spi1d"],
    "falling LUT": ["{plate}", "--lut", "{in}/bad.spi1d"],
    "photograph for a LUT": ["{plate}", "--lut", "{plate}"],
    "endless link": ["{in}/loop.jpg", "--lut", "{in}/good.spi1d"],
    "frames of a file": ["{plate}", "--lut", "{in}/good.spi1d", "--frames", "1-2"],
    "bad output": ["{plate}", "--lut", "{in}/good.spi1d", "--out", "{out}/plate.png"],
    "a pattern for a single file": ["{plate}", "--lut", "{in}/good.spi1d", "--out", "{out}/a.%04d.exr"],
    "output below a file": ["{plate}", "--lut", "{in}/good.spi1d", "--out", "{in}/file/a.exr"],
    "onto itself": ["{in}/linear.exr", "--lut", "{in}/good.spi1d", "--out", "{in}/linear.exr", "--overwrite"],
}

BAD_INFOS = {
    "absent LUT": ["{in}/none.spi1d"],
    "falling LUT": ["{in}/bad.spi1d"],
    "photograph": ["{plate}"],
    "absent": ["{in}/none"],
    "folder without a model": ["{in}"],
    "config": ["{in}/config.ocio"],
}


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        pytest.param(command, arguments, id=f"{command}: {name}")
        for command, cases in (("estimate", BAD_ESTIMATES), ("linearize", BAD_LINEARIZES), ("info", BAD_INFOS))
        for name, arguments in cases.items()
    ],
)
def test_bad_input_is_refused_in_one_line(crfnet, plate, fixed_model, tmp_path, command, arguments):
    (tmp_path / "in").mkdir()
    make_bad_inputs(tmp_path / "in")
    (tmp_path / "in" / "truncated.jpg").write_bytes(plate.read_bytes()[:30000])
    before = tree(tmp_path)
    paths = {"in": tmp_path / "in", "out": tmp_path / "out", "plate": plate}
    given = [argument.format(**paths) for argument in arguments]
    if command != "info" and "--out" not in given:
        given += ["--out", str(tmp_path / "out" / ("a.exr" if command == "linearize" else ""))]
    if command != "info" and "--model" not in given:
        given += ["--model", str(fixed_model)]
    done = crfnet(command, *given)
    assert done.refusal
    assert done.out == ""
    assert tree(tmp_path) == before
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("name", "code"), [("none.jpg", "no_such_file"), (".", "folder_for_photograph")])
def test_what_is_no_photograph_is_said_before_the_output_is_looked_at(crfnet, look, tmp_path, name, code):
    """Else a user adds --overwrite to a line about files that exist, and has replaced nothing."""
    assert crfnet("estimate", tmp_path / name, "--out", look).refusal == code


@pytest.mark.parametrize("folder", ["$HOME", "projects$", "a%b%"])
def test_a_folder_whose_name_opencolorio_takes_for_a_variable_is_refused(crfnet, plate, tmp_path, folder):
    """At once, since hosts would find no LUT beside the config. Linear plates need no config, and are written."""
    (tmp_path / folder).mkdir()
    lut_file = tmp_path / "a.spi1d"
    write_lut(lut_file, inverse_response_lut(ResponseCurve.gamma()))
    base = "ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4"
    for command in (
        ("estimate", plate, "--out", tmp_path / folder),
        ("estimate", plate, "--out", tmp_path / folder, "--each"),
        ("config", "add", "--base", base, "--out", tmp_path / folder, lut_file),
    ):
        assert crfnet(*command).refusal == "variables_in_path"
        assert list((tmp_path / folder).iterdir()) == []
    assert crfnet("linearize", plate, "--lut", lut_file, "--out", tmp_path / folder / "a.exr").code == 0


@pytest.mark.parametrize("arguments", [(), ("nonsense",), ("completion", "dos")])
def test_bad_commands_are_refused_in_one_line(crfnet, arguments):
    assert crfnet(*arguments).refusal == "usage"


@pytest.mark.parametrize(
    ("problem", "code", "line"),
    [
        (KeyboardInterrupt(), 130, "crfnet: interrupted"),
        (MemoryError(), BAD_INPUT, "crfnet: error: not enough memory"),
        (OSError(28, "No space left on device", "x.exr"), BAD_INPUT, "crfnet: error: x.exr: No space left on device;"),
        (OSError(2, "No such file"), BAD_INPUT, "crfnet: error: the output: No such file;"),
    ],
)
def test_what_stops_it_in_the_middle_is_one_line(estimate, plate, monkeypatch, problem, code, line):
    def fail(*arguments, **options):
        raise problem

    monkeypatch.setattr(estimates, "estimate_response", fail)
    done = estimate(plate)
    assert done.code == code
    assert done.err.startswith(line)
    assert done.err.count("\n") == 1


def test_the_name_of_the_linear_plate_is_checked_before_the_estimate(crfnet, plate, fixed_model, tmp_path, monkeypatch):
    def fail(*arguments, **options):
        raise AssertionError("estimated although nothing can be written")

    monkeypatch.setattr(estimates, "estimate_response", fail)
    assert crfnet("linearize", plate, "--out", tmp_path / "plate.png", "--model", fixed_model).refusal == "not_exr"
