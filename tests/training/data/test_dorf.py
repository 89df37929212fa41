import numpy as np
import pytest

from crfnet_core.errors import CurveError
from crfnet_core.response.curve import UNIFORM
from training.data.curves import read_dorf
from training.data.dorf import main, parse_dorf


def record(name, irradiance, brightness):
    """Return a curve as the owners write it: six lines, exponents of three digits, three spaces between values."""
    rows = (
        "   ".join(f"{value:.6e}".replace("e-", "e-0").replace("e+", "e+0") for value in v)
        for v in (irradiance, brightness)
    )
    first, second = rows
    return f"{name}\ngraph-log-log-neg\nI = \n{first}\nB = \n{second}\n"


def all_records(last=None):
    """Return 201 curves: power laws, the last of which may be another curve."""
    laws = [record(f"power{n}", UNIFORM, UNIFORM ** (0.3 + n / 200)) for n in range(200)]
    return "\n".join([*laws, last or record("power200", UNIFORM, UNIFORM**1.3)])


def test_training_reads_the_converted_file(tmp_path, capsys):
    source, out = tmp_path / "dorfCurves.txt", tmp_path / "dorf" / "201_CRF_data.mat"
    out.parent.mkdir()
    source.write_text(all_records())
    main([str(source), str(out)])
    assert capsys.readouterr().out == f"{out}: 201 curves\n"
    curves = read_dorf(tmp_path)
    assert curves.shape == (201, 1024)
    np.testing.assert_allclose(curves[[0, 140]], [UNIFORM**0.3, UNIFORM], atol=1e-6)


def test_samples_at_other_irradiances_are_interpolated():
    values = parse_dorf(all_records(record("other", [0, 0.25, 1], [0, 0.75, 1])))[-1]
    np.testing.assert_allclose(values[[0, 33, 682, 1023]], [0, 3 * 33 / 1023, 0.75 + (2 / 3 - 0.25) / 3, 1])


def test_a_text_that_is_cut_short_is_refused():
    with pytest.raises(CurveError, match="1204 lines instead of 201 curves"):
        parse_dorf(all_records("a\nlin\nI =\n0 1\n"))


@pytest.mark.parametrize(
    ("irradiances", "brightnesses", "message"),
    [
        *(("0 0.5 1", "0 1", "two rows of as many numbers"), ("0 1", "0 one", "two rows of as many numbers")),
        *(("0 1", "0 nan", "is not a response"), ("0 0.7 0.6 1", "0 0.2 0.4 1", "is not a response")),
        ("0 0.5 1", "0 0.8 0.9", "is not a response"),
    ],
)
def test_numbers_that_are_no_response_are_refused(irradiances, brightnesses, message):
    with pytest.raises(CurveError, match=f"a: {message}"):
        parse_dorf(all_records(f"a\nlin\nI =\n{irradiances}\nB =\n{brightnesses}\n"))
