import math

import numpy as np
import pytest

from crfnet_core.photograph.thumbnail import scene_similarities
from crfnet_core.posterior import UNUSUAL, Evidence, Family, ResponseBank, independent_fraction
from crfnet_core.response.curve import UNIFORM
from tests.helpers.posteriors import SMALL_BANK


def test_likelihoods_are_student_s_t_or_the_odds_that_are_stated_for_a_family(bank):
    """By hand, one response after the other: the precision is the factor times its transpose."""
    rng = np.random.default_rng(3)
    location, factor = rng.normal(0, 1, 5), np.tril(rng.normal(0, 1, (5, 5)))
    found = Evidence(location, factor, np.array([-1.0, -2.0, -3.0])).log_likelihoods(bank)
    assert (found[bank.members(Family.LINEAR)] == -1).all()
    assert (found[bank.members(Family.LOG)] == -2).all()
    precision = factor @ factor.T
    for number, family in enumerate(bank.families):
        if family in UNUSUAL:
            continue
        offset = bank.weights[number, :5] - location
        square = sum(offset[i] * precision[i, j] * offset[j] for i in range(5) for j in range(5))
        assert found[number] == pytest.approx(-5 * math.log(1 + square / 5))


@pytest.mark.parametrize("count", [1, 2, 5])
def test_photographs_of_one_scene_count_as_one_and_different_ones_each(count):
    assert independent_fraction(np.ones((count, count))) * count == pytest.approx(1)
    assert independent_fraction(np.eye(count)) * count == pytest.approx(count)


def test_scenes_are_recognized_by_the_order_of_their_brightness_and_flat_ones_not_at_all():
    rng = np.random.default_rng(0)
    first, second = (rng.permutation(256).reshape(16, 16).astype(float) for _ in range(2))
    found = scene_similarities([first, 2 * first + 1, second, 255 - first])
    assert found[0, 1] == pytest.approx(1)
    assert abs(found[0, 2]) < 0.3
    assert found[0, 3] == 0
    np.testing.assert_allclose(found, found.T)
    assert (np.diag(found) == 1).all()
    np.testing.assert_array_equal(scene_similarities([np.ones((16, 16))] * 2), np.eye(2))


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
    assert (bank.weights.shape, bank.log_irradiance.shape) == ((10, 11), (10, 1024))
    codes = UNIFORM[400:]
    np.testing.assert_allclose(bank.log_irradiance[:, 400:], np.log2(codes) / powers[:, None], atol=2e-2)
    assert (bank.log_irradiance >= -16).all()
