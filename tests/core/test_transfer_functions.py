"""The transfer functions of standards, judged by colour-science."""

import numpy as np
import pytest

from crfnet_core.response.transfer_functions import rec709_encode, srgb_encode

colour = pytest.importorskip("colour")
LIGHT = np.linspace(0, 1, 4096)


def test_they_are_the_functions_of_the_standards(tolerance):
    np.testing.assert_allclose(srgb_encode(LIGHT), colour.models.eotf_inverse_sRGB(LIGHT), atol=tolerance.exact)
    np.testing.assert_allclose(rec709_encode(LIGHT), colour.models.oetf_BT709(LIGHT), atol=tolerance.exact)
