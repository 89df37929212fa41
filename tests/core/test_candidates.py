import numpy as np
import pytest

from crfnet_core.candidates import CANDIDATES, SECOND_WEIGHTS, CandidateTables, mixing_sums, shading_sums

TABLES = CandidateTables.load()

#: Candidates whose inverse is far from linear, in both directions.
TRUE = [1 * len(SECOND_WEIGHTS) + 1, 4 * len(SECOND_WEIGHTS) + 1, 6 * len(SECOND_WEIGHTS) + 2]


def recorded(light, candidate):
    """Return the codes of light in [0, 1] under a candidate's response."""
    brightness = np.interp(light, TABLES.irradiance[:, candidate], np.linspace(0, 1, 256))
    return np.rint(brightness * 255).astype(np.uint8)


def edges(candidate, *, isolated=True):
    """Return five samples across edges between random colours, each mixed in one share, of 3 channels, (3, 4000)."""
    rng = np.random.default_rng(1)
    a, c = rng.uniform(0, 1, (2, 3, 4000))
    b = a + rng.uniform(0, 1, 4000) * (c - a)
    around = (a, c) if isolated else rng.uniform(0, 1, (2, 3, 4000))
    return tuple(recorded(light, candidate) for light in (around[0], a, b, c, around[1]))


def test_candidates_are_inverse_responses():
    assert TABLES.irradiance.shape == TABLES.slope.shape == (256, CANDIDATES)
    np.testing.assert_array_equal(TABLES.irradiance[[0, -1]], np.repeat([[0.0], [1.0]], CANDIDATES, axis=1))
    assert (np.diff(TABLES.irradiance, axis=0) > 0).all()
    assert np.isfinite(TABLES.log_slope).all()
    assert np.isfinite(TABLES.log_irradiance).all()


@pytest.mark.parametrize("true", TRUE)
def test_mixtures_agree_under_the_true_response(true):
    sums, numbers = mixing_sums(edges(true))
    assert (numbers[:, 0] > 500).all()
    density, share, squared, disagreement = sums[-1] / numbers[-1, [0, 0, 0, 1]][:, None]
    assert disagreement.argmin() == true
    assert density.argmax() == true
    assert abs(share[true]) < 0.02
    assert squared[true] == pytest.approx(1 / 12, abs=0.01)
    assert np.abs(share).max() > 0.07


def test_only_isolated_mixtures_count_as_such():
    number = mixing_sums(edges(TRUE[0], isolated=False))[1]
    assert number[2, 0] < 0.1 * number[0, 0]


@pytest.mark.parametrize("true", TRUE)
def test_shading_agrees_under_the_true_response(true):
    rng = np.random.default_rng(2)
    light = rng.uniform(0.05, 0.8, (3, 20_000))
    shaded = light * rng.uniform(0.85, 1.15, 20_000)
    sums, number = shading_sums((recorded(light, true), recorded(shaded, true)))
    assert number[0] > 500
    assert sums[true] < np.quantile(sums, 0.2)


def test_a_flat_window_says_nothing():
    flat = np.full((3, 500), 100, np.uint8)
    assert all(not part.any() for part in (*mixing_sums((flat,) * 5), *shading_sums((flat,) * 2)))
