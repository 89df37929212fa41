"""The posterior in one word: usable, or not to be trusted."""

from enum import StrEnum
from typing import Self

from crfnet_core.posterior.families import is_unusual
from crfnet_core.posterior.posterior import Posterior

USABLE_STOPS = 0.3  # the largest expected shape error, in stops, of a usable answer


class Verdict(StrEnum):
    """Whether an answer may be used. There are no grades: expected errors hardly rank photographs of real cameras."""

    USABLE = "usable"
    DO_NOT_TRUST = "do not trust"

    @classmethod
    def from_posterior(cls, posterior: Posterior) -> Self:
        """Return the verdict on the answer of a posterior."""
        if is_unusual(posterior.families):
            return cls.DO_NOT_TRUST
        return cls.from_shape_error(posterior.expected_shape_error)

    @classmethod
    def from_shape_error(cls, stops: float) -> Self:
        """Return the verdict on an answer by its expected shape error."""
        return cls.DO_NOT_TRUST if stops > USABLE_STOPS else cls.USABLE
