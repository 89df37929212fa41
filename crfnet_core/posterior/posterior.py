"""The posterior: a probability of every response of the bank; the answer, its expected errors and its band."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from crfnet_core.posterior.evidence import Evidence
from crfnet_core.posterior.families import Family
from crfnet_core.posterior.log_weights import LogWeights, log_sum
from crfnet_core.posterior.prior import Prior
from crfnet_core.posterior.responses import BAND_SAMPLES, SHAPE_SAMPLES, ResponseBank
from crfnet_core.response.curve import SAMPLES, UNIFORM, ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import estimation_error
from crfnet_core.types import Float32Array, Float64Array

BAND = 0.9  # the fraction of the posterior that the band holds at every irradiance
ROWS = 64  # responses of the bank that are weighed at a time: in double precision, these fit into a core's cache


@dataclass(frozen=True, eq=False)
class Posterior:
    """Weights over a bank of responses."""

    bank: ResponseBank
    weights: Float64Array  # (N,): the probability of each response, given that one of them is right; their sum is 1
    unexplained: float  # the probability that none of them is, plain responses included
    prior: Prior | None  # the knowledge before photographs were seen; None if there were none
    #: (11,): the probability of each of `ResponseBank.plain`, given that one of these or of the bank is right. They
    #: count in the expected errors and the band, and among the unexplained, and never in the answer.
    plain: Float64Array
    network_answer: Float64Array | None  # (11,): the network's own answer in EMoR weights; None of evidence on fewer

    @classmethod
    def from_evidences(
        cls, bank: ResponseBank, prior: Prior, evidences: Sequence[Evidence] = (), *, independent: float = 1.0
    ) -> Self:
        """Return prior times evidence, one of each photograph, without which it is the prior: Eq. 24 of docs/METHOD.md.

        `independent` is the fraction of the evidence that is independent, in (0, 1]: see `independent_fraction`.
        """
        logs = LogWeights.from_prior(bank, prior)
        if evidences:
            logs = logs.with_evidence(evidences, prior, independent=independent)
        explained, plain = log_sum(logs.responses), log_sum(logs.plain)
        answers = [evidence.location for evidence in evidences if evidence.is_answer]
        return cls(
            bank=bank,
            weights=np.exp(logs.responses - explained),
            unexplained=float(1 / (1 + np.exp(min(explained - np.logaddexp(logs.unexplained, plain), 700.0)))),
            prior=prior if evidences else None,
            plain=np.exp(logs.plain - np.logaddexp(explained, plain)) if prior.plain else np.zeros(len(logs.plain)),
            network_answer=np.mean(answers, axis=0) if answers else None,
        )

    @cached_property
    def families(self) -> dict[Family, float]:
        """The probability of every family; their sum is 1."""
        explained = {family: float(self.weights[self.bank.members(family)].sum()) for family in Family}
        shares = {family: share * (1 - self.unexplained) for family, share in explained.items()}
        return shares | {Family.UNEXPLAINED: self.unexplained}

    @cached_property
    def curve(self) -> ResponseCurve:
        """The answer: the response whose inverse is the geometric mean of the inverses, weighted: Eq. 25.

        The network's own answer, if it has one, stands in its place, projected by Eq. 26 and 27.

        Linear and log members count only if no other does: no answer lies between them and the others in the
        middle, and where they win, the answer is not to be trusted anyway.
        """
        if self.network_answer is not None:
            return ResponseCurve.from_samples(EmorBasis.load().reconstruct(self.network_answer))
        ordinary = np.where(self.bank.ordinary, self.weights, 0)
        weights = ordinary / ordinary.sum() if ordinary.any() else self.weights
        irradiance = np.exp2(_weighed(weights, self.bank.log_irradiance, lambda rows: rows))
        irradiance = (irradiance - irradiance[0]) / (irradiance[-1] - irradiance[0])
        return ResponseCurve.from_samples(np.interp(UNIFORM, np.maximum.accumulate(irradiance), UNIFORM))

    @cached_property
    def expected_error(self) -> float:
        """The expected E_est of the answer: Eq. 28 of docs/METHOD.md."""
        answer = self.curve.brightness
        spread = self._expected(lambda bank: bank.brightness, lambda rows: np.linalg.norm(rows - answer, axis=1))
        if self.prior is None or self.prior.evidence in (0, 1) or self.network_answer is not None:
            return spread
        moved = estimation_error(Posterior.from_evidences(self.bank, self.prior).curve, self.curve)
        doubt = (1 - self.prior.evidence) / 2
        return (1 - doubt) * spread + doubt * (1 / self.prior.evidence - 1) * moved

    @cached_property
    def expected_shape_error(self) -> float:
        """The expected shape error of the answer, in stops: Eq. 28 of docs/METHOD.md."""
        answer = np.log2(self.curve.inverse(UNIFORM[SHAPE_SAMPLES]))
        return self._expected(
            lambda bank: bank.log_irradiance[:, SHAPE_SAMPLES], lambda rows: (rows - answer).std(axis=1)
        )

    def _expected(
        self, samples: Callable[[ResponseBank], Float32Array], error: Callable[[Float64Array], Float64Array]
    ) -> float:
        """Return the expected error of the answer; `error` of samples of responses, one row each."""
        usual, plain = samples(self.bank), samples(ResponseBank.plain())
        return float((1 - self.plain.sum()) * _weighed(self.weights, usual, error) + _weighed(self.plain, plain, error))

    @cached_property
    def mean_weights(self) -> Float64Array:
        """The mean EMoR weights, or the network's own answer, shape (11,)."""
        return self.weights @ self.bank.weights if self.network_answer is None else self.network_answer

    @cached_property
    def expected_distance(self) -> float:
        """The expected distance of the EMoR weights from their mean: about the expected E_est, at less cost."""
        return float(self.weights @ np.linalg.norm(self.bank.weights - self.mean_weights, axis=1))

    def band(self) -> Float64Array:
        """Return the band that holds `BAND` at every irradiance, lower and upper end, shape (2, 1024): Eq. 29."""
        bank, weights = self.bank, self.weights
        if self.plain.any():
            bank, weights = bank.with_plain, np.concatenate([(1 - self.plain.sum()) * weights, self.plain])
        order, ordered = bank.ordered
        weights = weights[order]
        cumulative = np.cumsum(weights, axis=1) - weights / 2
        levels = ((1 - BAND) / 2, (1 + BAND) / 2)
        ends = [[np.interp(level, *knot) for knot in zip(cumulative, ordered, strict=True)] for level in levels]
        return np.stack([np.interp(np.arange(SAMPLES), BAND_SAMPLES, end) for end in ends])


def _weighed(
    weights: Float64Array, responses: Float32Array, function: Callable[[Float64Array], Float64Array]
) -> Float64Array:
    """Return weights @ function(responses), computed on some rows at a time in double precision."""
    starts = range(0, len(weights), ROWS)
    parts = ((weights[start : start + ROWS], responses[start : start + ROWS].astype(np.float64)) for start in starts)
    return np.asarray(sum(some @ function(rows) for some, rows in parts))
