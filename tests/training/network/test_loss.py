import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.posterior import UNUSUAL, Evidence, Posterior, Prior
from training.network.loss import ERROR_WEIGHT, WINDOW_WEIGHT, EvidenceLoss


@pytest.fixture(scope="module")
def competitors(bank):
    """The responses of the bank as the loss knows them: weights and families."""
    families = [1 + UNUSUAL.index(f) if f in UNUSUAL else 0 for f in bank.families]
    return torch.from_numpy(bank.weights), torch.tensor(families)


def drawn(count, seed=0):
    """Evidence of random photographs, as the core's and as tensors."""
    rng = np.random.default_rng(seed)
    parts = (rng.normal(0, 2, (count, 5)), np.tril(rng.normal(0, 1, (count, 5, 5))), rng.normal(-2, 2, (count, 3)))
    return [Evidence(*row) for row in zip(*parts, strict=True)], tuple(map(torch.from_numpy, parts))


def by_hand(evidence, bank, weights, family):
    """The loss of one photograph: of its evidence, the competing bank, and the truth."""
    scores = evidence.log_likelihoods(bank)
    offset = (weights[:5] - evidence.location) @ evidence.factor
    own = -5 * np.log1p(offset @ offset / 5) if family == 0 else evidence.log_odds[family - 1]
    likelihoods = np.exp(np.append(scores, own))
    loss = -np.log(np.exp(own) / likelihoods.sum()) - np.log(len(scores))
    if family:
        return loss
    ordinary = ~np.isin(bank.families, UNUSUAL)
    posterior = np.exp(scores[ordinary])
    mean = posterior / posterior.sum() @ bank.weights[ordinary]
    return loss + ERROR_WEIGHT * np.sqrt(np.sum((mean - weights) ** 2) + 1e-6)


def test_the_loss_of_photographs_is_that_computed_by_hand(bank, competitors):
    evidences, tensors = drawn(5)
    rng = np.random.default_rng(1)
    weights, families = rng.normal(0, 1, (5, 11)), np.array([0, 0, 1, 2, 3])
    loss = EvidenceLoss(*competitors)
    found = loss.of_each(tensors, torch.from_numpy(weights), torch.from_numpy(families))
    expected = [by_hand(*row) for row in zip(evidences, [bank] * 5, weights, families, strict=True)]
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_windows_that_are_not_present_are_no_part_of_the_loss(competitors):
    _, of_photographs = drawn(2)
    _, of_windows = drawn(6, seed=4)
    weights, families = torch.zeros(2, 11, dtype=torch.float64), torch.tensor([0, 2])
    present = torch.tensor([[True, False, True], [False, False, True]])
    windows = tuple(part.unflatten(0, (2, 3)) for part in of_windows)
    loss = EvidenceLoss(*competitors)
    found = loss((windows, of_photographs), present, weights, families)
    kept = tuple(part[[0, 2, 5]] for part in of_windows)
    single = loss.of_each(kept, weights[[0, 0, 1]], families[[0, 0, 1]])
    assert float(found) == pytest.approx(
        float(loss.of_each(of_photographs, weights, families).mean() + WINDOW_WEIGHT * single.mean())
    )


def test_the_errors_are_those_of_the_core_s_posterior(bank, competitors):
    """The posterior's mean, under a prior that gives every ordinary response the same share."""
    (evidence,), tensors = drawn(1)
    counts = {family: float(bank.members(family).sum()) for family in bank.families if family not in UNUSUAL}
    prior = Prior("p", {family: count / sum(counts.values()) for family, count in counts.items()}, 1.0)
    mean = Posterior.from_evidences(bank, prior, [evidence]).mean_weights
    loss = EvidenceLoss(*competitors)
    found = loss.errors(loss.scores(tensors), torch.zeros(1, 11, dtype=torch.float64))
    assert float(found) == pytest.approx(np.linalg.norm(mean), abs=1e-5)
