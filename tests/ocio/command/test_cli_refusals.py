import shlex
import shutil

import numpy as np
import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.pipeline import estimates
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.folders import tree
from tests.helpers.images import write_image


@pytest.fixture
def inputs(plate, tmp_path, monkeypatch):
    """The current folder: the bundled photograph, a LUT, and a file of each kind that is refused."""
    folder = tmp_path / "in"
    folder.mkdir()
    monkeypatch.chdir(folder)
    shutil.copy(plate, "plate.jpg")
    (folder / "empty.jpg").write_bytes(b"")
    (folder / "cut.jpg").write_bytes(plate.read_bytes()[:30000])
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


BAD = [
    ("no_such_file", "estimate none.jpg"),
    ("photograph_is_empty", "estimate empty.jpg"),
    ("folder_for_photograph", "estimate folder.jpg"),
    ("damaged", "estimate cut.jpg"),
    ("smaller_than_window", "estimate small.png"),
    ("scene_linear_file", "estimate linear.exr"),
    ("no_such_photograph", "estimate loop.jpg"),
    ("unreadable_model", "estimate plate.jpg --model none"),
    ("bad_model_config", "estimate plate.jpg --model bad_model"),
    ("no_prior", "estimate plate.jpg --prior none.json"),
    ("prior_not_json", "estimate plate.jpg --prior file"),
    ("not_a_folder", "estimate plate.jpg --out file"),
    ("file_exists", "estimate plate.jpg --out dangling"),
    ("each_option_alone", "estimate plate.jpg --workers 2"),
    ("usage", "estimate plate.jpg --depth double"),
    ("no_such_plate", "linearize none.jpg --lut good.spi1d"),
    ("no_such_plate", "linearize loop.jpg --lut good.spi1d"),
    ("no_such_frames", "linearize none.%04d.jpg --lut good.spi1d"),
    ("folder_without_sequence", "linearize . --lut good.spi1d"),
    ("lut_unreadable", "linearize plate.jpg --lut none.spi1d"),
    ("lut_not_increasing", "linearize plate.jpg --lut bad.spi1d"),
    ("frames_of_each", "linearize plate.jpg --each --frames 1-2"),
    ("lut_unreadable", "linearize plate.jpg --each --lut none.spi1d"),
    ("several_plates", "linearize plate.jpg more.jpg"),
    ("photograph_is_empty", "linearize empty.jpg --lut good.spi1d --out ../out/a.%04d.exr"),
    ("pattern_for_file", "linearize plate.jpg --lut good.spi1d --out ../out/a.%04d.exr"),
    ("not_a_folder", "linearize plate.jpg --lut good.spi1d --out file/a.exr"),
    ("target_is_plate", "linearize linear.exr --lut good.spi1d --out linear.exr --overwrite"),
    ("lut_suffix", "info plate.jpg"),
    ("usage", ""),
    ("usage", "nonsense"),
]


@pytest.mark.parametrize(("code", "line"), BAD)
def test_bad_input_is_refused_and_everything_left_as_it_was(crfnet, fixed_model, inputs, tmp_path, code, line):
    before = tree(tmp_path)
    words = shlex.split(line)
    if words[:1] in (["estimate"], ["linearize"]):
        words += [] if "--out" in words else ["--out", "../out" if words[0] == "estimate" else "../out/a.exr"]
        words += [] if "--model" in words else ["--model", fixed_model]
    done = crfnet(*words)
    assert (done.refusal, done.out) == (code, "")
    assert tree(tmp_path) == before
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "line",
    [
        *("estimate '' --out x --each", "estimate a --out ''", "estimate a --out x --frames ''", "info ''"),
        *("estimate a --out x --model ''", "estimate a --out x --prior ''", "estimate a --out x --scheduler ''"),
        *("linearize '' --out x", "linearize a --out x --lut ''", "linearize a --out x --lut a.spi1d --camera ''"),
        *("calibrate '' --out x", "calibrate a --out x --name ''", "calibrate a --out x --times ''"),
        *("calibrate a --out x --compare ''", "camera add --from-calibration ''", "camera show ''"),
        *("camera add --from-calibration a --name ''", "camera export 'A7' ''", "config list ''"),
        *("config add --base '' --out x a", "config add --base a --out '' a", "config add --base a --out x ''"),
    ],
)
def test_an_empty_value_as_of_an_unset_variable_is_refused(crfnet, line):
    """Else it is the current folder, or as if the option were not given."""
    done = crfnet(*shlex.split(line))
    assert (done.refusal, ": is empty; " in done.err) == ("usage", True)


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


@pytest.mark.parametrize(
    ("problem", "code", "line"),
    [
        (KeyboardInterrupt(), 130, "crfnet: interrupted"),
        (MemoryError(), BAD_INPUT, "crfnet: error: not enough memory"),
        (OSError(28, "No space left on device", "x.exr"), BAD_INPUT, "crfnet: error: x.exr: No space left on device;"),
        (OSError(2, "No such file"), BAD_INPUT, "crfnet: error: the output: No such file;"),
        (type("OfNumPy", (MemoryError,), {})("8 MiB"), BAD_INPUT, "crfnet: error: not enough memory; close something"),
        (RuntimeError("can't start new thread"), BAD_INPUT, "crfnet: error: the system starts no more threads;"),
        (ImportError("libx.so:\n no\x1b"), BAD_INPUT, "crfnet: error: libx.so: no?; clear PYTHONPATH"),
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
