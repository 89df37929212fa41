"""The .spi1d format."""

import pytest

from crfnet.errors import LutError
from crfnet.luts.lut1d import Lut1D
from crfnet.luts.spi1d import read_spi1d, write_spi1d

LUT = Lut1D([-0.1, 0.0, 1e-7, 1.25], domain=(-0.125, 1.125), comments=("photo: a.jpg", "model: crf é"))
TEXT = """\
# photo: a.jpg
# model: crf é
Version 1
From -0.125 1.125
Length 4
Components 1
{
  -0.100000001
  0
  1.00000001e-07
  1.25
}
"""
HEAD = "Version 1\nFrom 0 1\nLength 3\nComponents 1\n"


def test_the_text_is_the_expected_one(tmp_path):
    write_spi1d(tmp_path / "a.spi1d", LUT)
    assert (tmp_path / "a.spi1d").read_bytes() == TEXT.encode()
    assert [path.name for path in tmp_path.iterdir()] == ["a.spi1d"]


def test_the_text_is_read_back(tmp_path):
    (tmp_path / "a.spi1d").write_text(TEXT, encoding="utf-8")
    assert read_spi1d(tmp_path / "a.spi1d") == LUT


def test_what_others_write_is_read(tmp_path):
    head = "\ufeff#Café\r\nVersion 1\r\nFROM\t0.0 2.0\r\nComponents 3\r\nLength 2\r\n"
    text = head + "{\r\n\r\n 0 0 0\r\n 1 1 1\r\n}\r\ntrailing\r\n"
    (tmp_path / "a.spi1d").write_bytes(text.encode())
    assert read_spi1d(tmp_path / "a.spi1d") == Lut1D([0, 1], domain=(0, 2), comments=("Café",))


def test_comments_in_older_encodings_do_no_harm(tmp_path):
    (tmp_path / "a.spi1d").write_bytes(TEXT.encode("latin-1"))
    assert (read_spi1d(tmp_path / "a.spi1d").values == LUT.values).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        (" \n\n", "is empty"),
        ("GIF89a, no LUT at all", "no complete block of values"),
        (HEAD, "no complete block of values"),
        (HEAD + "{\n0\n0.5\n", "no complete block of values"),
        (HEAD + "{\n0\n1\n}\n", "holds 2 entries and announces 3"),
        (HEAD + "{\n0\n0.5\n0.7\n1\n}\n", "holds 4 entries and announces 3"),
        (HEAD + "{\n}\n", "holds 0 entries and announces 3"),
        (HEAD + "{\n0\n0,5\n1\n}\n", "line 7: '0,5' is no number; decimals need a point, not a comma"),
        (HEAD + "{\n0\nhalf\n1\n}\n", "line 7: 'half' is no number; the file is damaged"),
        (HEAD + "{\n0\nnan\n1\n}\n", "line 7: nan is not finite"),
        (HEAD + "{\n0\n0.5\ninf\n}\n", "line 8: inf is not finite"),
        (HEAD + "{\n0\n0.5\n1e39\n}\n", "line 8: 1e39 is not finite"),
        (HEAD + "{\n0\n0.5\n0.5\n}\n", "line 8: 0.5 is not above the value before it"),
        (HEAD + "{\n1\n0.5\n0\n}\n", "line 7: 0.5 is not above the value before it"),
        (HEAD + "{\n0\n0.5 0.6\n1\n}\n", r"line 7: found 2 number\(s\), needed 1"),
        (HEAD.replace("Length 3\n", "") + "{\n0\n0.5\n1\n}\n", "has no line 'Length'"),
        (HEAD.replace("From 0 1", "From 0") + "{\n0\n0.5\n1\n}\n", r"line 2: found 1 number\(s\), needed 2"),
        (HEAD.replace("From 0 1", "From 1 0") + "{\n0\n0.5\n1\n}\n", "finite domain from low to high, found 1 to 0"),
        (HEAD.replace("Components 1", "Components 2") + "{\n0 0\n0.5 0.5\n1 1\n}\n", "has 2 channels"),
        (
            HEAD.replace("Components 1", "Components 3") + "{\n0 0 0\n0 1 0\n1 1 1\n}\n",
            "line 7: 0 is not above the value before it",
        ),
    ],
)
def test_what_is_no_lut_gets_one_line_that_names_it(tmp_path, text, message):
    path = tmp_path / "bad.spi1d"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(LutError, match=message) as caught:
        read_spi1d(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
