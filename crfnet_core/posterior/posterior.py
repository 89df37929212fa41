"""The posterior: prior times evidence over the bank, and what follows from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crfnet_core.posterior.evidence import Evidence
from crfnet_core.posterior.families import STATED_ODDS, Family
from crfnet_core.posterior.prior import Prior
from crfnet_core.posterior.responses import SHAPE_SAMPLES, ResponseBank
from crfnet_core.response import SAMPLES, ResponseCurve
from crfnet_core.types import Float64Array, same_fields

#: The fraction of the posterior that the band holds at every irradiance, and the irradiances at which it is computed.
BAND, BAND_KNOTS = 0.9, 65


@dataclass(frozen=True, eq=False)
class Posterior:
    """Weights over a bank of responses.

    Parameters
    ----------
    bank : ResponseBank
        The responses.
    weights : ndarray, float64, shape (N,)
        The probability of each response, given that one of them is right; their sum is 1.
    unexplained : float
        The probability that none of them is.
    """

    bank: ResponseBank
    weights: Float64Array
    unexplained: float

    def __eq__(self, other: object) -> bool:
        """Return whether every field is equal; like the arrays in it, this cannot be hashed."""
        return same_fields(self, other) if isinstance(other, Posterior) else NotImplemented

    @classmethod
    def of(
        cls, bank: ResponseBank, prior: Prior, evidences: Sequence[Evidence] = (), *, independent: float = 1.0
    ) -> Posterior:
        """Return the posterior: Eq. 24 of docs/METHOD.md.

        Parameters
        ----------
        bank : ResponseBank
            The responses.
        prior : Prior
            Shares of the families.
        evidences : sequence of Evidence
            One of each photograph; without any, this is the prior.
        independent : float
            Fraction of the evidence that is independent, in (0, 1]: see `independent_share`.
        """
        logarithms = _log_prior(bank, prior)
        unexplained = _log(prior.shares.get(Family.UNEXPLAINED, 0.0))
        if evidences:
            likelihoods = independent * np.sum([evidence.log_likelihoods(bank) for evidence in evidences], axis=0)
            log_odds = independent * np.sum([evidence.log_odds for evidence in evidences], axis=0)
            ordinary = bank.ordinary
            before = logarithms[ordinary]
            average = _log_sum(before + likelihoods[ordinary]) - _log_sum(before)
            after = before + prior.evidence * likelihoods[ordinary]
            logarithms[ordinary] = after + _log_sum(before) - _log_sum(after)
            gains = _bounded(log_odds - average, prior.lookalikes)
            for family, gain in zip(STATED_ODDS, gains, strict=True):
                logarithms[bank.of(family)] += gain
            unexplained += float(gains[STATED_ODDS.index(Family.UNEXPLAINED)])
        explained = _log_sum(logarithms)
        weights = np.exp(logarithms - explained)
        return cls(bank, weights, float(1 / (1 + np.exp(min(explained - unexplained, 700.0)))))

    @cached_property
    def families(self) -> dict[Family, float]:
        """The probability of every family; their sum is 1."""
        explained = {family: float(self.weights[self.bank.of(family)].sum()) for family in Family}
        shares = {family: share * (1 - self.unexplained) for family, share in explained.items()}
        return shares | {Family.UNEXPLAINED: self.unexplained}

    @cached_property
    def curve(self) -> ResponseCurve:
        """The answer: the response whose inverse is the geometric mean of the inverses, weighted: Eq. 25.

        Linear and log members count only if no other does: between them and the others there is no answer in the
        middle, and where they win, the answer is not to be trusted anyway.
        """
        ordinary = np.where(self.bank.ordinary, self.weights, 0)
        weights = ordinary / ordinary.sum() if ordinary.any() else self.weights
        irradiance = np.exp2(weights @ self.bank.log_irradiance)
        irradiance = (irradiance - irradiance[0]) / (irradiance[-1] - irradiance[0])
        uniform = np.linspace(0, 1, SAMPLES)
        return ResponseCurve.from_samples(np.interp(uniform, np.maximum.accumulate(irradiance), uniform))

    @cached_property
    def expected_error(self) -> float:
        """The expected E_est of the answer: Eq. 28 of docs/METHOD.md."""
        return float(self.weights @ np.linalg.norm(self.bank.brightness - self.curve.brightness, axis=1))

    @cached_property
    def expected_shape_error(self) -> float:
        """The expected shape error of the answer, in stops."""
        codes = np.linspace(0, 1, SAMPLES)[SHAPE_SAMPLES]
        offsets = self.bank.log_irradiance[:, SHAPE_SAMPLES] - np.log2(self.curve.inverse(codes))
        return float(self.weights @ offsets.std(axis=1))

    @cached_property
    def mean_weights(self) -> Float64Array:
        """The mean EMoR weights, shape (11,)."""
        return self.weights @ self.bank.weights

    @cached_property
    def expected_distance(self) -> float:
        """The expected distance of the EMoR weights from their mean: about the expected E_est, at less cost."""
        return float(self.weights @ np.linalg.norm(self.bank.weights - self.mean_weights, axis=1))

    def band(self) -> Float64Array:
        """Return the band that holds `BAND` at every irradiance, lower and upper end, shape (2, 1024): Eq. 29."""
        knots = np.linspace(0, SAMPLES - 1, BAND_KNOTS).round().astype(int)
        values = self.bank.brightness[:, knots].astype(np.float64)
        order = np.argsort(values, axis=0)
        ordered = np.take_along_axis(values, order, axis=0)
        cumulative = np.cumsum(self.weights[order], axis=0) - self.weights[order] / 2
        levels = ((1 - BAND) / 2, (1 + BAND) / 2)
        ends = [[np.interp(level, cumulative[:, k], ordered[:, k]) for k in range(BAND_KNOTS)] for level in levels]
        uniform = np.arange(SAMPLES)
        return np.stack([np.interp(uniform, knots, end) for end in ends])


def _log_sum(logarithms: Float64Array) -> float:
    """Return the logarithm of a sum of numbers whose logarithms are given."""
    largest = logarithms.max()
    return float(largest + np.log(np.exp(logarithms - largest).sum()))


def _bounded(log_odds: Float64Array, lookalikes: float) -> Float64Array:
    """Return log odds of unusual families, if a share of ordinary photographs looks to the network as unusual ones do.

    Such photographs add to the likelihood of ordinary responses: the odds x become x / (1 - lookalikes + lookalikes x).
    """
    return log_odds - np.logaddexp(np.log1p(-lookalikes), _log(lookalikes) + log_odds)


def _log_prior(bank: ResponseBank, prior: Prior) -> Float64Array:
    """Return the logarithm of every response's probability before a photograph is seen, shape (N,)."""
    logarithms = np.empty(len(bank.families))
    for family in Family:
        members = bank.of(family)
        if members.any():
            logarithms[members] = _log(prior.shares.get(family, 0.0) / members.sum())
    return logarithms


def _log(share: float) -> float:
    """Return the logarithm of a share; that of 0 is so low that no evidence brings it back."""
    return float(np.log(max(share, 1e-300)))
