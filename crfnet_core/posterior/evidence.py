"""The evidence of a photograph: the likelihood of each response, as the network reads it."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.posterior.families import UNUSUAL
from crfnet_core.posterior.responses import ResponseBank
from crfnet_core.response.emor import COMPONENTS
from crfnet_core.types import Float64Array

#: EMoR weights that evidence is about: the others hardly change a photograph. Evidence may be about all 11, too.
EVIDENCE_WEIGHTS = 5

#: Degrees of freedom of the evidence: tails heavier than a Gaussian's, so that no photograph outvotes everything else.
DEGREES_OF_FREEDOM = 5.0


@dataclass(frozen=True, eq=False)
class Evidence:
    """A likelihood of responses, up to a factor.

    Of ordinary responses it is Student's t in their first K EMoR weights, 5 or 11. Of the families `UNUSUAL`, whose
    pictures show more than their curve, it is one number for all members.
    """

    location: Float64Array  # (K,): the EMoR weights that explain the photograph best
    factor: Float64Array  # (K, K): a factor of the precision matrix P = factor @ factor.T
    #: Shape (3,): logarithms of the likelihoods of the families `UNUSUAL`, relative to an ordinary response at
    #: `location`.
    log_odds: Float64Array

    @property
    def is_answer(self) -> bool:
        """Whether the location is a whole response: all 11 weights. It is the answer then, as in the CRF-net paper."""
        return len(self.location) == COMPONENTS

    def log_likelihoods(self, bank: ResponseBank) -> Float64Array:
        """Return the log likelihood of every response of a bank, shape (N,): Eq. 18 of docs/METHOD.md."""
        likelihoods = self.ordinary_log_likelihoods(bank.weights)
        for family, log_odds in zip(UNUSUAL, self.log_odds, strict=True):
            likelihoods[bank.members(family)] = log_odds
        return likelihoods

    def ordinary_log_likelihoods(self, weights: Float64Array) -> Float64Array:
        """Return the log likelihoods, shape (N,), of ordinary responses with these EMoR weights, shape (N, 11)."""
        offsets = (weights[:, : len(self.location)] - self.location) @ self.factor
        squares = np.sum(offsets**2, axis=1)
        exponent = (DEGREES_OF_FREEDOM + len(self.location)) / 2
        return np.asarray(-exponent * np.log1p(squares / DEGREES_OF_FREEDOM))


def independent_fraction(similarities: Float64Array) -> float:
    """Return the independent fraction of the photographs' evidence: Eq. 23 of docs/METHOD.md.

    Photographs of one scene repeat each other's errors. With similarities r between 0 and 1, shape (n, n), n
    photographs count as n^2 / sum(r) independent ones: n if all differ, one if all are alike.
    """
    return float(len(similarities) / np.sum(similarities))
