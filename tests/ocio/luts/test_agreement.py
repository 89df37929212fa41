"""OpenColorIO has the last word: what it refuses, or reads otherwise, is refused; also what never ends."""

import os

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.interchange.files import read_response
from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.lut1d import Lut1D

ROWS = ("0", "0.1", "0.3", "0.6", "1")


def clf(*, attributes="", version='compCLFversion="3.0"', before="", rows=ROWS, depth="32f", prolog=""):
    return (
        f'{prolog}<ProcessList id="x" {version}>{before}<LUT1D inBitDepth="32f" outBitDepth="{depth}" {attributes}>\n'
        f'<Array dim="{len(rows)} 1">\n' + "\n".join(rows) + "\n</Array></LUT1D></ProcessList>\n"
    )


def cube(head="LUT_1D_SIZE 5\n", rows=ROWS):
    return head + "".join(f"{row} {row} {row}\n" for row in rows)


def spi1d(head="Version 1\n", rows=ROWS):
    return f"{head}From 0 1\nLength {len(rows)}\nComponents 1\n{{\n" + "\n".join(rows) + "\n}\n"


TWICE = (
    '<Range inBitDepth="32f" outBitDepth="32f"><minInValue>0</minInValue><maxInValue>2</maxInValue>'
    "<minOutValue>0</minOutValue><maxOutValue>1</maxOutValue><minInValue>-1</minInValue></Range>"
)
UNDERSCORE, ARABIC = ("0", "0.1_5", "0.3", "0.6", "1"), ("0", "\u0660.\u0661", "0.3", "0.6", "1")


@pytest.mark.parametrize("make", [clf, cube, spi1d])
def test_the_plain_files_are_read(tmp_path, make):
    (tmp_path / f"a.{make.__name__}").write_text(make())
    assert read_lut(tmp_path / f"a.{make.__name__}") == Lut1D([0, 0.1, 0.3, 0.6, 1])


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.clf", clf(attributes='hueAdjust="dw3"'), "reads another table"),
        ("a.clf", clf(attributes='hueAdjust="x"'), "hueAdjust"),
        ("a.clf", clf(attributes='halfDomain="1"'), "Illegal 'halfDomain' attribute '1'"),
        ("a.clf", clf(attributes='halfDomain="TRUE"'), "halfDomain"),
        ("a.clf", clf(attributes='interpolation="cubic"'), "interpolation"),
        ("a.clf", clf(version='compCLFversion="9.0"'), "Unsupported transform file version '9.0'"),
        ("a.clf", clf(version=""), "no LUT"),
        ("a.clf", clf(before="junk"), "no LUT"),
        ("a.clf", clf(before=TWICE), "reads another table or domain"),
        ("a.clf", clf(rows=("0", "&#48;.1", "0.3", "0.6", "1")), "no LUT"),
        ("a.clf", clf(prolog='<?xml version="1.0" encoding="UTF-16"?>'), "no LUT"),
        ("a.clf", clf(rows=("0", "1e-37", "1.5e-37", "255"), depth="8i"), "line 4: 1e-37 is not above"),
        ("a.cube", "LUT_IN_VIDEO_RANGE\n" + cube(), "LUT_IN_VIDEO_RANGE"),
        ("a.cube", "LUT_OUT_VIDEO_RANGE\n" + cube(), "LUT_OUT_VIDEO_RANGE"),
        ("a.cube", "DOMAIN_SHAPE 1\n" + cube(), "DOMAIN_SHAPE"),
        ("a.cube", "LUT_1D_INPUT_RANGE 0 2\nDOMAIN_MIN -1 -1 -1\n" + cube(), "no LUT"),
        ("a.cube", cube(head="") + "LUT_1D_SIZE 5\n", "no LUT"),
        ("a.cube", cube().replace("\n", "\r"), "found 16 number"),
        ("a.cube", "\ufeff" + cube(), "no LUT"),
        ("a.spi1d", spi1d(head="Version 2\n"), "Only format version 1 supported"),
        ("a.spi1d", spi1d(head=""), "no LUT"),
        ("a.spi1d", spi1d().replace("{\n", "{\n# middle\n"), "no LUT"),
        *((f"a.{make.__name__}", make(rows=UNDERSCORE), "'0.1_5' is no number") for make in (clf, cube, spi1d)),
        *((f"a.{make.__name__}", make(rows=ARABIC), "is no number") for make in (clf, cube, spi1d)),
        *((f"a.{make.__name__}", make(rows=("-3.4e38", "3.4e38")), "") for make in (clf, cube, spi1d)),
    ],
)
def test_what_opencolorio_refuses_or_reads_otherwise_is_refused(tmp_path, name, text, said):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LutError) as caught:
        read_lut(path)
    message = str(caught.value)
    assert said in message
    assert message.startswith(f"{path}")
    assert "\n" not in message


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("name", ["a$HOME", "${HOME}", "%HOME%", "é b", "a#@"])
def test_names_are_names(tmp_path, monkeypatch, suffix, name):
    """OpenColorIO takes a $ in a name for a variable, if there is one."""
    monkeypatch.setenv("HOME", "elsewhere")
    write_lut(tmp_path / f"{name}{suffix}", Lut1D([0, 0.5, 1]))
    assert read_lut(tmp_path / f"{name}{suffix}") == Lut1D([0, 0.5, 1])


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize("suffix", [*WRITERS, ".csp", ".npy", ".xml", ".m", ".txt", ".pto"])
def test_pipes_and_devices_are_not_read(tmp_path, suffix):
    os.mkfifo(tmp_path / f"pipe{suffix}")
    (tmp_path / f"zero{suffix}").symlink_to("/dev/zero")
    for name in ("pipe", "zero"):
        with pytest.raises(LutError, match="it is no regular file"):
            read_response(tmp_path / f"{name}{suffix}")


def test_a_lut_has_room_in_single_precision():
    for values, domain in (([-1e36, 1e36], (0, 1)), ([0, 1], (-1e36, 1e36))):
        with pytest.raises(LutError, match="spans more than 1e"):
            Lut1D(values, domain)
    widest = Lut1D([-4e34, 4e34], (-4e34, 4e34))
    with np.errstate(all="raise"):
        assert widest.apply(np.float32([-4e34, 0, 4e34])).tolist() == np.float32([-4e34, 0, 4e34]).tolist()
