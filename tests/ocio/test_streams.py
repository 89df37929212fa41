"""stderr belongs to the command: what libraries in C print by themselves does not reach it."""

import sys
from pathlib import Path

import numpy as np
import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from tests.helpers.folders import written
from tests.helpers.images import write_image
from tests.helpers.processes import ran

CRFNET = Path(sys.executable).with_name("crfnet")


def test_only_the_program_s_own_lines_reach_stderr(root):
    code = (
        "import os, sys\n"
        "from crfnet.cli.streams import own_stderr\n"
        "with own_stderr():\n"
        "    os.write(2, b'from C\\n'); print('own', file=sys.stderr)\n"
        "    try:\n        with own_stderr(): os.write(2, b'nested\\n'); raise ValueError\n"
        "    except ValueError: pass\n"
        "os.write(2, b'later\\n'); print('and Python', file=sys.stderr)\n"
    )
    done = ran(sys.executable, "-c", code, cwd=root)
    assert (done.returncode, done.stderr) == (0, "own\nlater\nand Python\n")


def test_a_traceback_of_a_bug_is_not_lost(root):
    code = (
        "import crfnet.cli.main as m, crfnet.cli.commands.info as i\n"
        "def bug(_): 1 / 0\n"
        "i.run = bug\n"
        "m.main(['info', 'x'])"
    )
    assert "ZeroDivisionError" in ran(sys.executable, "-c", code, cwd=root).stderr


@pytest.mark.parametrize("command", ["estimate", "linearize"])
def test_a_damaged_png_gives_one_line(tmp_path, command):
    noise = np.random.default_rng(0).integers(0, 256, (300, 300, 3), dtype=np.uint8)
    content = bytearray(write_image(tmp_path / "a.png", noise).read_bytes())
    content[len(content) // 2] ^= 0xFF
    path = written(tmp_path / "a.png", content)
    written(tmp_path / "a.cube", "LUT_1D_SIZE 2\n0 0 0\n1 1 1\n")
    more = {"estimate": ["--out", "out"], "linearize": ["--lut", "a.cube", "--out", "a.exr"]}[command]
    done = ran(CRFNET, command, path, *more, cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (BAD_INPUT, 1)
    assert done.stderr.startswith(f"crfnet: error: {path}: this PNG file is damaged or cut short")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such names")
def test_no_control_character_of_a_name_is_printed(crfnet, plate, fixed_model, tmp_path):
    """ESC, the turn to right-to-left, a line separator, the CSI of one byte, and a line feed, which forges lines."""
    photo = tmp_path / "a\x1b[31m\u202e\u2028\x9b\nforged.jpg"
    photo.write_bytes(plate.read_bytes())
    out, linear = tmp_path / "out\x1b", tmp_path / "li\x9bnear"
    commands = (
        ("estimate", photo, "--out", out, "--model", fixed_model, "--no-sheet"),
        ("estimate", photo, "--out", linear, "--model", fixed_model, "--no-sheet", "--each", "--workers", "1"),
        ("linearize", photo, "--lut", out / f"{photo.stem}.spi1d", "--out", out / "a\u202e.exr"),
        ("info", photo),
        ("info", tmp_path / "absent\x1b.jpg"),
        ("estimate", "--no-such\x1b[31m", photo),
    )
    for command in commands:
        done = crfnet(*command)
        printed = done.out + done.err
        assert printed, command
        assert all(line.isprintable() and not line.startswith("forged") for line in printed.split("\n")), repr(printed)
