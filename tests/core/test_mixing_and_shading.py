import numpy as np
import pytest

from crfnet_core.statistics.candidates import CANDIDATE_COUNT, SECOND_WEIGHTS, candidate_responses
from crfnet_core.statistics.mixing import LEVEL_BANDS, disagreement_sums, mixing_sums
from crfnet_core.statistics.sampling import Mixtures
from crfnet_core.statistics.shading import LITTLE, MUCH, Pairs, shading_sums

RESPONSES = candidate_responses()

#: Candidates whose inverse is far from linear, in both directions.
TRUE = [1 * len(SECOND_WEIGHTS) + 1, 6 * len(SECOND_WEIGHTS) + 2]


def recorded(light, candidate):
    """Return the codes of light in [0, 1] under a candidate's response."""
    brightness = np.interp(light, RESPONSES.irradiance[:, candidate], np.linspace(0, 1, 256))
    return np.rint(brightness * 255).astype(np.uint8)


def edges(candidate, *, isolated=True):
    """Return five samples across edges between random colors, each mixed in one ratio, of 3 channels, (3, 4000)."""
    rng = np.random.default_rng(1)
    a, c = rng.uniform(0, 1, (2, 3, 4000))
    b = a + rng.uniform(0, 1, 4000) * (c - a)
    around = (a, c) if isolated else rng.uniform(0, 1, (2, 3, 4000))
    return tuple(recorded(light, candidate) for light in (around[0], a, b, c, around[1]))


def test_candidates_are_inverse_responses():
    assert RESPONSES.irradiance.shape == RESPONSES.slope.shape == (256, CANDIDATE_COUNT)
    np.testing.assert_array_equal(RESPONSES.irradiance[[0, -1]], np.repeat([[0.0], [1.0]], CANDIDATE_COUNT, axis=1))
    assert (np.diff(RESPONSES.irradiance, axis=0) > 0).all()
    assert np.isfinite(RESPONSES.log_slope).all()
    assert np.isfinite(RESPONSES.log_irradiance).all()


@pytest.mark.parametrize("true", TRUE)
def test_mixing_ratios_are_even_under_the_true_response(true):
    sums, counts = mixing_sums(Mixtures.among(edges(true)))
    assert (counts > 500).all()
    log_density, ratio, squared = sums[-1] / counts[-1]
    assert log_density.argmax() == true
    assert abs(ratio[true]) < 0.02
    assert squared[true] == pytest.approx(1 / 12, abs=0.01)
    assert np.abs(ratio).max() > 0.07


@pytest.mark.parametrize("true", TRUE)
def test_channels_agree_on_mixing_ratios_under_the_true_response(true):
    sums, counts = disagreement_sums(Mixtures.among(edges(true)))
    assert (counts.sum(axis=1) > 500).all()
    assert sums.sum(axis=1).argmin(axis=1).tolist() == [true, true]


def test_bands_part_what_is_compared_by_level():
    dim = tuple(side // 4 for side in edges(TRUE[1]))
    counts = disagreement_sums(Mixtures.among(dim))[1]
    assert counts.shape == (2, LEVEL_BANDS, 1)
    assert counts[0, 0] > 0
    assert not counts[:, 1:].any()


def test_only_isolated_mixtures_count_as_such():
    mixtures = Mixtures.among(edges(TRUE[0], isolated=False))
    assert mixing_sums(mixtures)[1][2] < 0.1 * mixing_sums(mixtures)[1][0]
    compared = disagreement_sums(mixtures)[1].sum(axis=1)
    assert compared[1] < 0.5 * compared[0]


@pytest.mark.parametrize("true", TRUE)
@pytest.mark.parametrize(("change", "least", "most"), [(LITTLE, 0.85, 1.15), (MUCH, 0.4, 1.2)])
def test_shading_agrees_under_the_true_response(true, change, least, most):
    rng = np.random.default_rng(2)
    light = rng.uniform(0.05, 0.8, (3, 20_000))
    shaded = light * rng.uniform(least, most, 20_000)
    sums, count = shading_sums(Pairs.among((recorded(light, true), recorded(shaded, true))), change)
    assert count[0] > 500
    assert sums[true] < np.quantile(sums, 0.2)
