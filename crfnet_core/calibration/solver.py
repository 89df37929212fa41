"""Response, exposures and irradiances that explain a stack, by robust nonlinear least squares (Eq. 44)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crfnet_core.calibration.blocks import Observations
from crfnet_core.calibration.curve_model import HIGHEST, LOWEST, STEPS, CurveModel, CurveValues
from crfnet_core.types import BoolArray, Float64Array

#: How often an observation is counted less than its noise alone would ask for: the errors of blocks go together.
DEFLATION = 10.0

#: Standard deviations in stops, beforehand, of a frame's exposure around its label, and of the other channels' around
#: that of green: cameras that change the white balance between frames leave green alone.
TIME_DEVIATION, BALANCE_DEVIATION = 0.05, 0.3

#: The same, in stops a stop, of green's offsets' trend over the exposures. A power of the exposures cannot be told from
#: a power in the response, so the labels decide.
TREND_DEVIATION = 5e-4

#: Standard deviations from which errors of brightness, and of exposures, count linearly.
HUBER = 2.0

#: Least slope df/du, in brightness a stop, that costs nothing; and the deviation by which one below is weighed.
LEAST_SLOPE, SLOPE_DEVIATION = 2e-4, 2e-4

#: A white sample explains itself from so many 8-bit codes below white on.
WHITE_CODES = 0.5

#: Iterations at most, and the relative change of the cost that ends them.
MOST_ITERATIONS, ENOUGH = 40, 2e-4


@dataclass(frozen=True, eq=False)
class StackFit:
    """What explains a stack.

    Parameters
    ----------
    weights : ndarray, float64, shape (K,)
        Of the response: see `CurveModel`.
    offsets : ndarray, float64, shape (T, C)
        Stops by which each frame is brighter than its label says, in each channel.
    log_irradiance : ndarray, float64, shape (M,)
        log2 of each sample's irradiance at the mean exposure of the stack; that of white is 0.
    covariance : ndarray, float64, shape (K, K)
        Posterior covariance of the weights.
    residual : ndarray, float64, shape (M, T)
        Brightness less that of the model; NaN where nothing was seen.
    cost : float
        What was minimised.
    """

    weights: Float64Array
    offsets: Float64Array
    log_irradiance: Float64Array
    covariance: Float64Array
    residual: Float64Array
    cost: float

    def exposed(self, exposures: Float64Array, seen: Observations) -> Float64Array:
        """Return log2 of the irradiance of every sample in every frame, shape (M, T)."""
        return self.log_irradiance[:, None] + exposures + self.offsets.T[seen.channel]


def fit_stack(
    seen: Observations, exposures: Float64Array, model: CurveModel, weights: Float64Array, log_irradiance: Float64Array
) -> StackFit:
    """Return the most likely response, exposures and irradiances.

    Gauss-Newton with Levenberg and Marquardt's damping. The irradiances, thousands of unknowns that each touch one
    sample only, are eliminated from the normal equations (Schur complement). Iteratively reweighted least squares
    make the cost Huber's.

    Source: the model of Mann and Picard (1995) and of Debevec and Malik (1997), with the response as a forward model.

    Parameters
    ----------
    seen : Observations
        Brightness of M samples in T frames.
    exposures : ndarray, float64, shape (T,)
        Labels of the exposures, in stops.
    model : CurveModel
        The responses to choose from.
    weights : ndarray, float64, shape (K,)
        Where to begin.
    log_irradiance : ndarray, float64, shape (M,)
        Where to begin.
    """
    problem = _Problem(seen, exposures, model)
    state = _State(weights, np.zeros((len(exposures), problem.channels)), log_irradiance)
    system = problem.linearize(state)
    damping = 1e-3
    for _ in range(MOST_ITERATIONS):
        moved = problem.step(state, system, damping)
        trial = problem.linearize(moved)
        if trial.cost > system.cost:
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
    shared: Float64Array  # (P, P), of weights and offsets
    coupling: Float64Array  # (M, P)
    single: Float64Array  # (M,), of the irradiances
    shared_side: Float64Array  # (P,)
    single_side: Float64Array  # (M,)


class _Problem:
    """The parts of the least squares that no iteration changes."""

    def __init__(self, seen: Observations, exposures: Float64Array, model: CurveModel) -> None:
        self.seen, self.exposures, self.model = seen, exposures, model
        self.channels = int(seen.channel.max()) + 1
        self.frames = len(exposures)
        self.slope_basis = np.diff(model.basis[::8], axis=0) * (STEPS / 8)
        self.slope_mean = np.diff(model.mean[::8]) * (STEPS / 8)
        self.offset_precision = np.linalg.inv(_offset_covariance(self.channels))
        self.trend = np.zeros((self.frames, self.channels))
        self.trend[:, self.channels // 2] = (exposures - exposures.mean()) / (np.ptp(exposures) ** 2 * self.frames / 12)

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
        shared = weighted.T @ jacobian.reshape(-1, jacobian.shape[-1])
        side = weighted.T @ residual.ravel()
        prior_cost = self._add_priors(state, shared, side)
        return _System(
            cost=cost + prior_cost,
            residual=residual,
            shared=shared,
            coupling=np.einsum("mt,mtp->mp", weight * curve.slope, jacobian),
            single=(weight * curve.slope**2).sum(axis=1) + 1e-6,
            shared_side=side,
            single_side=(weight * curve.slope * residual).sum(axis=1),
        )

    def step(self, state: _State, system: _System, damping: float) -> _State:
        """Return the state after one damped step."""
        single = system.single * (1 + damping)
        reduced = system.coupling / single[:, None]
        matrix = system.shared - system.coupling.T @ reduced
        matrix[np.diag_indices_from(matrix)] += damping * np.diag(system.shared)
        shared = np.linalg.solve(matrix, system.shared_side - reduced.T @ system.single_side)
        change = np.clip((system.single_side - system.coupling @ shared) / single, -1, 1)
        size = len(state.weights)
        return _State(
            weights=state.weights + shared[:size],
            offsets=state.offsets + shared[size:].reshape(state.offsets.shape),
            log_irradiance=np.clip(state.log_irradiance + change, LOWEST, HIGHEST + 8),
        )

    def covariance(self, system: _System) -> Float64Array:
        """Return the posterior covariance of the response's weights."""
        matrix = system.shared - system.coupling.T @ (system.coupling / system.single[:, None])
        size = self.model.basis.shape[1]
        return np.asarray(np.linalg.inv(matrix)[:size, :size], dtype=np.float64)

    def _residuals(self, curve: CurveValues, log_exposed: Float64Array) -> tuple[Float64Array, BoolArray]:
        """Return brightness less the model's, and where it counts: a white sample only where the model has less."""
        seen = self.seen
        white = 1 - WHITE_CODES / 255
        residual = np.where(seen.is_white, white - curve.brightness, seen.brightness - curve.brightness)
        is_too_dark = seen.is_white & (curve.brightness < white) & (log_exposed < HIGHEST)
        return residual, seen.is_used | is_too_dark

    def _add_priors(self, state: _State, shared: Float64Array, side: Float64Array) -> float:
        """Add what is known beforehand to the normal equations, and return its cost: weights, exposures, slopes."""
        size = len(state.weights)
        shared[:size, :size] += self.model.precision
        side[:size] -= self.model.precision @ state.weights
        cost = float(state.weights @ self.model.precision @ state.weights)
        for frame, offset in enumerate(state.offsets):
            part = slice(size + frame * self.channels, size + (frame + 1) * self.channels)
            distance = np.sqrt(np.array(offset @ self.offset_precision @ offset))
            weight = float(_huber_weight(distance))
            shared[part, part] += weight * self.offset_precision
            side[part] -= weight * self.offset_precision @ offset
            cost += float(_huber_cost(distance))
        trend = self.trend.ravel() / TREND_DEVIATION
        excess = float(trend @ state.offsets.ravel())
        shared[size:, size:] += np.outer(trend, trend)
        side[size:] -= trend * excess
        cost += excess**2
        slope = self.slope_mean + self.slope_basis @ state.weights
        falling = slope < LEAST_SLOPE
        rows = self.slope_basis[falling] / SLOPE_DEVIATION
        lacking = (LEAST_SLOPE - slope[falling]) / SLOPE_DEVIATION
        shared[:size, :size] += rows.T @ rows
        side[:size] += rows.T @ lacking
        return cost + float(lacking @ lacking)


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
