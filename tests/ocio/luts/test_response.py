"""A response from the LUT of its inverse."""

import numpy as np
import pytest

from crfnet.errors import LutError
from crfnet.luts.lut1d import Lut1D, inverse_response_lut
from crfnet.luts.response import response_of_lut
from crfnet_core.response.curve import ResponseCurve

GRID = np.linspace(0, 1, 4081)


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-0.125, 1.125)])
@pytest.mark.parametrize("length", [4081, 16321])
def test_it_returns_the_response(true_response, length, domain):
    found = response_of_lut(inverse_response_lut(true_response, length=length, domain=domain))
    assert np.abs(found.brightness - true_response.brightness).max() < 2e-4
    assert np.abs(found.inverse(GRID) - true_response.inverse(GRID)).max() < 5e-5


def test_the_scale_of_the_lut_does_not_count():
    lut = inverse_response_lut(ResponseCurve.gamma(2.2))
    scaled = response_of_lut(Lut1D(lut.values * 4))
    assert np.abs(scaled.brightness - response_of_lut(lut).brightness).max() < 1e-6


@pytest.mark.parametrize(
    ("lut", "message"),
    [
        (Lut1D(GRID ** (1 / 2.2)), "from light to code values"),
        (Lut1D(GRID + 0.1), "of black"),
        (Lut1D(GRID**2.2, domain=(0.1, 1.0)), "needs 0 to 1"),
    ],
)
def test_other_luts_are_refused(lut, message):
    with pytest.raises(LutError, match=message):
        response_of_lut(lut)
