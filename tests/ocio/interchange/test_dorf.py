"""The text of DoRF."""

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.interchange.files import read_response, write_response
from crfnet.luts.lut1d import inverse_response_lut

GRID = np.linspace(0, 1, 1024)


def row(values):
    return " ".join(f"{value:.6e}" for value in values)


def curve(name, exponent, key="I"):
    return f"{name}\ngraph\n{key} = \n{row(GRID)}\nB = \n{row(GRID ** (1 / exponent))}\n"


def test_what_is_written_is_read_back(tmp_path, true_response):
    write_response(tmp_path / "a.txt", inverse_response_lut(true_response))
    found = read_response(tmp_path / "a.txt")
    assert found.words == "DoRF curve a, one table, from light to code values"
    codes = np.linspace(0, 1, 256)
    assert np.abs(found.lut.apply(codes) - true_response.inverse(codes)).max() < 1e-4


def test_training_reads_what_is_written(tmp_path, true_response):
    dorf = pytest.importorskip("training.data.dorf", reason="needs the extra train", exc_type=ImportError)
    write_response(tmp_path / "a.txt", inverse_response_lut(true_response))
    (found,) = dorf.parse_dorf((tmp_path / "a.txt").read_text())
    assert np.abs(found.resampled() - true_response.brightness).max() < 2e-4


def test_channels_become_three_curves(tmp_path, rgb_lut):
    write_response(tmp_path / "a.txt", rgb_lut)
    for name, channel in zip("RGB", rgb_lut.channels, strict=True):
        found = read_response(tmp_path / "a.txt", curve=f"a {name}")
        assert np.abs(found.lut.values - channel.values).max() < 2e-3  # the first of 1023 pieces of a power function


@pytest.mark.parametrize("key", ["I", "E"])
def test_one_of_several_is_chosen_by_name_or_number(tmp_path, key):
    (tmp_path / "a.txt").write_text(curve("Film one", 2.2, key) + curve("Film two", 1.8, key))
    for name in ("Film two", "2"):
        found = read_response(tmp_path / "a.txt", curve=name)
        assert found.lut.apply(np.array([0.5])) == pytest.approx(0.5**1.8, abs=1e-4)
        assert found.source == "DoRF curve Film two"
    with pytest.raises(LutError, match=r"holds 2 curves \(Film one, Film two\); name one: crfnet convert a.txt"):
        read_response(tmp_path / "a.txt")
    with pytest.raises(LutError, match=r"has no curve '3' \(Film one, Film two\)"):
        read_response(tmp_path / "a.txt", curve="3")


def test_inverse_responses_are_told_by_their_headings(tmp_path):
    text = f"inverse\ngraph\nB =\n{row(GRID)}\nI =\n{row(GRID**2.2)}\n"
    (tmp_path / "a.txt").write_text(text)
    assert read_response(tmp_path / "a.txt").lut.apply(np.array([0.5])) == pytest.approx(0.5**2.2, abs=1e-4)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hello\n", "holds no curve of DoRF"),
        ("name\ngraph\nI =\n0 1\n", "holds no curve of DoRF"),
        ("name\ngraph\nI =\n0 1\nB =\n0 0.5 1\n", "line 1: the curve 'name' needs as many irradiances as brightnesses"),
        ("name\ngraph\nI =\n0 x\nB =\n0 1\n", "line 4: 'x' is no number"),
        ("name\ngraph\nI =\n0 1\nB =\n1 0\n", "a response must be brighter at full irradiance"),
        ("name\ngraph\nI =\n1 1\nB =\n0 1\n", "line 1: the irradiances of 'name' are all the same"),
    ],
)
def test_what_is_no_response_is_refused(tmp_path, text, message):
    (tmp_path / "a.txt").write_text(text)
    with pytest.raises(LutError, match=message):
        read_response(tmp_path / "a.txt")
