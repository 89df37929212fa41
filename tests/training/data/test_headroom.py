import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from crfnet_core.metrics import shape_error
from crfnet_core.response import ResponseCurve
from training.data.headroom import SHOULDER, with_headroom

UNIFORM = np.linspace(0, 1, 1024)


@pytest.mark.parametrize("stops", [0.0, 0.5, 1.0, -0.1])
def test_headroom_divides_the_irradiance_below_the_shoulder_and_keeps_white(stops):
    curve = ResponseCurve.from_samples(1 - (1 - UNIFORM**0.6) ** 2)
    found = with_headroom(curve, stops)
    below = np.array([0.3, 0.5, 0.9])
    np.testing.assert_allclose(found.inverse(below), curve.inverse(below) / 2**stops, rtol=0.01)
    assert found.inverse(1.0) == pytest.approx(1)
    assert (np.diff(found.inverse(np.linspace(SHOULDER, 1, 20))) > 0).all()
    assert shape_error(curve, found) < 0.01
