import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from crfnet_core.errors import CurveError
from training.data.curves import read_dorf
from training.data.dorf import main, parse_dorf

UNIFORM = np.linspace(0, 1, 1024)


def record(name, irradiance, brightness, graph="graph-log-log-neg"):
    """Return a curve as the owners write it: six lines, exponents of three digits, three spaces between values."""
    rows = (
        "   ".join(f"{value:.6e}".replace("e-", "e-0").replace("e+", "e+0") for value in v)
        for v in (irradiance, brightness)
    )
    first, second = rows
    return f"{name}\n{graph}\nI = \n{first}\nB = \n{second}\n"


def all_records(count=201):
    """Return as many power laws."""
    return "".join(record(f"power{n}", UNIFORM, UNIFORM ** (0.3 + n / 200)) for n in range(count))


def test_uniform_samples_are_kept_and_others_resampled():
    same, other = parse_dorf(record("same", UNIFORM, UNIFORM**2) + record("other", [0, 0.25, 1], [0, 0.75, 1]))
    assert same.resampled() is same.brightness
    values = other.resampled()
    assert values.shape == (1024,)
    assert values[[0, 1023]].tolist() == [0, 1]
    assert values[33] == pytest.approx(3 * 33 / 1023)
    assert values[682] == pytest.approx(0.75 + (2 / 3 - 0.25) / 3)


def test_training_reads_the_converted_file(tmp_path, capsys):
    source, out = tmp_path / "dorfCurves.txt", tmp_path / "201_CRF_data.mat"
    source.write_text(all_records())
    assert main([str(source), "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"{out}: 201 curves\n"
    curves = read_dorf(out)
    assert curves.shape == (201, 1024)
    np.testing.assert_allclose(curves[0], UNIFORM**0.3, atol=1e-6)
    np.testing.assert_allclose(curves[140], UNIFORM, atol=1e-6)


def test_a_download_cut_short_is_refused_and_leaves_nothing(tmp_path, capsys):
    source, out = tmp_path / "dorfCurves.txt", tmp_path / "201_CRF_data.mat"
    source.write_text(all_records(3))
    assert main([str(source), "--out", str(out)]) == 2
    expected = f"dorf: error: {source}: holds 3 curves, DoRF has 201; download dorfCurves.txt again\n"
    assert capsys.readouterr().err == expected
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dorfCurves.txt"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<html>not found</html>", "holds no curve"),
        ("a\nlin\nI =\n0 1\n", "the curve 'a' has no line 'B ='"),
        ("a\nlin\nI =\n0 0.5 1\nB =\n0 1\n", "the curve 'a' has 3 irradiances and 2 brightnesses"),
        ("a\nlin\nI =\n0 1\nB =\n0 one\n", "the curve 'a' holds something else than numbers"),
        ("a\nlin\nI =\n0 1\nB =\n0 nan\n", "the curve 'a' has values that are not finite"),
        ("a\nlin\nI =\n0 0.7 0.6 1\nB =\n0 0.2 0.4 1\n", "the curve 'a' is not increasing"),
        ("a\nlin\nI =\n0 0.5 1\nB =\n0 0.8 0.9\n", "the curve 'a' runs from 0 to 0.9 instead of 0 to 1"),
    ],
)
def test_other_texts_are_refused(text, message):
    with pytest.raises(CurveError, match=message):
        parse_dorf(text)


def test_an_existing_output_is_kept(tmp_path):
    out = tmp_path / "201_CRF_data.mat"
    out.write_bytes(b"kept")
    assert main([str(tmp_path / "absent.txt"), "--out", str(out)]) == 2
    assert out.read_bytes() == b"kept"
