"""The `crfnet` command, from the shell's side: what it writes, what it says, and how it refuses."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from ocio import commands
from ocio.cli import BAD_INPUT, INTERRUPTED
from ocio.luts.lut1d import inverse_response_lut
from ocio.luts.spi1d import read_spi1d, write_spi1d
from ocio.pipeline import estimates
from tests.helpers.processes import start_interruptible

FILES = {
    "plate.spi1d",
    "plate.cube",
    "plate.clf",
    "config.ocio",
    "plate_linear.exr",
    "plate_sheet.png",
    "plate.json",
}
COMMANDS = ("estimate", "linearize", "info", "completion")


def read_pixels(path):
    return np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))[..., :3]


def tree(folder):
    """Every file below a folder with its bytes."""
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def looked(crfnet, plate, fixed_model, tmp_path_factory):
    """The output folder of `crfnet estimate` on the bundled photograph, float EXR."""
    folder = tmp_path_factory.mktemp("look")
    done = crfnet("estimate", plate, "--out", folder, "--model", fixed_model, "--depth", "float")
    assert (done.code, done.err) == (0, "")
    return folder


@pytest.fixture(scope="module")
def linear(crfnet, looked, plate, tmp_path_factory):
    """The pixels that `crfnet linearize` makes of the bundled photograph."""
    path = tmp_path_factory.mktemp("linear") / "linear.exr"
    lut = looked / "plate.spi1d"
    assert crfnet("linearize", plate, "--lut", lut, "--out", path, "--depth", "float").code == 0
    return read_pixels(path)


@pytest.fixture
def estimate(crfnet, fixed_model, tmp_path):
    """Run `crfnet estimate` with the fixed model into tmp_path/out, without a sheet."""

    def run(*arguments):
        return crfnet("estimate", *arguments, "--out", tmp_path / "out", "--model", fixed_model, "--no-sheet")

    return run


@pytest.fixture
def sequence(plate, tmp_path):
    """A folder of frames 1, 2, 3 and 5 of a plate."""
    for number in (1, 2, 3, 5):
        shutil.copy(plate, tmp_path / f"shot.{number:04d}.jpg")
    return tmp_path


class TestEstimate:
    def test_writes_what_it_says(self, looked):
        assert {path.name for path in looked.iterdir()} == FILES

    def test_says_what_it_read_found_and_wrote(self, crfnet, plate, fixed_model, tmp_path):
        out = crfnet("estimate", plate, "--out", tmp_path / "look", "--model", fixed_model).out
        assert "plate.jpg: 672 x 378, 8 bits" in out
        assert "The estimate is good." in out
        assert "% of the brightness range" in out
        assert "--ociofiletransform" in out
        assert all(name in out for name in FILES)

    def test_prints_one_json_document(self, estimate, plate, tmp_path):
        document = json.loads(estimate(plate, "--json").out)
        found = document["estimates"][0]
        assert document["folder"] == str(tmp_path / "out")
        assert found == json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))
        assert set(found) == {
            *("photographs", "verdict", "uncertainty", "uncertainty_percent", "spread", "warnings", "model", "weights"),
            *("windows", "response", "color_space", "files"),
        }
        assert found["photographs"] == [{"name": "plate.jpg", "width": 672, "height": 378, "bit_depth": 8}]
        assert len(found["response"]["brightness"]) == 1024
        assert len(found["windows"]) == 10
        assert found["files"]["sheet"] is None
        assert found["color_space"] == "CRF plate"

    def test_the_luts_hold_the_inverse_of_the_response(self, looked, true_response):
        lut = read_spi1d(looked / "plate.spi1d")
        np.testing.assert_allclose(lut.values, true_response.inverse(np.linspace(0, 1, 4081)), atol=5e-3)
        assert any("plate.jpg" in comment for comment in lut.comments)
        assert any("fixed" in comment for comment in lut.comments)

    def test_the_same_photograph_gives_the_same_bytes(self, crfnet, looked, plate, fixed_model, tmp_path):
        crfnet("estimate", plate, "--out", tmp_path, "--model", fixed_model, "--depth", "float")
        assert tree(tmp_path) == tree(looked)

    def test_writes_nothing_outside_the_output_folder(self, crfnet, plate, fixed_model, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setenv("TMPDIR", str(tmp_path))
        photo = shutil.copy(plate, tmp_path / "photo.jpg")
        before = tree(tmp_path)
        assert crfnet("estimate", "photo.jpg", "--out", "deep/look", "--model", fixed_model).code == 0
        written = {path for path in tree(tmp_path) if path not in before}
        assert {path.parent for path in written} == {Path("deep/look")}
        assert Path(photo).read_bytes() == plate.read_bytes()

    def test_several_photographs_make_one_response(self, estimate, plate, tmp_path):
        other = shutil.copy(plate, tmp_path / "other.jpg")
        out = estimate(plate, other).out
        names = {path.name for path in (tmp_path / "out").iterdir()}
        assert names == FILES - {"plate_sheet.png"} | {"other_linear.exr"}
        assert "20 windows agree" in out

    def test_each_photograph_makes_its_own(self, estimate, plate, tmp_path):
        other = shutil.copy(plate, tmp_path / "other.jpg")
        done = estimate(plate, other, "--each")
        assert done.code == 0
        listed = [line for line in done.out.splitlines() if ": good, expected error 0." in line]
        assert [line.partition(":")[0] for line in listed] == ["plate.jpg", other.name]
        names = {path.name for path in (tmp_path / "out").iterdir()}
        own = FILES - {"plate_sheet.png"}
        assert names == own | {name.replace("plate", "other") for name in own}
        config = (tmp_path / "out" / "config.ocio").read_text(encoding="utf-8")
        assert "name: CRF plate" in config
        assert "name: CRF other" in config

    @pytest.mark.parametrize(
        "name",
        ["two words.jpg", "été 写真.jpg", "a$b%20#1.jpg", "-x.jpg", "no.dots.in.jpg", "q'u\"o.jpg", "[1,  2].jpg"],
    )
    def test_any_file_name_works(self, estimate, plate, tmp_path, name):
        photo = shutil.copy(plate, tmp_path / name)
        done = estimate(photo)
        assert (done.code, done.err) == (0, "")
        assert len(list((tmp_path / "out").iterdir())) == len(FILES) - 1

    def test_what_is_there_stays_there(self, estimate, plate, tmp_path):
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "plate.cube").write_text("mine")
        done = estimate(plate)
        assert done.code == BAD_INPUT
        assert "plate.cube exists already; add --overwrite" in done.err
        assert tree(tmp_path / "out") == {Path("plate.cube"): b"mine"}

    def test_overwrite_replaces(self, estimate, plate, tmp_path):
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "plate.cube").write_text("mine")
        assert estimate(plate, "--overwrite").code == 0
        assert "LUT_1D_SIZE 4081" in (tmp_path / "out" / "plate.cube").read_text()

    def test_a_photograph_is_never_replaced(self, crfnet, plate, fixed_model, tmp_path):
        for name in ("a.png", "a_sheet.png"):
            shutil.copy(plate, tmp_path / name)
        before = tree(tmp_path)
        done = crfnet(
            *("estimate", tmp_path / "a.png", tmp_path / "a_sheet.png", "--out", tmp_path, "--overwrite"),
            *("--model", fixed_model),
        )
        assert done.code == BAD_INPUT
        assert "is one of the photographs" in done.err
        assert tree(tmp_path) == before

    def test_two_photographs_of_one_name_are_refused(self, estimate, plate, tmp_path):
        (tmp_path / "b").mkdir()
        done = estimate(plate, shutil.copy(plate, tmp_path / "b"), "--each")
        assert done.code == BAD_INPUT
        assert "two photographs would both be written as" in done.err

    def test_a_bad_photograph_among_good_ones_stops_everything(self, estimate, plate, tmp_path):
        assert estimate(plate, tmp_path / "none.jpg", "--each").code == BAD_INPUT
        assert not (tmp_path / "out").exists()

    def test_says_how_to_get_the_sheet_without_matplotlib(self, crfnet, plate, fixed_model, tmp_path, monkeypatch):
        monkeypatch.setattr(commands, "find_spec", lambda name: None)
        done = crfnet("estimate", plate, "--out", tmp_path, "--model", fixed_model)
        assert done.code == 0
        assert done.err.splitlines() == [commands.NO_MATPLOTLIB]
        assert not (tmp_path / "plate_sheet.png").exists()

    def test_exposure_goes_into_the_plate_and_the_config(self, estimate, plate, tmp_path, looked, oiiotool, tolerance):
        assert estimate(plate, "--exposure", "2", "--depth", "float").code == 0
        brighter = read_pixels(tmp_path / "out" / "plate_linear.exr")
        np.testing.assert_allclose(brighter, 4 * read_pixels(looked / "plate_linear.exr"), rtol=1e-6)
        converted = tmp_path / "converted.exr"
        config = tmp_path / "out" / "config.ocio"
        oiiotool(
            "--colorconfig",
            config,
            plate,
            "--colorconvert",
            "CRF plate",
            "scene_linear",
            "-d",
            "float",
            "-o",
            converted,
        )
        np.testing.assert_allclose(read_pixels(converted), brighter, atol=4 * tolerance.plate)


class TestProgressBar:
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    def test_moves_on_a_terminal(self, monkeypatch):
        monkeypatch.setattr(sys, "stderr", self.Terminal())
        monkeypatch.setenv("COLUMNS", "80")
        with commands._progress_bar("windows") as progress:
            progress(10, 10)
        assert "windows" in sys.stderr.getvalue()

    def test_is_absent_elsewhere(self, monkeypatch):
        monkeypatch.setattr(sys, "stderr", io.StringIO())
        with commands._progress_bar("windows") as progress:
            assert progress is None
        assert sys.stderr.getvalue() == ""


class TestOtherHosts:
    """The LUT and the config through the real oiiotool give what `crfnet linearize` gives."""

    def test_linearize_equals_numpy(self, linear, looked, plate, tolerance):
        codes = np.asarray(oiio.ImageBuf(str(plate)).get_pixels(oiio.UINT8))
        table = read_spi1d(looked / "plate.spi1d").apply(np.arange(256) / 255)
        np.testing.assert_allclose(linear, table[codes], atol=tolerance.lut)

    def test_linearize_equals_the_plate_of_estimate(self, linear, looked):
        np.testing.assert_array_equal(linear, read_pixels(looked / "plate_linear.exr"))

    @pytest.mark.parametrize("suffix", ["spi1d", "cube", "clf"])
    def test_oiiotool_with_the_lut(self, linear, looked, plate, oiiotool, tolerance, tmp_path, suffix):
        out = tmp_path / "out.exr"
        oiiotool(plate, "--ociofiletransform", looked / f"plate.{suffix}", "-d", "float", "-o", out)
        np.testing.assert_allclose(read_pixels(out), linear, atol=tolerance.plate)

    def test_oiiotool_with_the_config(self, linear, looked, plate, oiiotool, tolerance, tmp_path):
        out = tmp_path / "out.exr"
        convert = ("--colorconvert", "CRF plate", "scene_linear")
        oiiotool("--colorconfig", looked / "config.ocio", plate, *convert, "-d", "float", "-o", out)
        np.testing.assert_allclose(read_pixels(out), linear, atol=tolerance.plate)

    def test_oiiotool_with_the_file_rule(self, linear, looked, plate, oiiotool, tolerance, tmp_path):
        out = tmp_path / "out.exr"
        oiiotool("--colorconfig", looked / "config.ocio", "--autocc", plate, "-d", "float", "-o", out)
        np.testing.assert_allclose(read_pixels(out), linear, atol=tolerance.plate)

    def test_the_printed_lines_work(self, crfnet, plate, fixed_model, tmp_path):
        photo = shutil.copy(plate, tmp_path / "a plate.jpg")
        done = crfnet("estimate", photo, "--out", tmp_path / "my look", "--model", fixed_model, "--no-sheet")
        lines = [line.strip() for line in done.out.splitlines() if line.strip().startswith("oiiotool")]
        assert len(lines) == 2
        pixels = []
        for line in lines:
            path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
            subprocess.run(line, shell=True, check=True, cwd=tmp_path, env={**os.environ, "PATH": path})
            pixels.append(read_pixels(tmp_path / "linear.exr"))
        expected = read_pixels(tmp_path / "my look" / "a plate_linear.exr")
        np.testing.assert_allclose(pixels, [expected, expected], rtol=2**-10, atol=2**-20)


class TestLinearize:
    def test_a_sequence_with_a_gap(self, crfnet, looked, sequence):
        done = crfnet(
            *("linearize", sequence / "shot.####.jpg", "--lut", looked / "plate.spi1d"),
            *("--out", sequence / "linear" / "shot.%04d.exr"),
        )
        assert done.code == 0
        assert "4 frames" in done.out
        assert "Missing frames: 4." in done.out
        assert len(list((sequence / "linear").iterdir())) == 4

    def test_estimates_one_response_without_a_lut(self, crfnet, fixed_model, sequence):
        arguments = ("linearize", sequence / "shot.####.jpg", "--out", sequence / "l.####.exr", "--model", fixed_model)
        done = crfnet(*arguments)
        assert done.code == 0
        assert "Response estimated from shot.0001.jpg and 3 more frames." in done.out
        frames = [read_pixels(sequence / f"l.{number:04d}.exr") for number in (1, 5)]
        np.testing.assert_array_equal(*frames)

    def test_goes_on_where_it_stopped(self, crfnet, looked, sequence):
        arguments = ("linearize", sequence / "shot.####.jpg", "--lut", looked / "plate.spi1d", "--json")
        out = ("--out", sequence / "l.####.exr")
        crfnet(*arguments, *out, "--frames", "1-2")
        document = json.loads(crfnet(*arguments, *out).out)
        assert document["skipped"] == [str(sequence / f"l.000{number}.exr") for number in (1, 2)]
        assert document["written"] == [str(sequence / f"l.000{number}.exr") for number in (3, 5)]
        assert document["missing"] == [4]
        assert document["estimate"] is None

    def test_says_what_was_left_alone(self, crfnet, looked, plate, tmp_path):
        arguments = ("linearize", plate, "--lut", looked / "plate.spi1d", "--out", tmp_path / "a.exr")
        crfnet(*arguments)
        assert "left alone (add --overwrite otherwise)" in crfnet(*arguments).out
        assert crfnet(*arguments, "--overwrite").out == f"Written: {tmp_path / 'a.exr'}.\n"


class TestInfo:
    @pytest.mark.parametrize("suffix", ["spi1d", "cube", "clf"])
    def test_of_a_lut(self, crfnet, looked, suffix):
        out = crfnet("info", looked / f"plate.{suffix}").out
        assert f"plate.{suffix}: 1D LUT of 4081 entries" in out
        assert "Photographs: plate.jpg" in out

    def test_of_a_lut_as_json(self, crfnet, looked):
        document = json.loads(crfnet("info", looked / "plate.spi1d", "--json").out)
        assert (document["kind"], document["length"], document["domain"]) == ("lut", 4081, [0, 1])
        assert len(document["provenance"]) == 4

    @pytest.mark.parametrize("part", ["", "model.json", "model.onnx"])
    def test_of_a_model(self, crfnet, fixed_model, part):
        out = crfnet("info", fixed_model / part).out
        assert "fixed: model" in out
        assert "sha256: " in out

    def test_of_a_model_as_json(self, crfnet, fixed_model):
        document = json.loads(crfnet("info", fixed_model, "--json").out)
        assert (document["kind"], document["name"], document["components"]) == ("model", "fixed", 11)


class TestHelp:
    @pytest.mark.parametrize("command", COMMANDS)
    def test_every_command_has_examples(self, crfnet, command):
        done = crfnet(command, "--help")
        assert done.code == 0
        assert f"examples:\n  crfnet {command} " in done.out

    def test_lists_every_command(self, crfnet):
        out = crfnet("--help").out
        assert all(command in out for command in COMMANDS)

    def test_version(self, crfnet):
        assert crfnet("--version").out.startswith("crfnet 0.")

    @pytest.mark.parametrize("shell", ["bash", "zsh", "tcsh"])
    def test_completion(self, crfnet, shell):
        done = crfnet("completion", shell)
        assert done.code == 0
        assert "linearize" in done.out

    @pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
    def test_bash_accepts_the_completion(self, crfnet):
        script = crfnet("completion", "bash").out
        subprocess.run(["bash", "-n"], input=script, text=True, check=True)


def make_bad_inputs(folder):
    """Write one file of each kind that is no photograph."""
    (folder / "empty.jpg").write_bytes(b"")
    (folder / "text.jpg").write_text("not a photograph")
    (folder / "folder.jpg").mkdir()
    small = oiio.ImageBuf(oiio.ImageSpec(100, 100, 3, oiio.UINT8))
    small.write(str(folder / "small.png"))
    small.write(str(folder / "linear.exr"))
    write_spi1d(folder / "good.spi1d", inverse_response_lut_of_gamma())
    (folder / "bad.spi1d").write_text("Version 1\nFrom 0 1\nLength 2\nComponents 1\n{\n1\n0\n}\n")
    (folder / "bad_model").mkdir()
    (folder / "bad_model" / "model.json").write_text("{}")
    (folder / "file").write_text("in the way")


def inverse_response_lut_of_gamma():
    from crfnet_core.response import ResponseCurve

    return inverse_response_lut(ResponseCurve.gamma())


BAD_ESTIMATES = {
    "absent": ["{in}/none.jpg"],
    "empty": ["{in}/empty.jpg"],
    "text": ["{in}/text.jpg"],
    "folder": ["{in}/folder.jpg"],
    "truncated": ["{in}/truncated.jpg"],
    "too small": ["{in}/small.png"],
    "scene-linear": ["{in}/linear.exr"],
    "absent model": ["{plate}", "--model", "{in}/none"],
    "empty model": ["{plate}", "--model", "{in}/bad_model"],
    "model is a file": ["{plate}", "--model", "{in}/file"],
    "output is a file": ["{plate}", "--out", "{in}/file"],
    "output below a file": ["{plate}", "--out", "{in}/file/deep"],
    "length 1": ["{plate}", "--length", "1"],
    "length too large": ["{plate}", "--length", "99999999"],
    "no windows": ["{plate}", "--windows", "0"],
    "words for a number": ["{plate}", "--windows", "many"],
    "negative threads": ["{plate}", "--threads", "-1"],
    "unknown depth": ["{plate}", "--depth", "double"],
    "endless exposure": ["{plate}", "--exposure", "inf"],
    "no exposure": ["{plate}", "--exposure", "nan"],
    "huge exposure": ["{plate}", "--exposure", "1e6"],
    "unknown option": ["{plate}", "--nonsense"],
    "no photograph": [],
}

BAD_LINEARIZES = {
    "absent plate": ["{in}/none.jpg", "--lut", "{in}/good.spi1d"],
    "absent frames": ["{in}/none.%04d.jpg", "--lut", "{in}/good.spi1d"],
    "broken plate": ["{in}/text.jpg", "--lut", "{in}/good.spi1d"],
    "folder": ["{in}", "--lut", "{in}/good.spi1d"],
    "absent LUT": ["{plate}", "--lut", "{in}/none.spi1d"],
    "falling LUT": ["{plate}", "--lut", "{in}/bad.spi1d"],
    "photograph for a LUT": ["{plate}", "--lut", "{plate}"],
    "frames of a file": ["{plate}", "--lut", "{in}/good.spi1d", "--frames", "1-2"],
    "bad frames": ["{in}/a.%04d.jpg", "--lut", "{in}/good.spi1d", "--frames", "one"],
    "bad output": ["{plate}", "--lut", "{in}/good.spi1d", "--out", "{out}/plate.png"],
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
    places = {"in": tmp_path / "in", "out": tmp_path / "out", "plate": plate}
    given = [argument.format(**places) for argument in arguments]
    if command != "info" and "--out" not in given:
        given += ["--out", str(tmp_path / "out" / ("a.exr" if command == "linearize" else ""))]
    if command != "info" and "--model" not in given:
        given += ["--model", str(fixed_model)]
    done = crfnet(command, *given)
    assert done.code == BAD_INPUT
    assert done.out == ""
    assert done.err.startswith("crfnet: error: ")
    assert done.err.count("\n") == 1
    assert tree(tmp_path) == before
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("arguments", [(), ("nonsense",), ("completion", "dos")])
def test_bad_commands_are_refused_in_one_line(crfnet, arguments):
    done = crfnet(*arguments)
    assert done.code == BAD_INPUT
    assert done.err.startswith("crfnet: error: ")
    assert done.err.count("\n") == 1


@pytest.mark.parametrize(
    ("problem", "code", "line"),
    [
        (KeyboardInterrupt(), INTERRUPTED, "crfnet: interrupted"),
        (MemoryError(), BAD_INPUT, "crfnet: error: not enough memory"),
        (OSError(28, "No space left on device", "x.exr"), BAD_INPUT, "crfnet: error: [Errno 28] No space left"),
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


class TestProcess:
    """The installed command, in a process of its own."""

    CRFNET = Path(sys.executable).with_name("crfnet")

    def test_runs(self, plate, fixed_model, tmp_path):
        command = [self.CRFNET, "estimate", plate, "--out", tmp_path / "out", "--model", fixed_model]
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        assert {path.name for path in (tmp_path / "out").iterdir()} == FILES

    def test_prints_names_that_the_encoding_lacks(self, plate, fixed_model, tmp_path):
        photo = shutil.copy(plate, tmp_path / "写真.jpg")
        command = [self.CRFNET, "estimate", photo, "--out", tmp_path / "out", "--model", fixed_model, "--json"]
        environment = {**os.environ, "PYTHONIOENCODING": "ascii"}
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        assert json.loads(done.stdout)["estimates"][0]["photographs"][0]["name"] == "写真.jpg"

    @pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
    def test_refuses_names_that_are_no_text(self, plate, fixed_model, tmp_path):
        photo = tmp_path / os.fsdecode(b"\xff.jpg")
        shutil.copy(plate, photo)
        command = [self.CRFNET, "estimate", photo, "--out", tmp_path / "out", "--model", fixed_model]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == BAD_INPUT
        assert done.stderr == "crfnet: error: a file's name is no valid Unicode; rename it\n"
        assert not (tmp_path / "out").exists()

    def test_a_reader_that_leaves_is_no_error_message(self, looked):
        command = f"'{self.CRFNET}' info '{looked / 'plate.spi1d'}' | true"
        done = subprocess.run(command, shell=True, capture_output=True, text=True, check=False)
        assert done.stderr == ""

    @pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
    def test_control_c_leaves_no_traceback(self, plate, fixed_model, tmp_path):
        code = (
            "import sys, time, ocio.pipeline.estimates as e, ocio.cli;"
            "e.estimate_response = lambda *a, **k: (print('ready', flush=True), time.sleep(60));"
            "sys.exit(ocio.cli.main(sys.argv[1:]))"
        )
        command = [sys.executable, "-c", code, "estimate", plate, "--out", tmp_path / "out", "--model", fixed_model]
        with start_interruptible(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            process.stdout.readline()
            time.sleep(0.1)
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=20)
        assert process.returncode == INTERRUPTED
        assert err == "crfnet: interrupted\n"
        assert not (tmp_path / "out").exists()
