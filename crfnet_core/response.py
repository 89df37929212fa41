"""The camera response: how relative irradiance E becomes image brightness B."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.errors import CurveError
from crfnet_core.types import Float64Array

#: Samples of a response over irradiance in [0, 1], as in DoRF and EMoR.
SAMPLES = 1024

#: Fraction of the identity mixed into every response: its least slope, which bounds the slope of the inverse.
LEAST_SLOPE = 1e-4


@dataclass(frozen=True)
class ResponseCurve:
    """A strictly increasing response f with f(0) = 0 and f(1) = 1, linear between its samples.

    Build one with `from_samples`; the constructor only checks.

    Parameters
    ----------
    brightness : ndarray, float64, shape (1024,)
        f at `SAMPLES` uniform irradiances from 0 to 1; strictly increasing from 0 to 1.

    Raises
    ------
    CurveError
        If the samples are of another shape, not strictly increasing, or do not run from 0 to 1.
    """

    brightness: Float64Array
    _irradiance: Float64Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        brightness = np.array(self.brightness, dtype=np.float64)
        if brightness.shape != (SAMPLES,):
            raise CurveError(f"a response needs shape ({SAMPLES},), found {brightness.shape}; use from_samples")
        if brightness[0] != 0 or brightness[-1] != 1 or not (np.diff(brightness) > 0).all():
            raise CurveError("a response must increase strictly from 0 to 1; use from_samples")
        brightness.flags.writeable = False
        object.__setattr__(self, "brightness", brightness)
        object.__setattr__(self, "_irradiance", np.linspace(0, 1, SAMPLES))

    @classmethod
    def from_samples(cls, samples: ArrayLike) -> ResponseCurve:
        """Return the strictly monotone, normalised response nearest to `samples` (Eq. 26 and 27 of docs/METHOD.md).

        The samples are scaled to run from 0 to 1 and projected on the increasing sequences (`nearest_increasing`):
        a projection on a convex set brings a curve no farther from any member of the set, so this never raises the
        error against a true response. `LEAST_SLOPE` of the identity is then mixed in, which makes it strict.

        Parameters
        ----------
        samples : array_like, shape (N,), N >= 2
            The response at N uniform irradiances from 0 to 1, in any scale; resampled to `SAMPLES` if need be.

        Raises
        ------
        CurveError
            If there are fewer than two finite samples, or the last is not above the first.
        """
        values = np.asarray(samples, dtype=np.float64)
        if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all():
            raise CurveError("a response needs a row of two or more finite samples")
        if values[-1] <= values[0]:
            raise CurveError("a response must be brighter at full irradiance than in the dark")
        uniform = np.linspace(0, 1, SAMPLES)
        if values.size != SAMPLES:
            values = np.interp(uniform, np.linspace(0, 1, values.size), values)
        scaled = np.clip((values - values[0]) / (values[-1] - values[0]), 0, 1)
        strict = (1 - LEAST_SLOPE) * nearest_increasing(scaled) + LEAST_SLOPE * uniform
        return cls((strict - strict[0]) / (strict[-1] - strict[0]))

    @classmethod
    def gamma(cls, exponent: float = 2.2) -> ResponseCurve:
        """Return the power law f(E) = E ** (1 / exponent), what people guess without an estimate.

        Raises
        ------
        CurveError
            If `exponent` is not above 0.
        """
        if not exponent > 0:
            raise CurveError(f"a gamma must be above 0, found {exponent}")
        return cls.from_samples(np.linspace(0, 1, SAMPLES) ** (1 / exponent))

    def forward(self, irradiance: ArrayLike) -> Float64Array:
        """Return brightness f(E) in [0, 1], of the shape of `irradiance`; E is clipped to [0, 1]."""
        return np.interp(np.asarray(irradiance, dtype=np.float64), self._irradiance, self.brightness)

    def inverse(self, brightness: ArrayLike) -> Float64Array:
        """Return irradiance g(B) in [0, 1], of the shape of `brightness`; B is clipped to [0, 1]."""
        return np.interp(np.asarray(brightness, dtype=np.float64), self.brightness, self._irradiance)


def nearest_increasing(samples: ArrayLike) -> Float64Array:
    """Return the non-decreasing sequence nearest to `samples` in L2, shape (N,): pool adjacent violators (Eq. 26).

    Source: Ayer et al., "An empirical distribution function for sampling with incomplete information", 1955.
    """
    means: list[float] = []
    counts: list[int] = []
    for value in np.asarray(samples, dtype=np.float64).tolist():
        mean, count = value, 1
        while means and means[-1] > mean:
            before, size = means.pop(), counts.pop()
            mean, count = (mean * count + before * size) / (count + size), count + size
        means.append(mean)
        counts.append(count)
    return np.repeat(means, counts)
