"""LUT formats that OpenColorIO reads, both directions of those that are ours, and what is no response."""

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.interchange.files import READABLE, read_response, write_response
from crfnet.luts.files import write_lut
from crfnet.luts.forward import forward_lut
from crfnet.luts.lut1d import Lut1D, inverse_response_lut
from crfnet.luts.rgb_lut import RgbLut1D

CODES = np.linspace(0, 1, 256)
SHAPER = "2\n0.0 1.0\n0.0 1.0\n" * 3


def csp(rows, shaper=SHAPER):
    body = "".join(" ".join(map(str, row)) + "\n" for row in rows)
    return f"CSPLUTV100\n1D\n\n{shaper}\n{len(rows)}\n{body}"


def test_a_csp_file_of_one_table_keeps_its_entries(tmp_path):
    table = np.stack([CODES**exponent for exponent in (2.2, 2.0, 1.8)], axis=1)
    (tmp_path / "a.csp").write_text(csp(table))
    found = read_response(tmp_path / "a.csp")
    assert isinstance(found.lut, RgbLut1D)
    assert found.lut.values == pytest.approx(table, abs=1e-7)
    assert found.words == "LUT of the format .csp, R, G and B apart, from code values to light"


def test_a_csp_file_from_light_to_codes_is_inverted(tmp_path):
    table = np.repeat(CODES[:, None] ** (1 / 2), 3, axis=1)
    (tmp_path / "a.csp").write_text(csp(table))
    found = read_response(tmp_path / "a.csp")
    assert found.was_forward
    assert found.lut.apply(CODES[10:]) == pytest.approx(CODES[10:] ** 2, abs=1e-3)
    assert found.lut.comments == (
        "Read from a.csp: LUT of the format .csp, one table, from light to code values; this is its inverse",
    )


def test_a_csp_file_with_a_shaper_is_sampled(tmp_path):
    shaper = "3\n0.0 0.5 1.0\n0.0 0.1 1.0\n" * 3
    (tmp_path / "a.csp").write_text(csp([[0, 0, 0], [1, 1, 1]], shaper))
    assert read_response(tmp_path / "a.csp").lut.apply(np.array([0.5])) == pytest.approx(0.1, abs=1e-4)


@pytest.mark.parametrize("name", ["a.3dl", "a.lut"])
def test_integers_may_be_level(tmp_path, name):
    most = 4095 if name == "a.3dl" else 255
    codes = np.rint(CODES**2.2 * most).astype(int)
    rows = [f"{code} {code} {code}" for code in codes] if name == "a.3dl" else ["LUT: 1 256", "", *map(str, codes)]
    (tmp_path / name).write_text("\n".join([*rows, ""]))
    found = read_response(tmp_path / name)
    assert found.lut.apply(CODES) == pytest.approx(codes / most, abs=1e-6)
    assert found.notes[0].endswith("steps are level in the file, and rise by the least that float32 can hold")


def cube_3d(path):
    grid = range(0, 257, 16)
    rows = [f"{min(r * 16, 4095)} {min(g * 16, 4095)} {min(b * 16, 4095)}" for r in grid for g in grid for b in grid]
    path.write_text("\n".join([" ".join(str(min(64 * step, 1023)) for step in range(17)), *rows, ""]))


def test_3d_tables_are_refused(tmp_path):
    cube_3d(tmp_path / "a.3dl")
    corners = [f"{r} {g} {b}" for b in (0, 1) for g in (0, 1) for r in (0, 1)]
    (tmp_path / "a.csp").write_text("\n".join(["CSPLUTV100", "3D", "", SHAPER + "2 2 2", *corners, ""]))
    for name in ("a.3dl", "a.csp"):
        with pytest.raises(LutError, match="holds a 3D LUT, which mixes the channels; give a 1D LUT"):
            read_response(tmp_path / name)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.csp", "nothing\n", "OpenColorIO reads no LUT from it"),
        ("a.3dl", " ".join(str(min(64 * step, 1023)) for step in range(17)), "OpenColorIO reads no LUT from it"),
        ("a.csp", csp([[0, 0, 0], [0.5, 0.5, 0.5], [0.4, 0.4, 0.4], [1, 1, 1]]), "does not increase"),
        ("a.csp", csp([[0.5, 0.5, 0.5], [0.5, 0.5, 0.5]]), "does not increase"),
        ("a.csp", "", "is empty"),
        ("a.csp", csp([["0", "0", "0"], ["\xdd", "1", "1"]], SHAPER), "OpenColorIO reads no LUT from it"),
        ("a.csp", "CSPLUTV100\n1D\n\nBEGIN METADATA\nhello\n", "has no line END METADATA"),
        ("a.csp", "CSPLUTV100\n1D\n\nBEGIN METADATA\nhello\nEND", "has no line END METADATA"),
        ("a.csp", "CSPLUTV100\n1D\n\nbegin metadata!\nhello\n", "has no line END METADATA"),
        ("a.csp", "CSPLUTV100\n1D\nEND METADATA\n\nBEGIN METADATA\x0bEND METADATA\n", "has no line END METADATA"),
        ("a.tif", "x", r"responses are read from \.spi1d, \.cube, \.clf, .*; found '\.tif'"),
    ],
)
def test_what_is_no_response_is_refused(tmp_path, name, text, message):
    (tmp_path / name).write_bytes(text.encode("latin-1"))
    with pytest.raises(LutError, match=message) as caught:
        read_response(tmp_path / name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("suffix", [".spi1d", ".cube", ".clf"])
class TestOurFormats:
    def test_an_inverse_response_is_taken_as_it_is(self, tmp_path, suffix, true_response):
        lut = inverse_response_lut(true_response, comments=("mine",))
        write_lut(tmp_path / f"a{suffix}", lut)
        found = read_response(tmp_path / f"a{suffix}")
        assert (found.lut, found.was_forward) == (lut, False)

    def test_a_response_is_inverted(self, tmp_path, suffix, true_response):
        write_lut(tmp_path / f"a{suffix}", forward_lut(inverse_response_lut(true_response)))
        found = read_response(tmp_path / f"a{suffix}")
        assert found.was_forward
        assert np.abs(found.lut.apply(CODES) - true_response.inverse(CODES)).max() < 1e-4

    def test_a_table_for_each_channel_is_kept(self, tmp_path, suffix, rgb_lut):
        write_lut(tmp_path / f"a{suffix}", rgb_lut)
        assert read_response(tmp_path / f"a{suffix}").lut == rgb_lut


def test_linear_light_is_not_inverted(tmp_path):
    write_lut(tmp_path / "a.cube", Lut1D([0, 1]))
    assert not read_response(tmp_path / "a.cube").was_forward


def test_a_curve_is_chosen_only_where_there_are_several(tmp_path):
    write_lut(tmp_path / "a.cube", Lut1D([0, 1]))
    with pytest.raises(LutError, match="holds one response, so there is no 'x' to choose"):
        read_response(tmp_path / "a.cube", curve="x")


@pytest.mark.parametrize("suffix", READABLE)
def test_an_absent_file_is_named(tmp_path, suffix):
    with pytest.raises(LutError, match=r"cannot be read \(No such file or directory\)"):
        read_response(tmp_path / f"none{suffix}")


def test_only_responses_are_written_here(tmp_path):
    with pytest.raises(LutError, match=r"responses are written as \.spi1d, .*found '\.csp'"):
        write_response(tmp_path / "a.csp", Lut1D([0, 1]))
