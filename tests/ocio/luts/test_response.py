import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.luts.files import WRITERS, write_lut
from crfnet.luts.forward import forward_lut
from crfnet.luts.lut1d import Lut1D, inverse_response_lut
from crfnet.luts.response import read_response, response_of_lut
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.refusals import refusal_of

GRID = np.linspace(0, 1, 4081)


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-0.125, 1.125)])
@pytest.mark.parametrize("length", [4081, 16321])
def test_it_returns_the_response(true_response, length, domain):
    result = response_of_lut(inverse_response_lut(true_response, length=length, domain=domain))
    assert np.abs(result.brightness - true_response.brightness).max() < 2e-4
    assert np.abs(result.inverse(GRID) - true_response.inverse(GRID)).max() < 5e-5


def test_the_scale_of_the_lut_does_not_count():
    lut = inverse_response_lut(ResponseCurve.gamma(2.2))
    scaled = response_of_lut(Lut1D(lut.values * 4))
    assert np.abs(scaled.brightness - response_of_lut(lut).brightness).max() < 1e-6


@pytest.mark.parametrize(
    ("lut", "code"),
    [
        (Lut1D(GRID ** (1 / 2.2)), "lut_brightens"),
        (Lut1D(GRID + 0.1), "lut_black_or_white"),
        (Lut1D(GRID**2.2, domain=(0.1, 1.0)), "lut_domain_short"),
        (RgbLut1D((Lut1D(GRID), Lut1D(GRID), Lut1D(GRID**2))), "lut_channels_differ"),
    ],
)
def test_other_luts_are_refused(lut, code):
    assert refusal_of(LutError, response_of_lut, lut).code == code


@pytest.mark.parametrize("suffix", WRITERS)
class TestFiles:
    def test_an_inverse_response_is_taken_as_it_is(self, tmp_path, suffix, true_response):
        lut = inverse_response_lut(true_response, comments=("mine",))
        write_lut(tmp_path / f"a{suffix}", lut)
        result = read_response(tmp_path / f"a{suffix}")
        assert (result.lut, result.table, result.was_forward) == (lut, lut, False)
        assert result.words == f"LUT of the format {suffix}, one table, from code values to light"

    def test_a_response_is_inverted(self, tmp_path, suffix, true_response):
        write_lut(tmp_path / f"a{suffix}", forward_lut(inverse_response_lut(true_response)))
        result = read_response(tmp_path / f"a{suffix}")
        assert result.was_forward
        assert np.abs(result.lut.apply(GRID) - true_response.inverse(GRID)).max() < 1e-4
        assert result.lut.comments[0].endswith("from light to code values; this is its inverse")


def test_linear_light_is_not_inverted(tmp_path):
    write_lut(tmp_path / "a.cube", Lut1D([0, 1]))
    assert not read_response(tmp_path / "a.cube").was_forward


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("codes", [(0, 255), (-255, 0), (-1, 0.05), (0, 0.5), (0.5, 1), (1.5, 2)])
@pytest.mark.parametrize("forward", [False, True])
def test_a_lut_of_other_codes_than_0_to_1_is_refused(tmp_path, suffix, codes, forward):
    """Parts of a plate would be black or white."""
    low, high = codes
    lut = Lut1D(low + (high - low) * GRID ** (1 / 2.2)) if forward else Lut1D(GRID**2.2, domain=codes)
    write_lut(tmp_path / f"a{suffix}", lut)
    assert refusal_of(LutError, read_response, tmp_path / f"a{suffix}").code == "lut_of_codes"
