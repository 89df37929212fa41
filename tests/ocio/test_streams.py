"""stderr belongs to the command: what libraries in C print by themselves does not reach it."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from tests.helpers.images import write_image

CRFNET = Path(sys.executable).with_name("crfnet")


def run(code, **options):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, **options)


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
    done = run(code, cwd=root)
    assert (done.returncode, done.stderr) == (0, "own\nlater\nand Python\n")


def test_a_traceback_of_a_bug_is_not_lost(root):
    code = (
        "import crfnet.cli.main as m, crfnet.cli.commands.info as i\n"
        "def bug(_): 1 / 0\n"
        "i.run = bug\n"
        "m.main(['info', 'x'])"
    )
    assert "ZeroDivisionError" in run(code, cwd=root).stderr


@pytest.mark.parametrize("command", ["estimate", "linearize"])
def test_a_damaged_png_gives_one_line(tmp_path, command):
    noise = np.random.default_rng(0).integers(0, 256, (300, 300, 3), dtype=np.uint8)
    path = write_image(tmp_path / "a.png", noise)
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    (tmp_path / "a.cube").write_text("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n")
    more = ["--lut", tmp_path / "a.cube", "--out", tmp_path / "a.exr"]
    more = more if command == "linearize" else ["--out", tmp_path / "out"]
    done = subprocess.run([CRFNET, command, path, *more], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == BAD_INPUT
    assert done.stderr.startswith(f"crfnet: error: {path}: this PNG file is damaged or cut short")
    assert done.stderr.count("\n") == 1
