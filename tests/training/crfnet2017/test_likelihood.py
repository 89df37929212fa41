import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.posterior.evidence import DEGREES_OF_FREEDOM
from training.crfnet2017.likelihood import LEAST_SLOPE, fit

SLOPES, INTERCEPTS = np.array([0.8, 0.6, 0.5, 0.4, 0.3]), np.array([0.5, -0.2, 0.1, 0.0, 0.3])


@pytest.fixture(scope="module")
def noise():
    """The covariance of the noise in the answers: the first two weights are correlated."""
    covariance = np.diag([0.5, 0.2, 0.1, 0.05, 0.02])
    covariance[0, 1] = covariance[1, 0] = 0.2
    return covariance


@pytest.fixture(scope="module")
def answers(noise):
    """True weights and answers of a network that is known."""
    rng = np.random.default_rng(0)
    true = rng.normal(0, [3.0, 1.2, 0.7, 0.4, 0.25], (2000, 5))
    return true, SLOPES * true + INTERCEPTS + rng.multivariate_normal(np.zeros(5), noise, 2000)


def test_slopes_offsets_and_covariance_are_found(answers, noise):
    found = fit(*answers)
    np.testing.assert_allclose(found.slopes, SLOPES, atol=0.03)
    np.testing.assert_allclose(found.intercepts, INTERCEPTS, atol=0.05)
    scale = noise * (DEGREES_OF_FREEDOM - 2) / DEGREES_OF_FREEDOM  # Student's t of this scale has this covariance
    of_weights = scale / np.outer(SLOPES, SLOPES)
    np.testing.assert_allclose(np.linalg.inv(found.factor @ found.factor.T), of_weights, rtol=0.15, atol=0.02)


def test_the_odds_are_the_mean_log_likelihood_of_the_responses(answers):
    true, found = (part[:300] for part in answers)
    likelihood = fit(true, found)
    precision = likelihood.factor @ likelihood.factor.T
    logarithms = []
    for location in (found - likelihood.intercepts) / likelihood.slopes:
        offsets = true - location
        squares = np.einsum("ni,ij,nj->n", offsets, precision, offsets)
        logarithms.append(np.log(np.mean((1 + squares / 5) ** -5)))
    assert likelihood.log_odds == pytest.approx(np.mean(logarithms))


def test_an_answer_that_does_not_follow_the_truth_says_next_to_nothing(answers):
    true, found = answers
    found = found.copy()
    found[:, 4] = -0.2 * true[:, 4] + np.random.default_rng(1).normal(0, 0.1, len(true))
    likelihood = fit(true, found)
    assert likelihood.slopes[4] == LEAST_SLOPE
    deviation = np.sqrt(np.linalg.inv(likelihood.factor @ likelihood.factor.T)[4, 4])
    assert deviation > 4 * true[:, 4].std()
