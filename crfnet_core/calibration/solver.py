"""Response, exposures and irradiances that explain a stack, by robust nonlinear least squares (Eq. C.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crfnet_core.calibration.blocks import Observations
from crfnet_core.calibration.curve_model import HIGHEST, LOWEST, CurveModel, CurveValues
from crfnet_core.types import BoolArray, Float64Array

#: Factor by which every observation is down-weighted, because errors of neighboring blocks are correlated.
DEFLATION = 10.0

#: Prior standard deviations in stops of a frame's exposure around its label, and of the other channels' around
#: green's: cameras that change the white balance between frames leave green alone.
TIME_DEVIATION, BALANCE_DEVIATION = 0.05, 0.3

#: The same, in stops a stop, of the trend of green's offsets over the exposures. A power of the exposures cannot be
#: distinguished from a power in the response, so the labels decide.
TREND_DEVIATION = 5e-4

#: Standard deviations from which errors of brightness, and of exposures, count linearly.
HUBER = 2.0

#: 8-bit codes below white from which on the model's value for a white sample costs nothing.
WHITE_CODES = 0.5

#: Iterations at most, and the relative change of the cost that ends them.
MOST_ITERATIONS, ENOUGH = 40, 2e-4


@dataclass(frozen=True, eq=False)
class StackFit:
    """The response, exposures and irradiances that explain a stack."""

    weights: Float64Array  # (K,): of the response: see `CurveModel`
    offsets: Float64Array  # (T, C): stops by which each frame is brighter than its label, in each channel
    #: Shape (M,): log2 of each sample's irradiance at the mean exposure of the stack; white is 0.
    log_irradiance: Float64Array
    covariance: Float64Array  # (K, K): posterior covariance of the weights
    residual: Float64Array  # (M, T): brightness less the model's; NaN where nothing was seen
    cost: float  # Eq. C.2

    def exposed(self, exposures: Float64Array, seen: Observations) -> Float64Array:
        """Return log2 of the irradiance of every sample in every frame, shape (M, T)."""
        return self.log_irradiance[:, None] + exposures + self.offsets.T[seen.channel]


def fit_stack(
    seen: Observations, exposures: Float64Array, model: CurveModel, weights: Float64Array, log_irradiance: Float64Array
) -> StackFit:
    """Return the most likely response, exposures and irradiances, from a start: weights (K,) and log_irradiance (M,).

    Gauss-Newton with Levenberg and Marquardt's damping. The irradiances, thousands of unknowns that each touch one
    sample only, are eliminated from the normal equations (Schur complement). Iteratively reweighted least squares make
    the cost Huber's.

    Source: the model of Mann and Picard (1995) and of Debevec and Malik (1997), with the response as a forward model.
    """
    problem = _Problem(seen, exposures, model)
    state = _State(weights, np.zeros((len(exposures), problem.channels)), log_irradiance)
    system = problem.linearize(state)
    damping = 1e-3
    for _ in range(MOST_ITERATIONS):
        moved = problem.step(state, system, damping)
        trial = problem.linearize(moved)
        if not trial.cost <= system.cost:  # worse, or not a number
            damping *= 8
            if damping > 1e8:
                break
            continue
        gain, state, system = system.cost - trial.cost, moved, trial
        damping = max(damping / 5, 1e-9)
        if gain < ENOUGH * system.cost:
            break
    return StackFit(
        weights=state.weights,
        offsets=state.offsets,
        log_irradiance=state.log_irradiance,
        covariance=problem.covariance(system),
        residual=np.where(seen.is_used, system.residual, np.nan),
        cost=system.cost,
    )


@dataclass(frozen=True, eq=False)
class _State:
    """The unknowns."""

    weights: Float64Array
    offsets: Float64Array
    log_irradiance: Float64Array


@dataclass(frozen=True, eq=False)
class _System:
    """The cost at a state, its normal equations, and the residuals in brightness."""

    cost: float
    residual: Float64Array
    matrix: Float64Array  # (P, P): of weights and offsets
    right: Float64Array  # (P,): their right-hand side
    coupling: Float64Array  # (M, P): of irradiances with weights and offsets
    diagonal: Float64Array  # (M,): of the irradiances, which have no terms with each other
    irradiance_right: Float64Array  # (M,): their right-hand side


class _Problem:
    """The parts of the least squares that no iteration changes."""

    def __init__(self, seen: Observations, exposures: Float64Array, model: CurveModel) -> None:
        self.seen, self.exposures, self.model = seen, exposures, model
        self.channels = int(seen.channel.max()) + 1
        self.frames = len(exposures)
        self.offset_precision = np.linalg.inv(_offset_covariance(self.channels))
        trend = np.zeros((self.frames, self.channels))
        trend[:, self.channels // 2] = (exposures - exposures.mean()) / (np.ptp(exposures) ** 2 * self.frames / 12)
        self.trend = trend.ravel() / TREND_DEVIATION

    def linearize(self, state: _State) -> _System:
        """Return cost, residuals and normal equations."""
        seen, size = self.seen, len(state.weights)
        log_exposed = state.log_irradiance[:, None] + self.exposures + state.offsets.T[seen.channel]
        curve = self.model.values(state.weights, log_exposed)
        residual, counts = self._residuals(curve, log_exposed)
        scaled = residual / seen.deviation
        weight = counts * _huber_weight(scaled) / seen.deviation**2 / DEFLATION
        cost = float((counts * _huber_cost(scaled)).sum()) / DEFLATION
        jacobian = np.zeros((*residual.shape, size + self.frames * self.channels))
        jacobian[..., :size] = curve.gradient
        frame = np.arange(self.frames)
        at = size + frame[None] * self.channels + seen.channel[:, None]
        jacobian[np.arange(len(residual))[:, None], frame[None], at] = curve.slope
        weighted = (jacobian * weight[..., None]).reshape(-1, jacobian.shape[-1])
        prior_cost, prior_matrix, prior_right = self._priors(state)
        return _System(
            cost=cost + prior_cost,
            residual=residual,
            matrix=weighted.T @ jacobian.reshape(-1, jacobian.shape[-1]) + prior_matrix,
            right=weighted.T @ residual.ravel() + prior_right,
            coupling=np.einsum("mt,mtp->mp", weight * curve.slope, jacobian),
            diagonal=(weight * curve.slope**2).sum(axis=1) + 1e-6,
            irradiance_right=(weight * curve.slope * residual).sum(axis=1),
        )

    def step(self, state: _State, system: _System, damping: float) -> _State:
        """Return the state after one damped step."""
        diagonal = system.diagonal * (1 + damping)
        reduced = system.coupling / diagonal[:, None]
        matrix = system.matrix - system.coupling.T @ reduced
        matrix[np.diag_indices_from(matrix)] += damping * np.diag(system.matrix)
        step = np.linalg.solve(matrix, system.right - reduced.T @ system.irradiance_right)
        brighter = np.clip((system.irradiance_right - system.coupling @ step) / diagonal, -1, 1)
        size = len(state.weights)
        return _State(
            weights=state.weights + step[:size],
            offsets=state.offsets + step[size:].reshape(state.offsets.shape),
            log_irradiance=np.clip(state.log_irradiance + brighter, LOWEST, HIGHEST + 8),
        )

    def covariance(self, system: _System) -> Float64Array:
        """Return the posterior covariance of the response's weights."""
        matrix = system.matrix - system.coupling.T @ (system.coupling / system.diagonal[:, None])
        size = self.model.basis.shape[1]
        return np.asarray(np.linalg.inv(matrix)[:size, :size], dtype=np.float64)

    def _residuals(self, curve: CurveValues, log_exposed: Float64Array) -> tuple[Float64Array, BoolArray]:
        """Return brightness less the model's, and where it counts: a white sample only where the model has less."""
        seen = self.seen
        white = 1 - WHITE_CODES / 255
        residual = np.where(seen.is_white, white - curve.brightness, seen.brightness - curve.brightness)
        is_too_dark = seen.is_white & (curve.brightness < white) & (log_exposed < HIGHEST)
        return residual, seen.is_used | is_too_dark

    def _priors(self, state: _State) -> tuple[float, Float64Array, Float64Array]:
        """Return the cost of the priors of weights and offsets, and their normal equations, (P, P) and (P,)."""
        weight_cost, weight_matrix, weight_right = self._weight_prior(state.weights)
        offset_cost, offset_matrix, offset_right = self._offset_prior(state.offsets)
        size, offsets = len(weight_right), len(offset_right)
        matrix = np.block([[weight_matrix, np.zeros((size, offsets))], [np.zeros((offsets, size)), offset_matrix]])
        return weight_cost + offset_cost, matrix, np.append(weight_right, offset_right)

    def _weight_prior(self, weights: Float64Array) -> tuple[float, Float64Array, Float64Array]:
        """Return the prior of the weights: they are normal, and slopes below `LEAST_SLOPE` cost."""
        lacking, rows = self.model.low_slopes(weights)
        pull = self.model.precision @ weights
        return float(weights @ pull + lacking @ lacking), self.model.precision + rows.T @ rows, rows.T @ lacking - pull

    def _offset_prior(self, offsets: Float64Array) -> tuple[float, Float64Array, Float64Array]:
        """Return the prior of the offsets: normal in each frame but for Huber's tails, and without a trend in green."""
        distance = np.sqrt(np.einsum("tc,cd,td->t", offsets, self.offset_precision, offsets))
        frames = np.kron(np.diag(_huber_weight(distance)), self.offset_precision)
        excess = float(self.trend @ offsets.ravel())
        cost = float(_huber_cost(distance).sum()) + excess**2
        return cost, frames + np.outer(self.trend, self.trend), -frames @ offsets.ravel() - self.trend * excess


def _offset_covariance(channels: int) -> Float64Array:
    """Return the covariance of a frame's offsets, shape (C, C): green by the time, the others by white balance too."""
    covariance = np.full((channels, channels), TIME_DEVIATION**2)
    for channel in (0, 2) if channels == 3 else ():
        covariance[channel, channel] += BALANCE_DEVIATION**2
    return covariance


def _huber_weight(scaled: Float64Array) -> Float64Array:
    """Return the weights of iteratively reweighted least squares for Huber's cost."""
    return np.minimum(1, HUBER / np.maximum(np.abs(scaled), 1e-12))


def _huber_cost(scaled: Float64Array) -> Float64Array:
    """Return Huber's cost: squares up to `HUBER`, then straight lines."""
    size = np.abs(scaled)
    return np.where(size <= HUBER, size**2, 2 * HUBER * size - HUBER**2)
