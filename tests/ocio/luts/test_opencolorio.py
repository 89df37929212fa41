"""Any 1D LUT that OpenColorIO reads is read as OpenColorIO reads it; other files are refused with a code."""

import os

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.errors import LutError
from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.lut1d import MAX_LENGTH, Lut1D
from crfnet.luts.opencolorio import MAX_FILE_SIZE
from crfnet.luts.rgb_lut import RgbLut1D
from tests.helpers.configs import through_lut
from tests.helpers.folders import written
from tests.helpers.refusals import refusal_of, refused

ROWS = ("0", "0.1", "0.3", "0.6", "1")
COMMAS = ("0", "0,1", "0,3", "0,6", "1")  # OpenColorIO reads "0,1" as 0
LUT = Lut1D([0, 0.1, 0.3, 0.6, 1])
CODES = np.linspace(0, 1, 256)
IDENTITY = "2\n0 1\n0 1\n"


def clf(*, attributes="", before="", rows=ROWS, depth="32f"):
    entries = "\n".join(rows)
    return (
        f'<ProcessList id="x" compCLFversion="3.0">{before}<LUT1D inBitDepth="32f" outBitDepth="{depth}" {attributes}>'
        f'<Array dim="{len(rows)} 1">{entries}</Array></LUT1D></ProcessList>\n'
    )


def value_range(low, high, *, depth="32f"):
    return (
        f'<Range inBitDepth="{depth}" outBitDepth="32f"><minInValue>{low}</minInValue><maxInValue>{high}</maxInValue>'
        "<minOutValue>0</minOutValue><maxOutValue>1</maxOutValue></Range>"
    )


def cube(head="LUT_1D_SIZE 5\n", rows=ROWS):
    return head + "".join(f"{row} {row} {row}\n" for row in rows)


def spi1d(head="Version 1\nFrom 0 1\n", rows=ROWS):
    return f"{head}Length {len(rows)}\nComponents 1\n{{\n" + "\n".join(rows) + "\n}\n"


def csp(rows=ROWS, *, shaper=IDENTITY, kind="1D"):
    body = "".join(f"{row} {row} {row}\n" for row in rows)
    return f"CSPLUTV100\n{kind}\n\n{shaper * 3}\n{len(rows)}\n{body}"


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("a.spi1d", spi1d(), LUT),
        ("a.spi1d", "# mine\r\n" + spi1d("Version 1\nFrom -1 2\n"), Lut1D(LUT.values, (-1, 2), ("mine",))),
        ("a.cube", cube(), LUT),
        ("a.cube", cube("LUT_1D_SIZE 5\nLUT_1D_INPUT_RANGE -0.5 1.5\n"), Lut1D(LUT.values, (-0.5, 1.5))),
        ("a.clf", clf(), LUT),
        ("a.clf", clf(rows=("0", "204", "1023"), depth="10i"), Lut1D([0, 204 / 1023, 1])),
        ("a.clf", clf(before="<Description>x</Description>" + value_range(-1, 2)), Lut1D(LUT.values, (-1, 2), ("x",))),
        ("a.clf", clf(before=value_range(0, 1023, depth="10i")), LUT),
        ("a.ctf", clf().replace('compCLFversion="3.0"', 'version="1.3"'), LUT),
        ("a.csp", csp(), LUT),
        ("a.csp", csp(shaper="2\n-0.5 1.5\n0 1\n"), None),
        ("a.csp", csp(shaper="3\n0 0.5 1\n0 0.1 1\n"), None),
        ("a.lut", "LUT: 1 256\n\n" + "".join(f"{code}\n" for code in np.rint(CODES**1.2 * 255).astype(int)), None),
        ("a.3dl", "".join(f"{code} {code} {code}\n" for code in np.rint(CODES**2.2 * 4095).astype(int)), None),
    ],
)
def test_what_opencolorio_reads_is_read_alike(tmp_path, name, text, expected):
    lut = read_lut(written(tmp_path / name, text))
    assert expected is None or lut == expected
    pixels = np.linspace(-1, 3, 4001)
    judged = through_lut(tmp_path / name, pixels, optimization=OCIO.OPTIMIZATION_NONE)
    np.testing.assert_allclose(lut.apply(pixels), judged, atol=3e-5)


MATRIX = '<Matrix inBitDepth="32f" outBitDepth="32f"><Array dim="3 3">1 0 0 0 2 0 0 0 1</Array></Matrix>'


@pytest.mark.parametrize(
    ("name", "text", "code"),
    [
        ("a.clf", clf(attributes='hueAdjust="dw3"'), "lut_not_1d"),
        ("a.clf", clf(attributes='halfDomain="true"', rows=["0"] * 65536), "lut_not_1d"),
        ("a.clf", clf(attributes='halfDomain="1"'), "lut_refused"),
        ("a.clf", clf(before=MATRIX), "lut_not_1d"),
        ("a.clf", clf()[:-30], "lut_refused"),
        ("a.clf", clf(before=value_range(2, 1)), "lut_refused"),
        ("a.cube", "LUT_IN_VIDEO_RANGE\n" + cube(), "lut_refused"),
        ("a.cube", "DOMAIN_MAX 1 1 2\n" + cube(), "lut_not_1d"),
        ("a.cube", "DOMAIN_MIN 2 2 2\n" + cube(), "lut_invalid"),
        ("a.cube", "LUT_3D_SIZE 2\n" + "0 0 0\n1 1 1\n" * 4, "lut_not_1d"),
        ("a.cube", "\udcdd\udcff", "lut_refused"),
        ("a.spi1d", spi1d("Version 2\nFrom 0 1\n"), "lut_refused"),
        ("a.spi1d", spi1d("Version 1\nFrom 1 0\n"), "lut_invalid"),
        ("a.spimtx", "1 0 0 0\n0 1 0 0\n0 0 1 0\n", "lut_not_1d"),
        ("a.csp", csp(kind="3D").replace("\n5\n", "\n2 2 2\n"), "lut_refused"),
        ("a.csp", "CSPLUTV100\n1D\n\nBEGIN METADATA\nhello\n", "lut_refused"),
        ("a.csp", "CSPLUTV100\n1D\nEND METADATA\n\nbegin metadata!\nhello\nEND", "lut_refused"),
        ("a.tif", "x", "lut_suffix"),
        *((f"a.{make.__name__}", make(rows=ROWS[::-1]), "lut_not_increasing") for make in (clf, cube, spi1d, csp)),
        *((f"a.{make.__name__}", make(rows=["0", "nan", *ROWS[2:]]), "lut_not_increasing") for make in (clf, cube)),
        *((f"a.{make.__name__}", make(rows=COMMAS), "lut_not_increasing") for make in (cube, spi1d)),
        *((f"a.{make.__name__}", make() + "1.5 1.5 1.5\n", "lut_rows") for make in (cube, spi1d, csp)),
        ("a.cube", cube(rows=("-3.4e38", "0", "1", "2", "3.4e38")), "lut_invalid"),
    ],
)
def test_other_files_are_refused(tmp_path, name, text, code):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8", errors="surrogateescape")
    with refused(LutError, code, path=path):
        read_lut(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("before", ["", "<!DOCTYPE a [<!ENTITY r '&#60;REF'>]>"])
def test_a_file_that_reads_others_is_refused(tmp_path, before, encoding):
    """They may be devices without an end, or files that read one another twice each."""
    (tmp_path / "other.ctf").write_text(clf().replace('compCLFversion="3.0"', 'version="1.3"'))
    reference = f'<Reference inBitDepth="32f" outBitDepth="32f" path="{tmp_path / "other.ctf"}"/>'
    text = f'{before}<ProcessList id="x" version="1.3">{"&r;" if before else "REF"}</ProcessList>'
    (tmp_path / "a.ctf").write_text(text.replace("REF", reference[1:] if before else reference), encoding=encoding)
    with refused(LutError, "lut_refused", reason="it may name other files"):
        read_lut(tmp_path / "a.ctf")


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("name", ["a$HOME", "${HOME}", "%HOME%", "é b", "a#@"])
def test_names_are_names(tmp_path, monkeypatch, suffix, name):
    """OpenColorIO takes a $ in a name for a variable, if there is one."""
    monkeypatch.setenv("HOME", "elsewhere")
    write_lut(tmp_path / f"{name}{suffix}", LUT)
    assert read_lut(tmp_path / f"{name}{suffix}") == LUT


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_absent_and_long_files_folders_pipes_and_devices_are_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe.cube")
    (tmp_path / "long.cube").write_bytes(b"#" * (MAX_FILE_SIZE + 1))
    (tmp_path / "zero.cube").symlink_to("/dev/zero")
    (tmp_path / "folder.cube").mkdir()
    for name in ("absent", "long", "pipe", "zero", "folder"):
        assert refusal_of(LutError, read_lut, tmp_path / f"{name}.cube").code == "lut_unreadable"


@pytest.mark.parametrize("suffix", WRITERS)
def test_the_longest_lut_is_within_the_bound(tmp_path, suffix):
    lut = RgbLut1D(tuple(Lut1D(np.linspace(-1.23456789e-7, 1e-6 * n, MAX_LENGTH)) for n in (1, 2, 3)))
    write_lut(tmp_path / f"a{suffix}", lut)
    assert read_lut(tmp_path / f"a{suffix}") == lut
