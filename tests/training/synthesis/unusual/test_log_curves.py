import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

from crfnet_core.photograph.recognition import LOG_CURVES
from training.synthesis.unusual import log_curves
from training.synthesis.unusual.log_curves import TRAINING_CURVES


def test_training_draws_from_the_curves_that_are_recognized():
    assert log_curves() == {name: LOG_CURVES[name] for name in TRAINING_CURVES}


@pytest.mark.parametrize("name", TRAINING_CURVES)
def test_the_curve_rises_from_a_lifted_black(name):
    codes = log_curves()[name](np.linspace(-0.005, 60, 20_000))
    assert (np.diff(codes) > 0).all()
    assert 0.08 < log_curves()[name](0.0) < 0.16
