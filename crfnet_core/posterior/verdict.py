"""The posterior in one word: good, usable, or not to be trusted."""

from enum import StrEnum
from typing import Self

from crfnet_core.posterior.families import UNUSUAL
from crfnet_core.posterior.posterior import Posterior

#: Expected shape errors in stops up to which an answer is good, and usable; and the expected E_est of a good one.
GOOD_STOPS, USABLE_STOPS, GOOD_ERROR = 0.11, 0.3, 1.5

#: Probability of the unusual families above which an answer is not to be trusted.
UNUSUAL_LIMIT = 0.5


class Verdict(StrEnum):
    """How far to trust an answer, from the best to the worst."""

    GOOD = "good"
    USABLE = "usable"
    DO_NOT_TRUST = "do not trust"

    @classmethod
    def from_posterior(cls, posterior: Posterior) -> Self:
        """Return the verdict on the answer of a posterior."""
        if sum(posterior.families[family] for family in UNUSUAL) > UNUSUAL_LIMIT:
            return cls.DO_NOT_TRUST
        return cls.from_errors(posterior.expected_shape_error, posterior.expected_error)

    @classmethod
    def from_errors(cls, stops: float, error: float) -> Self:
        """Return the verdict on an answer by its expected shape error in stops and its expected E_est."""
        if stops > USABLE_STOPS:
            return cls.DO_NOT_TRUST
        return cls.GOOD if stops <= GOOD_STOPS and error <= GOOD_ERROR else cls.USABLE
