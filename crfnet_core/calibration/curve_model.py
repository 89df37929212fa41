"""The model of the measured response: EMoR plus splines, over the logarithm of irradiance (Eq. C.1)."""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.posterior import IN_CAMERA, ResponseBank
from crfnet_core.response.curve import SAMPLES, UNIFORM, ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float32Array, Float64Array, IndexArray

#: log2 of the least and of the largest irradiance, white = 1, steps to a stop between them, and the table.
LOWEST, HIGHEST, STEPS = -14.0, 1.0, 32
TABLE = np.arange(round((HIGHEST - LOWEST) * STEPS) + 1) / STEPS + LOWEST

#: Knots of the splines in brightness of the mean response: dense at both ends, where EMoR is too stiff.
KNOTS = (
    *(0.0, 0.01, 0.02, 0.035, 0.055, 0.08, 0.11, 0.15, 0.2, 0.26, 0.33, 0.41, 0.5),
    *(0.59, 0.67, 0.74, 0.8, 0.85, 0.89, 0.92, 0.945, 0.965, 0.982, 1.0),
)

#: Prior standard deviation of the splines' weights, in brightness.
SPLINE_DEVIATION = 0.012

#: Factor on the second moment of the EMoR weights of known responses, about EMoR's mean: this response may be of a kind
#: that is not among them.
WIDENING = 4.0

#: Least slope df/du, in brightness a stop, that costs nothing, and the standard deviation that weighs a lower one.
LEAST_SLOPE, SLOPE_DEVIATION = 2e-4, 2e-4

#: Samples at the end of a response that give its slope at white.
END_SAMPLES = 24


@dataclass(frozen=True, eq=False)
class CurveModel:
    """Responses that are linear in K weights, tabulated over u = log2 of irradiance.

    A priori the weights are independent, each with the standard deviation 1. Beyond white the responses go on as
    straight lines in irradiance, so that the fit can lower an irradiance that began too high.
    """

    mean: Float64Array  # (G,): the response of weights 0
    basis: Float64Array  # (G, K): the change of the response by a unit of each weight

    @classmethod
    @cache
    def load(cls) -> Self:
        """Return the model of the packaged EMoR, with weights as widely spread as in the packaged responses."""
        emor, bank = EmorBasis.load(), ResponseBank.load()
        weights = bank.weights[bank.ordinary]
        spread = np.linalg.cholesky(WIDENING * weights.T @ weights / len(weights))
        curves = np.vstack([spread.T @ emor.components, SPLINE_DEVIATION * cubic_splines(emor.mean)])
        return cls(_tabulated(emor.mean), np.transpose([_tabulated(curve) for curve in curves]).copy())

    def brightness(self, weights: Float64Array, log_irradiance: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return f and df / du of the response with `weights`, shape (K,), at `log_irradiance` of any shape."""
        below, part = _position(log_irradiance)
        table = self.mean + self.basis @ weights
        rise = table[below + 1] - table[below]
        return table[below] + part * rise, rise * STEPS

    def gradient(self, log_irradiance: Float64Array) -> Float64Array:
        """Return df / d weights at `log_irradiance` of shape S, for any weights: (*S, K)."""
        below, part = _position(log_irradiance)
        return (1 - part[..., None]) * self.basis[below] + part[..., None] * self.basis[below + 1]

    def low_slopes(self, weights: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return what slopes lack to `LEAST_SLOPE`, in `SLOPE_DEVIATION`, (L,), and how weights raise the low ones."""
        basis = np.diff(self.basis[::8], axis=0) * (STEPS / 8)
        slope = np.diff(self.mean[::8]) * (STEPS / 8) + basis @ weights
        lacking = np.maximum(LEAST_SLOPE - slope, 0) / SLOPE_DEVIATION
        return lacking, basis / SLOPE_DEVIATION * (lacking > 0)[:, None]

    @cached_property
    def center(self) -> Float64Array:
        """The most likely weights a priori, shape (K,): of the mean response of cameras' own renderings."""
        return self.weights_of(in_camera_mean())

    def weights_of(self, curve: ResponseCurve) -> Float64Array:
        """Return the weights, shape (K,), whose response is nearest to `curve` and not unlikely by the prior."""
        wanted = _tabulated(curve.brightness) - self.mean
        system = self.basis.T @ self.basis + 1e-4 * np.eye(self.basis.shape[1])
        return np.asarray(np.linalg.solve(system, self.basis.T @ wanted), dtype=np.float64)

    def log_irradiance(self, weights: Float64Array, brightness: Float64Array) -> Float64Array:
        """Return log2 of the irradiance that the response with `weights`, shape (K,), needs for `brightness`."""
        table = np.maximum.accumulate(self.mean + self.basis @ weights)
        rising = table + 1e-9 * np.arange(len(table))
        return np.interp(brightness, rising, TABLE)

    def response(self, weights: ArrayLike, *, log_white: float = 0.0) -> ResponseCurve:
        """Return the response with `weights`, shape (K,), as a strictly monotone curve; white is at 2^`log_white`."""
        table = self.mean + self.basis @ np.asarray(weights, dtype=np.float64)
        stops = np.log2(np.maximum(UNIFORM, 1e-9)) + log_white
        samples = np.interp(stops, TABLE, table)
        low = stops < LOWEST  # as at the bottom of every sampled response, a straight line leads to black
        samples[low] = table[0] * np.exp2(stops[low] - LOWEST)
        samples[0] = 0.0
        return ResponseCurve.from_samples(np.append(np.minimum(samples[:-1], 1), 1.0))


def in_camera_responses() -> Float32Array:
    """Return the packaged responses of cameras' own renderings, (N, 1024)."""
    bank = ResponseBank.load()
    return bank.brightness[np.any([bank.members(family) for family in IN_CAMERA], axis=0)]


def in_camera_mean() -> ResponseCurve:
    """Return the mean of these responses: the start of a fit, and the center of its prior."""
    return ResponseCurve.from_samples(in_camera_responses().mean(axis=0, dtype=np.float64))


def in_file_codes(curve: ResponseCurve, white: float) -> ResponseCurve:
    """Return a response in parts of the file's largest code, given one in parts of the code of white.

    A camera may clip below the largest code, at the part `white` of it. The response then reaches `white` and jumps to
    1 in the last step of its samples, so the codes from white on read as irradiance 1, to within that step (0.0014
    stop).
    """
    return ResponseCurve(np.append(white * curve.brightness[:-1], 1.0))


def _position(log_irradiance: Float64Array) -> tuple[IndexArray, Float64Array]:
    """Return the place in the table that irradiance is above, and by what part of a step; clipped to the table."""
    position = np.clip((log_irradiance - LOWEST) * STEPS, 0, len(TABLE) - 1.001)
    below = position.astype(np.intp)
    return below, position - below


def cubic_splines(mean: Float64Array) -> Float64Array:
    """Return cubic B-splines of `KNOTS` over the brightness of a response, shape (K, N), which vanish at both ends.

    Source: de Boor, "On calculating with B-splines", 1972.
    """
    knots = np.r_[(KNOTS[0],) * 3, KNOTS, (KNOTS[-1],) * 3][:, None]
    at = np.clip(mean, 0, 1 - 1e-9)
    splines = ((knots[:-1] <= at) & (at < knots[1:])).astype(np.float64)
    for degree in range(1, 4):
        width = np.maximum(knots[degree:] - knots[:-degree], 1e-9)  # where it is 0, so is the spline
        part = (at - knots[:-degree]) / width * splines
        splines = part[:-1] + splines[1:] - part[1:]
    return np.asarray(splines[1:-1], dtype=np.float64)


def _tabulated(curve: Float64Array) -> Float64Array:
    """Return a curve of shape (1024,) over uniform irradiance on the table, continued beyond white: (G,)."""
    irradiance = np.exp2(TABLE)
    slope = (curve[-1] - curve[-1 - END_SAMPLES]) * (SAMPLES - 1) / END_SAMPLES
    inside = np.interp(irradiance, UNIFORM, curve)
    return np.asarray(inside + slope * np.maximum(irradiance - 1, 0), dtype=np.float64)
