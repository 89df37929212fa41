"""The loss (docs/METHOD.md, Eq. 19): the posterior of the truth among other responses, and the error of its mean."""

import torch
from torch import Tensor

from crfnet_core.posterior.evidence import DEGREES_OF_FREEDOM, EVIDENCE_WEIGHTS
from training.network.model import EvidenceTensors

#: Weight of the loss of single windows relative to photographs, and of the error of the posterior's mean
#: relative to the negative logarithm of its density.
WINDOW_WEIGHT, ERROR_WEIGHT = 0.3, 0.5

#: The number of the families of ordinary responses; the others' evidence is one number each.
ORDINARY = 0


class EvidenceLoss:
    """How probable evidence makes the truth among responses of training photographs, which are the prior of training.

    They have EMoR weights (M, 11) and families, int (M,): 0 of an ordinary response, else 1 + its position in
    `UNUSUAL`. Evidence is the factor between this prior and the posterior, so the prior can be replaced afterwards.
    """

    def __init__(self, weights: Tensor, families: Tensor) -> None:
        self.weights, self.families = weights, families
        self.is_ordinary = families == ORDINARY

    def __call__(
        self, evidence: tuple[EvidenceTensors, EvidenceTensors], present: Tensor, weights: Tensor, families: Tensor
    ) -> Tensor:
        """Return the loss of the outputs of `training.network.model.PhotographNet`.

        `evidence` is that of the windows, (B, K, ...), and that of the photographs, (B, ...); windows count where
        `present`, bool (B, K), is true. The truth is in `weights`, (B, 11), and `families`, (B,).
        """
        windows, photographs = evidence
        repeated = torch.arange(len(weights)).repeat_interleave(present.sum(1))
        of_windows = self.of_each(
            (windows[0][present], windows[1][present], windows[2][present]), weights[repeated], families[repeated]
        )
        return self.of_each(photographs, weights, families).mean() + WINDOW_WEIGHT * of_windows.mean()

    def of_each(self, evidence: EvidenceTensors, weights: Tensor, families: Tensor) -> Tensor:
        """Return the loss of evidence of N windows or photographs, shape (N,)."""
        scores = self.scores(evidence)  # (N, M)
        of_truth = log_likelihoods(evidence, weights[:, None], families[:, None]).squeeze(1)
        normalization = torch.logsumexp(torch.cat([scores, of_truth[:, None]], dim=1), dim=1)
        negative_log = normalization - of_truth - torch.log(torch.tensor(float(scores.shape[1])))
        return negative_log + ERROR_WEIGHT * self.errors(scores, weights) * (families == ORDINARY)

    def scores(self, evidence: EvidenceTensors) -> Tensor:
        """Return the log likelihood of every response that the truth competes with, shape (N, M)."""
        return log_likelihoods(evidence, self.weights[None], self.families[None])

    def errors(self, scores: Tensor, weights: Tensor) -> Tensor:
        """Return the distance between the posterior's mean and the truth, shape (N,), in units of E_est."""
        posterior = scores.masked_fill(~self.is_ordinary, -torch.inf).softmax(1)
        return ((posterior @ self.weights - weights) ** 2).sum(1).add(1e-6).sqrt()


def log_likelihoods(evidence: EvidenceTensors, weights: Tensor, families: Tensor) -> Tensor:
    """Return the log likelihoods, (N, M), of M responses under the evidence of N windows or photographs.

    The responses have EMoR weights (1 or N, M, 11) and families (1 or N, M), as in `EvidenceLoss`. In numpy,
    `Evidence.log_likelihoods` computes the same.
    """
    location, factor, log_odds = evidence
    turned = weights[..., :EVIDENCE_WEIGHTS] @ factor  # (N, M, 5)
    squares = ((turned - (location[:, None] @ factor)) ** 2).sum(-1)
    exponent = (DEGREES_OF_FREEDOM + EVIDENCE_WEIGHTS) / 2
    likelihoods = -exponent * torch.log1p(squares / DEGREES_OF_FREEDOM) * (families == ORDINARY)
    odds = torch.cat([torch.zeros_like(log_odds[:, :1]), log_odds], dim=1)  # (N, 4)
    return likelihoods + torch.gather(odds, 1, families.expand(len(odds), -1))
