"""The 1D .cube format."""

import pytest

from crfnet.errors import LutError
from crfnet.luts.cube import read_cube, write_cube
from crfnet.luts.lut1d import Lut1D

LUT = Lut1D([-0.1, 0.0, 1e-7, 1.25], domain=(-0.125, 1.125), comments=("photo: a.jpg", "model: crf é"))
TEXT = """\
# photo: a.jpg
# model: crf é
LUT_1D_SIZE 4
DOMAIN_MIN -0.125 -0.125 -0.125
DOMAIN_MAX 1.125 1.125 1.125
-0.100000001 -0.100000001 -0.100000001
0 0 0
1.00000001e-07 1.00000001e-07 1.00000001e-07
1.25 1.25 1.25
"""
HEAD = "LUT_1D_SIZE 3\n"
ROWS = "0 0 0\n0.5 0.5 0.5\n1 1 1\n"


def test_the_text_is_the_expected_one(tmp_path):
    write_cube(tmp_path / "a.cube", LUT)
    assert (tmp_path / "a.cube").read_bytes() == TEXT.encode()
    assert [path.name for path in tmp_path.iterdir()] == ["a.cube"]


def test_the_usual_domain_is_left_out(tmp_path):
    write_cube(tmp_path / "a.cube", Lut1D([0, 1]))
    assert (tmp_path / "a.cube").read_text() == "LUT_1D_SIZE 2\n0 0 0\n1 1 1\n"


def test_the_text_is_read_back(tmp_path):
    (tmp_path / "a.cube").write_text(TEXT, encoding="utf-8")
    assert read_cube(tmp_path / "a.cube") == LUT


def test_what_resolve_writes_is_read(tmp_path):
    (tmp_path / "a.cube").write_bytes(b"LUT_1D_SIZE 2\r\nLUT_1D_INPUT_RANGE -0.5 1.5\r\n\r\n0 0 0\r\n1 1 1\r\n")
    assert read_cube(tmp_path / "a.cube") == Lut1D([0, 1], domain=(-0.5, 1.5))


def test_a_title_becomes_the_first_comment(tmp_path):
    (tmp_path / "a.cube").write_text('# by hand\nTITLE "My camera"\n' + HEAD + ROWS)
    assert read_cube(tmp_path / "a.cube").comments == ("My camera", "by hand")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("no LUT at all", "has no line LUT_1D_SIZE"),
        (ROWS, "has no line LUT_1D_SIZE"),
        ("LUT_3D_SIZE 2\n" + ROWS, "line 1: is a 3D LUT"),
        (HEAD, "holds 0 entries and announces 3"),
        (HEAD + "0 0 0\n1 1 1\n", "holds 2 entries and announces 3"),
        ("LUT_1D_SIZE\n" + ROWS, r"line 1: found 0 number\(s\), needed 1"),
        ("LUT_1D_SIZE many\n" + ROWS, "line 1: 'many' is no number"),
        (HEAD + "0 0 0\n0,5 0,5 0,5\n1 1 1\n", "line 3: '0,5' is no number; decimals need a point, not a comma"),
        (HEAD + "0 0 0\nnan nan nan\n1 1 1\n", "line 3: nan is not finite"),
        (HEAD + "0 0 0\n1 1 1\ninf inf inf\n", "line 4: inf is not finite"),
        (HEAD + "0\n0.5\n1\n", r"line 2: found 1 number\(s\), needed 3"),
        (HEAD + "0 0 0\n1 1 1\n1 1 1\n", "line 4: 1 is not above the value before it"),
        ("DOMAIN_MIN 0 0 0.1\n" + HEAD + ROWS, "line 1: the domains of R, G and B differ"),
        ("DOMAIN_MAX 1\n" + HEAD + ROWS, r"line 1: found 1 number\(s\), needed 3"),
        ("DOMAIN_MIN 2 2 2\n" + HEAD + ROWS, "finite domain from low to high, found 2 to 1"),
        ("LUT_1D_INPUT_RANGE 0\n" + HEAD + ROWS, r"line 1: found 1 number\(s\), needed 2"),
    ],
)
def test_what_is_no_lut_gets_one_line_that_names_it(tmp_path, text, message):
    path = tmp_path / "bad.cube"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LutError, match=message) as caught:
        read_cube(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
