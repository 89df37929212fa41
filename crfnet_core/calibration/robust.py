"""The response that explains observations best, by robust nonlinear least squares: shared by stacks and raw pairs."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from crfnet_core.calibration.curve_model import CurveModel
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import BoolArray, Float64Array

#: Factor by which every observation is down-weighted, because errors of neighboring ones are correlated.
DEFLATION = 10.0

#: Standard deviations from which errors count linearly.
HUBER = 2.0

#: Brightness from which on the model's value for a white observation costs nothing.
WHITE_BRIGHTNESS = 1 - 0.5 / 255

#: Steps at most, and the relative change of the cost that ends them.
MOST_STEPS, ENOUGH = 40, 2e-4

#: Draws from the posterior of the weights, and their seed.
DRAWS, SEED = 64, 0


@dataclass(frozen=True, eq=False)
class FittedResponse:
    """A fitted response of `CurveModel`, and the light of the observations."""

    weights: Float64Array  # (K,)
    covariance: Float64Array  # (K, K): their posterior covariance
    log_light: Float64Array  # log2 of the light of each observation
    residual: Float64Array  # of the same shape: brightness less the model's; NaN where nothing counts

    def response(self, *, log_white: float = 0.0) -> ResponseCurve:
        """Return the response; `log_white` is log2 of the irradiance of white in the units of the fit."""
        return CurveModel.load().response(self.weights, log_white=log_white)

    def deviations(self, codes: Float64Array) -> tuple[float, float]:
        """Return the posterior standard deviations of shape and scale at some codes in 0 to 1, in stops."""
        rng = np.random.default_rng(SEED)
        drawn = rng.multivariate_normal(self.weights, self.covariance, size=DRAWS, method="eigh")
        stops = np.stack([CurveModel.load().log_irradiance(weights, codes) for weights in drawn])
        off = stops - stops.mean(axis=0)
        return float(np.sqrt(off.var(axis=1).mean())), float(off.mean(axis=1).std())


class ResponseProblem(ABC):
    """Least squares for a response and the light of N observations.

    The first unknowns are the K weights of the response; a subclass says how the R others make the light. These lie
    around 0, with deviations `spread` and Huber's tails. An observation that is white costs only where the response is
    below white, one of infinite deviation nothing.
    """

    def __init__(
        self, brightness: Float64Array, deviation: Float64Array, is_white: BoolArray, spread: Float64Array
    ) -> None:
        self.model = CurveModel.load()
        self.size = len(self.model.center)
        self.brightness, self.deviation, self.is_white = brightness, deviation, is_white
        self.center, self.spread = np.append(self.model.center, 0 * spread), np.append(np.ones(self.size), spread)
        self.starts = np.zeros(0, np.intp)  # the first observation of each sample whose irradiance is unknown

    @abstractmethod
    def light(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return log2 of the light of every observation, (N,), and its derivatives by the other unknowns, (N, R)."""

    @abstractmethod
    def constraint(self, others: Float64Array) -> tuple[float, Float64Array]:
        """Return an error of the other unknowns together, in standard deviations, and its derivatives, (R,)."""

    def solved(self, state: Float64Array) -> Float64Array:
        """Return the unknowns of least cost, from a start, by Gauss-Newton with Levenberg and Marquardt's damping."""
        cost, damping = self.cost(state), 1e-3
        gradient, matrix = self.normal_equations(state)
        for _ in range(MOST_STEPS):
            moved = state - np.linalg.solve(matrix + damping * np.diag(np.diag(matrix)), gradient)
            gain = cost - self.cost(moved)
            if not gain >= 0:  # worse, or not a number
                damping *= 8
                continue
            state, cost, damping = moved, cost - gain, damping / 5
            if gain < ENOUGH * cost and damping < 0.01:
                break
            gradient, matrix = self.normal_equations(state)
        return state

    def cost(self, state: Float64Array) -> float:
        """Return the sum of squares of errors in standard deviations, with Huber's straight lines (Eq. C.2)."""
        off, _ = self.off(state, self.light(state)[0])
        lacking, _ = self.model.low_slopes(state[: self.size])
        weights, others = np.split((state - self.center) / self.spread, [self.size])
        own = weights @ weights + huber_cost(others).sum() + self.constraint(state[self.size :])[0] ** 2
        return float(huber_cost(off / self.deviation).sum() / DEFLATION + lacking @ lacking + own)

    def normal_equations(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return half the gradient of the cost, and half its second derivatives by Gauss and Newton."""
        log_light, by_others = self.light(state)
        off, slope = self.off(state, log_light)
        rows = np.hstack([self.model.gradient(log_light), slope[:, None] * by_others])
        precision = huber_weight(off / self.deviation) / self.deviation**2 / DEFLATION * (off != 0)
        weighted = rows * precision[:, None]
        gradient, matrix = -off @ weighted, weighted.T @ rows
        coupling = np.add.reduceat(weighted * slope[:, None], self.starts)
        diagonal = np.add.reduceat(precision * slope**2, self.starts) + 1e-6
        matrix -= coupling.T @ (coupling / diagonal[:, None])  # Schur complement
        stiffness = self.spread**-2
        stiffness[self.size :] *= huber_weight((state / self.spread)[self.size :])
        gradient += stiffness * (state - self.center)
        matrix += np.diag(stiffness)
        lacking, low = self.model.low_slopes(state[: self.size])
        gradient[: self.size] -= lacking @ low
        matrix[: self.size, : self.size] += low.T @ low
        error, row = self.constraint(state[self.size :])
        gradient[self.size :] += error * row
        matrix[self.size :, self.size :] += np.outer(row, row)
        return gradient, matrix

    def off(self, state: Float64Array, log_light: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return brightness less the model's, and its slope; 0 and 0 where a white observation costs nothing."""
        brightness, slope = self.model.brightness(state[: self.size], log_light)
        is_met = self.is_white & (brightness >= WHITE_BRIGHTNESS)
        off = np.where(self.is_white, WHITE_BRIGHTNESS, self.brightness) - brightness
        return np.where(is_met, 0, off), np.where(is_met, 0, slope)

    def covariance(self, state: Float64Array) -> Float64Array:
        """Return the posterior covariance of the weights, shape (K, K)."""
        return np.asarray(np.linalg.inv(self.normal_equations(state)[1])[: self.size, : self.size])


def rms_codes(residual: Float64Array) -> float:
    """Return the root mean square of what counts of a residual, white = 255; NaN if nothing does."""
    counts = np.isfinite(residual)
    return float(255 * np.sqrt(np.mean(residual[counts] ** 2))) if counts.any() else math.nan


def huber_cost(scaled: Float64Array) -> Float64Array:
    """Return Huber's cost of errors in standard deviations: squares up to `HUBER`, then straight lines."""
    inner = np.clip(scaled, -HUBER, HUBER)
    return np.asarray(inner * (2 * scaled - inner))


def huber_weight(scaled: Float64Array) -> Float64Array:
    """Return the weights with which squares have the slopes of Huber's cost."""
    return HUBER / np.maximum(np.abs(scaled), HUBER)
