"""Prior times evidence in logarithms, so that no evidence is too strong to be a number: Eq. 22 and 24."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from crfnet_core.posterior.evidence import Evidence
from crfnet_core.posterior.families import UNUSUAL, Family
from crfnet_core.posterior.prior import Prior
from crfnet_core.posterior.responses import ResponseBank
from crfnet_core.types import Float64Array


@dataclass(frozen=True, eq=False)
class LogWeights:
    """Logarithms of the weights of all that may explain photographs; the sum of the weights need not be 1."""

    bank: ResponseBank
    responses: Float64Array  # (N,): of the responses of the bank
    plain: Float64Array  # (11,): of `ResponseBank.plain`
    unexplained: float  # of anything else

    @classmethod
    def from_prior(cls, bank: ResponseBank, prior: Prior) -> Self:
        """Return the weights before a photograph is seen: Eq. 22."""
        responses = np.empty(len(bank.families))
        for family in Family:
            members = bank.members(family)
            if members.any():
                responses[members] = _log(prior.shares.get(family, 0.0) / members.sum())
        count = len(ResponseBank.plain().families)
        plain = np.full(count, _log(prior.plain / count))
        return cls(bank, responses, plain, _log(prior.shares.get(Family.UNEXPLAINED, 0.0)))

    def with_evidence(self, evidences: Sequence[Evidence], prior: Prior, *, independent: float) -> Self:
        """Return the weights after the evidence of photographs, of which this fraction is independent: Eq. 24.

        Among ordinary responses the likelihoods, with the prior's exponent, move weight, whose total stays. Unusual
        families, and all plain responses together, gain on the average ordinary response; among themselves plain
        responses gain by their likelihoods in full.
        """
        likelihoods = independent * np.sum([evidence.log_likelihoods(self.bank) for evidence in evidences], axis=0)
        log_odds = independent * np.sum([evidence.log_odds for evidence in evidences], axis=0)
        before, likelihoods = self.responses[self.bank.ordinary], likelihoods[self.bank.ordinary]
        average = log_sum(before + likelihoods) - log_sum(before)
        gains = dict(zip(UNUSUAL, _bounded(log_odds - average, prior.lookalikes), strict=True))
        moved = before + prior.evidence * likelihoods
        responses = self.responses.copy()
        responses[self.bank.ordinary] = moved + log_sum(before) - log_sum(moved)
        for family, gain in gains.items():
            responses[self.bank.members(family)] += gain
        emor = ResponseBank.plain().weights
        stated = independent * np.sum([evidence.ordinary_log_likelihoods(emor) for evidence in evidences], axis=0)
        mean = log_sum(self.plain + stated) - log_sum(self.plain)
        plain = self.plain + (stated - mean + _bounded(np.array(mean - average), prior.lookalikes))
        unexplained = self.unexplained + float(gains[Family.UNEXPLAINED])
        return replace(self, responses=responses, plain=plain, unexplained=unexplained)


def log_sum(logarithms: Float64Array) -> float:
    """Return the logarithm of a sum of numbers, from their logarithms."""
    largest = logarithms.max()
    return float(largest + np.log(np.exp(logarithms - largest).sum()))


def _bounded(log_odds: Float64Array, lookalikes: float) -> Float64Array:
    """Return log odds of unusual families, if a share of ordinary photographs looks to the network as unusual ones do.

    Such photographs add to the likelihood of ordinary responses: the odds x become x / (1 - lookalikes + lookalikes x).
    """
    return log_odds - np.logaddexp(np.log1p(-lookalikes), _log(lookalikes) + log_odds)


def _log(share: float) -> float:
    """Return the logarithm of a share; for 0 it is so low that no evidence brings it back."""
    return float(np.log(max(share, 1e-300)))
