"""The three errors that are reported, and what is said of them over a set of photographs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

T = TypeVar("T")

#: The errors' names in reports, in the order of `PerError`.
ERROR_NAMES = ("E_est", "E_lin", "shape")

#: The verdict on a difference whose interval contains 0.
TIE = "tie"


@dataclass(frozen=True)
class PerError(Generic[T]):
    """One value for each of the three errors that are reported (definitions: `crfnet_core.response.metrics`).

    Parameters
    ----------
    estimation
        For E_est.
    linearization
        For E_lin, which reports give in hundredths of the peak (x 1e-2).
    shape
        For the shape error, in stops.
    """

    estimation: T
    linearization: T
    shape: T

    def items(self) -> Iterator[tuple[str, T]]:
        """Yield (name in the report, value) of each error."""
        yield from zip(ERROR_NAMES, (self.estimation, self.linearization, self.shape), strict=True)

    def __getitem__(self, name: str) -> T:
        """Return the value of the error of this name."""
        return dict(self.items())[name]

    @classmethod
    def combined(cls, function: Callable[..., T], *parts: PerError[Any]) -> PerError[T]:
        """Return what `function` makes of each error's values in `parts`."""
        return cls(
            function(*(part.estimation for part in parts)),
            function(*(part.linearization for part in parts)),
            function(*(part.shape for part in parts)),
        )


@dataclass(frozen=True)
class Interval:
    """A figure and the ends of its 95 % confidence interval."""

    value: float
    low: float
    high: float

    @property
    def contains_zero(self) -> bool:
        """Whether the interval contains 0: a difference is then a tie."""
        return self.low <= 0 <= self.high


@dataclass(frozen=True)
class ErrorSummary:
    """One error of one estimator over a set of photographs.

    Parameters
    ----------
    mean, median, p90 : Interval
        Of the error; p90 is the 90th percentile.
    ratio : Interval
        The mean divided by that of gamma 2.2 on the same photographs.
    win_rate : Interval
        The fraction of photographs, 0 to 1, on which the error is below that of gamma 2.2.
    """

    mean: Interval
    median: Interval
    p90: Interval
    ratio: Interval
    win_rate: Interval


@dataclass(frozen=True)
class EstimatorSummary:
    """All errors of one estimator over a set of photographs; `psnr`, in decibels, is that of the mean E_lin."""

    errors: PerError[ErrorSummary]
    psnr: Interval

    def named(self) -> dict[str, float]:
        """Return the figures without their intervals under the names that model.json has for them."""
        names = {"mean": "mean", "median": "median", "p90": "p90", "ratio": "ratio", "win_rate": "win rate"}
        figures = {
            f"{error} {name}": float(getattr(summary, field).value)
            for error, summary in self.errors.items()
            for field, name in names.items()
        }
        return figures | {"PSNR of the mean": self.psnr.value}


@dataclass(frozen=True)
class Comparison:
    """A paired difference of two mean errors, and in words who is better, or that it is a tie."""

    difference: Interval
    verdict: str


@dataclass(frozen=True)
class EstimatorDifference:
    """The errors of the first estimator less those of the second, on the same photographs."""

    first: str
    second: str
    errors: PerError[Comparison]
