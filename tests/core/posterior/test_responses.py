import numpy as np

from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import UNIFORM
from tests.helpers.posteriors import SMALL_BANK


def test_the_packaged_responses_rise_from_0_to_1():
    bank = ResponseBank.load()
    assert bank.brightness.dtype == np.float32
    assert bank.brightness.shape == (len(bank.families), 1024)
    assert (np.diff(bank.brightness, axis=1) >= 0).all()
    assert (bank.brightness[:, -1] == 1).all()
    assert (bank.brightness[:, 0] >= 0).all()
    assert len(np.unique(bank.brightness, axis=0)) > 0.98 * len(bank.families)


def test_weights_and_logarithms_are_those_of_the_curves(bank):
    powers = np.array([power for family in SMALL_BANK.values() for power in family])
    assert bank.weights.shape == (10, 11)
    assert bank.log_irradiance.shape == (10, 1024)
    codes = UNIFORM[400:]
    np.testing.assert_allclose(bank.log_irradiance[:, 400:], np.log2(codes) / powers[:, None], atol=2e-2)
    assert (bank.log_irradiance >= -16).all()
