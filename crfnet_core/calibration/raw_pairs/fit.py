"""One response and one color matrix that explain the cells of raw files and their JPEGs (Eq. C.6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from crfnet_core.calibration.curve_model import CurveModel
from crfnet_core.calibration.raw_pairs.cells import Cells
from crfnet_core.posterior import IN_CAMERA, ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import BoolArray, Float64Array

#: Factor by which every cell is down-weighted, because errors of neighboring cells are correlated.
DEFLATION = 10.0

#: Expected deviations from which a residual counts linearly, and beyond which it does not count.
HUBER, OUTLIER = 2.0, 6.0

#: Part of a cell's brightest channel below which another does not count: gamut compression changes it.
FAINT = 0.25

#: Prior standard deviations: local tone mapping, vignetting at the corner in stops, a gradient from the center to a
#: corner in stops, a shot's exposure in stops.
LOCAL_DEVIATION, CORNER_DEVIATION, TILT_DEVIATION, SHOT_DEVIATION = 0.2, 0.5, 0.1, 0.1

#: Stops by which raw saturation of white lies above the JPEG's white: the prior mean and its standard deviation.
HEADROOM, HEADROOM_DEVIATION = 0.2, 0.3

#: Brightness from which on the model's value for a white cell costs nothing.
WHITE_BRIGHTNESS = 1 - 0.5 / 255

#: Rounds of reweighting, those that do not yet leave outliers out, and evaluations in each.
ROUNDS, LENIENT, EVALUATIONS = 5, 2, 6

#: The least light, white = 1.
FLOOR = 2.0**-14


@dataclass(frozen=True, eq=False)
class PairFit:
    """A response, and the way from raw light to the light that it takes."""

    weights: Float64Array  # (K,): of the response: see `CurveModel`
    matrix: Float64Array  # (3, 3): from balanced raw light to the light of the response, whose white is 1
    local: float  # exponent of the surroundings' light in the gain: 0 without local tone mapping
    corner: float  # stops by which the corner is brightened
    tilts: Float64Array  # (S, 2): stops a place (see `Cells.place`) by which each shot brightens, right and down
    offsets: Float64Array  # (S,): stops by which each shot is brighter than the first; its own is 0
    covariance: Float64Array  # (K, K): posterior covariance of the weights
    log_light: Float64Array  # (N, 3): log2 of the light of every cell
    residual: Float64Array  # (N, 3): brightness less the model's; NaN where nothing counts
    headroom: float  # stops by which raw saturation of a white surface lies above white
    outliers: float  # fraction of what could count that fits in no way


def in_camera_mean() -> ResponseCurve:
    """Return the mean response of cameras' own renderings: the start, and the center of the prior."""
    bank = ResponseBank.load()
    members = np.any([bank.members(family) for family in IN_CAMERA], axis=0)
    return ResponseCurve.from_samples(bank.brightness[members].mean(axis=0, dtype=np.float64))


def fit_pairs(
    cells: Cells,
    saturation: float,
    model: CurveModel,
    start: PairFit | None = None,
    *,
    headroom: tuple[float, float] = (HEADROOM, HEADROOM_DEVIATION),
) -> PairFit:
    """Return the response and matrix that explain cells.

    `saturation` is the balanced raw light at which a white surface saturates, `headroom` the stops by which that lies
    above white, and their standard deviation.
    """
    problem = _Problem(cells, saturation, model, headroom)
    state = problem.start() if start is None else problem.packed(start)
    weight = problem.counts(state) / np.hypot(1, problem.chroma)
    for number in range(ROUNDS):
        found = least_squares(
            problem.residuals, state, problem.jacobian, args=(weight,), max_nfev=EVALUATIONS, x_scale="jac", ftol=1e-5
        )
        state = found.x
        weight = problem.reweighted(state, leaves_out=number >= LENIENT)
    return problem.unpacked(state, weight)


class _Problem:
    """The least squares: unknowns are the weights, the matrix row by row, and the stops that each cause makes.

    Causes are the surroundings, the corner, the tilt of each shot, and the offset of each but the first.
    """

    def __init__(self, cells: Cells, saturation: float, model: CurveModel, headroom: tuple[float, float]) -> None:
        self.cells, self.model, self.expected = cells, model, headroom
        self.saturation = np.full(3, saturation)
        self.size = model.basis.shape[1]
        self.shots = int(cells.shot.max()) + 1
        own = (cells.shot[:, None] == np.arange(self.shots)).astype(np.float64)
        tilts = (own[:, :, None] * cells.place[:, None]).reshape(len(own), -1)
        corner = (cells.place**2).sum(axis=1)
        self.causes = np.column_stack([cells.surroundings, corner, tilts, own[:, 1:]])
        others = [TILT_DEVIATION] * tilts.shape[1] + [SHOT_DEVIATION] * (self.shots - 1)
        self.deviations = np.array([LOCAL_DEVIATION, CORNER_DEVIATION, *others])
        self.precision = 255 / cells.deviation / np.sqrt(DEFLATION)
        self.mean = model.weights_of(in_camera_mean())
        self.root = np.linalg.cholesky(model.precision).T
        codes = cells.codes
        self.chroma = np.ptp(codes, axis=1, keepdims=True) / np.maximum(codes.max(axis=1, keepdims=True), 1) / 0.35
        near_white = cells.is_white & (cells.codes.min(axis=1, keepdims=True) > 200)
        self.is_white = near_white & ~cells.is_saturated[:, None]
        self.is_open = cells.is_open & ~cells.is_saturated[:, None]

    def start(self) -> Float64Array:
        """Return the mean response and a neutral matrix of the scale at which gray cells fit."""
        light = in_camera_mean().inverse(self.cells.codes / 255)
        known = self.is_open & (self.cells.codes > 20) & (self.cells.light > 1e-4)
        scale = np.exp2(np.median(np.log2(light[known] / self.cells.light[known])))
        state: Float64Array = np.r_[self.mean, (scale * np.eye(3)).ravel(), 0 * self.deviations]
        return state

    def packed(self, fit: PairFit) -> Float64Array:
        """Return the unknowns of a fit of cells of the same shots."""
        state: Float64Array = np.r_[
            fit.weights, fit.matrix.ravel(), fit.local, fit.corner, fit.tilts.ravel(), fit.offsets[1:]
        ]
        return state

    def unpacked(self, state: Float64Array, weight: Float64Array) -> PairFit:
        """Return the fit, with its covariance."""
        size = self.size
        jacobian = self.jacobian(state, weight)
        logs = self.log_light(state)
        residual = self.cells.codes / 255 - self.model.values(state[:size], logs).brightness
        return PairFit(
            weights=state[:size],
            matrix=state[size : size + 9].reshape(3, 3),
            local=float(state[size + 9]),
            corner=float(state[size + 10]),
            tilts=state[size + 11 : size + 11 + 2 * self.shots].reshape(-1, 2),
            offsets=np.r_[0.0, state[size + 11 + 2 * self.shots :]],
            covariance=np.asarray(np.linalg.inv(jacobian.T @ jacobian)[:size, :size], np.float64),
            log_light=logs,
            residual=np.where((weight > 0) & self.is_open, residual, np.nan),
            headroom=self.headroom(state),
            outliers=float((weight[self.counts(state)] == 0).mean()),
        )

    def light(self, state: Float64Array) -> Float64Array:
        """Return the light behind the matrix, (N, 3)."""
        return self.cells.light @ state[self.size : self.size + 9].reshape(3, 3).T

    def log_light(self, state: Float64Array) -> Float64Array:
        """Return log2 of the light that the response takes, (N, 3)."""
        stops = self.causes @ state[self.size + 9 :]
        return np.asarray(np.log2(np.maximum(self.light(state), FLOOR)) + stops[:, None])

    def counts(self, state: Float64Array) -> BoolArray:
        """Return which channels count: those neither clipped in a mixture, nor faint against the cell's brightest."""
        light = self.light(state)
        is_faint = light < np.maximum(FAINT * light.max(axis=1, keepdims=True), FLOOR)
        return np.asarray((self.is_open | self.is_white) & ~is_faint)

    def reweighted(self, state: Float64Array, *, leaves_out: bool) -> Float64Array:
        """Return the weights of the residuals of cells by Huber's cost."""
        scaled = np.abs(self.off(state)) / self.cells.deviation * 255
        typical = max(1.0, float(np.median(scaled[self.counts(state)])) / 0.67)
        weight = np.sqrt(np.minimum(1, HUBER * typical / np.maximum(scaled, 1e-9))) / typical
        return np.where(self.counts(state) & ~(leaves_out & (scaled > OUTLIER * typical)), weight, 0.0)

    def off(self, state: Float64Array) -> Float64Array:
        """Return brightness less the model's, (N, 3); of white cells, how much the model lacks to white."""
        brightness = self.model.values(state[: self.size], self.log_light(state)).brightness
        lacking = np.maximum(WHITE_BRIGHTNESS - brightness, 0)
        return np.where(self.is_white, lacking, self.cells.codes / 255 - brightness)

    def residuals(self, state: Float64Array, weight: Float64Array) -> Float64Array:
        """Return the residuals of cells, and of the priors, in standard deviations."""
        cells = self.off(state) * weight * self.precision
        weights = state[: self.size]
        return np.concatenate(
            [
                cells.ravel(),
                self.root @ (weights - self.mean),
                self.model.low_slopes(weights)[0],
                state[self.size + 9 :] / self.deviations,
                [(self.headroom(state) - self.expected[0]) / self.expected[1]],
            ]
        )

    def jacobian(self, state: Float64Array, weight: Float64Array) -> Float64Array:
        """Return the derivatives of `residuals`."""
        size, count = self.size, len(state)
        values = self.model.values(state[:size], self.log_light(state))
        counts = weight * self.precision * (~self.is_white | (values.brightness < WHITE_BRIGHTNESS))
        light = np.maximum(self.light(state), FLOOR)
        cells = np.zeros((*light.shape, count))
        cells[..., :size] = values.gradient
        for channel in range(3):
            columns = slice(size + 3 * channel, size + 3 * channel + 3)
            cells[:, channel, columns] = (values.slope / light)[:, channel, None] / np.log(2) * self.cells.light
        cells[..., size + 9 :] = values.slope[..., None] * self.causes[:, None]
        rows = self.model.low_slopes(state[:size])[1]
        priors = np.zeros((size + len(rows) + len(self.deviations) + 1, count))
        priors[:size, :size] = self.root
        priors[size : size + len(rows), :size] = -rows
        priors[size + len(rows) : -1, size + 9 :] = np.diag(1 / self.deviations)
        log_light = np.log(2) * 3 * (state[size : size + 9].reshape(3, 3) @ self.saturation)
        priors[-1, size : size + 9] = (self.saturation / log_light[:, None] / self.expected[1]).ravel()
        return np.concatenate([-(cells * counts[..., None]).reshape(-1, count), priors])

    def headroom(self, state: Float64Array) -> float:
        """Return the stops by which raw saturation of white lies above white: the mean of the channels."""
        light = state[self.size : self.size + 9].reshape(3, 3) @ self.saturation
        return float(np.log2(np.maximum(light, FLOOR)).mean())
