"""The response that explains observations best, by robust nonlinear least squares: shared by stacks and raw pairs."""

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
    """A fitted response of `CurveModel`."""

    weights: Float64Array  # (K,)
    covariance: Float64Array  # (K, K): their posterior covariance
    residual: Float64Array  # brightness less the model's; NaN where nothing counts

    def response(self, *, log_white: float = 0.0) -> ResponseCurve:
        """Return the response; `log_white` is log2 of the irradiance of white in the units of the fit."""
        return CurveModel.load().response(self.weights, log_white=log_white)

    def log_inverse(self, brightness: Float64Array) -> Float64Array:
        """Return log2 of the irradiance that makes `brightness`."""
        return CurveModel.load().log_irradiance(self.weights, brightness)

    def deviations(self, codes: Float64Array) -> tuple[float, float]:
        """Return the posterior standard deviations of shape and scale at some codes in 0 to 1, in stops."""
        rng = np.random.default_rng(SEED)
        drawn = rng.multivariate_normal(self.weights, self.covariance, size=DRAWS, method="eigh")
        stops = np.stack([CurveModel.load().log_irradiance(weights, codes) for weights in drawn])
        off = stops - stops.mean(axis=0)
        scales = off.mean(axis=1)
        return float(np.sqrt(((off - scales[:, None]) ** 2).mean())), float(scales.std())


class ResponseProblem(ABC):
    """Least squares for a response and the light of N observations.

    The first unknowns are the K weights of the response; a subclass says how the R others make the light. An
    observation that is white costs only where the response is below white, one of infinite deviation nothing.
    """

    def __init__(self, brightness: Float64Array, deviation: Float64Array, is_white: BoolArray) -> None:
        self.model = CurveModel.load()
        self.size = len(self.model.center)
        self.brightness, self.deviation, self.is_white = brightness, deviation, is_white
        self.starts = np.zeros(0, np.intp)

    @abstractmethod
    def light(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return log2 of the light of every observation, (N,), and its derivatives by the other unknowns, (N, R)."""

    @abstractmethod
    def prior(self, others: Float64Array) -> tuple[float, Float64Array, Float64Array]:
        """Return what the other unknowns cost by themselves, half its gradient and half its second derivatives."""

    def solved(self, state: Float64Array) -> Float64Array:
        """Return the unknowns of least cost, from a start, by Gauss-Newton with Levenberg and Marquardt's damping.

        `scipy.optimize.least_squares` takes two to three times as long (5 to 10 s a stack): it squares the derivatives
        of Huber's roots, and more of its steps fail.
        """
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
        weights, others = state[: self.size], state[self.size :]
        off, _ = self.off(weights, self.light(state)[0])
        observed = float(huber_cost(off / self.deviation).sum()) / DEFLATION
        lacking, _ = self.model.low_slopes(weights)
        return observed + float(np.sum((weights - self.model.center) ** 2) + lacking @ lacking) + self.prior(others)[0]

    def normal_equations(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return half the gradient of the cost, and half its second derivatives by Gauss and Newton."""
        weights, others = state[: self.size], state[self.size :]
        log_light, by_others = self.light(state)
        off, slope = self.off(weights, log_light)
        rows = np.hstack([self.model.gradient(log_light), slope[:, None] * by_others])
        precision = huber_weight(off / self.deviation) / self.deviation**2 / DEFLATION * (off != 0)
        weighted = rows * precision[:, None]
        gradient, matrix = -off @ weighted, weighted.T @ rows
        coupling = np.add.reduceat(weighted * slope[:, None], self.starts)
        diagonal = np.add.reduceat(precision * slope**2, self.starts) + 1e-6
        matrix -= coupling.T @ (coupling / diagonal[:, None])  # Schur complement
        lacking, low = self.model.low_slopes(weights)
        gradient[: self.size] += weights - self.model.center - lacking @ low
        matrix[: self.size, : self.size] += np.eye(self.size) + low.T @ low
        _, pull, stiffness = self.prior(others)
        gradient[self.size :] += pull
        matrix[self.size :, self.size :] += stiffness
        return gradient, matrix

    def off(self, weights: Float64Array, log_light: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return brightness less the model's, and its slope; 0 and 0 where a white observation costs nothing."""
        brightness, slope = self.model.brightness(weights, log_light)
        is_met = self.is_white & (brightness >= WHITE_BRIGHTNESS)
        off = np.where(self.is_white, WHITE_BRIGHTNESS, self.brightness) - brightness
        return np.where(is_met, 0, off), np.where(is_met, 0, slope)

    def covariance(self, state: Float64Array) -> Float64Array:
        """Return the posterior covariance of the weights, shape (K, K)."""
        inverse = np.linalg.inv(self.normal_equations(state)[1])
        return np.asarray(inverse[: self.size, : self.size], dtype=np.float64)


def rms_codes(residual: Float64Array) -> float:
    """Return the root mean square of what counts of a residual, white = 255; NaN if nothing does."""
    counted = residual[np.isfinite(residual)]
    return float(255 * np.sqrt(np.mean(counted**2))) if len(counted) else float("nan")


def huber_cost(scaled: Float64Array) -> Float64Array:
    """Return Huber's cost of errors in standard deviations: squares up to `HUBER`, then straight lines."""
    inner = np.clip(scaled, -HUBER, HUBER)
    return np.asarray(inner * (2 * scaled - inner))


def huber_weight(scaled: Float64Array) -> Float64Array:
    """Return the weights with which squares have the slopes of Huber's cost."""
    return HUBER / np.maximum(np.abs(scaled), HUBER)
