"""One response and one color matrix that explain the cells of raw files and their JPEGs (Eq. C.6)."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.calibration.curve_model import in_camera_mean
from crfnet_core.calibration.raw_pairs.cells import Cells
from crfnet_core.calibration.robust import FittedResponse, ResponseProblem
from crfnet_core.types import BoolArray, Float64Array

#: Expected deviations beyond which a residual does not count.
OUTLIER = 6.0

#: Part of a cell's brightest channel below which another does not count: gamut compression changes it.
FAINT = 0.25

#: Prior standard deviations: local tone mapping, vignetting at the corner in stops, a gradient from the center to a
#: corner in stops, a shot's exposure in stops; and the entries of the matrix, for channels of which nothing counts.
LOCAL_DEVIATION, CORNER_DEVIATION, TILT_DEVIATION, SHOT_DEVIATION, MATRIX_DEVIATION = 0.2, 0.5, 0.1, 0.1, 100.0

#: Stops by which raw saturation of white lies above the JPEG's white: the prior mean and its standard deviation.
HEADROOM = (0.2, 0.3)

#: Rounds of reweighting, and those that do not yet leave outliers out.
ROUNDS, LENIENT = 5, 2

#: The least light, white = 1.
FLOOR = 2.0**-14


@dataclass(frozen=True, eq=False)
class PairFit(FittedResponse):
    """A response, and the way from raw light to the light that it takes."""

    matrix: Float64Array  # (3, 3): from balanced raw light to the light of the response, whose white is 1
    local: float  # exponent of the surroundings' light in the gain: 0 without local tone mapping
    corner: float  # stops by which the corner is brightened
    tilts: Float64Array  # (S, 2): stops a place (see `Cells.place`) by which each shot brightens, right and down
    offsets: Float64Array  # (S,): stops by which each shot is brighter than the first; its own is 0
    state: Float64Array  # all unknowns: see `_PairProblem`
    headroom: float  # stops by which raw saturation of a white surface lies above white
    outliers: float  # fraction of what could count that fits in no way


def fit_pairs(cells: Cells, start: PairFit | None = None, *, headroom: tuple[float, float] = HEADROOM) -> PairFit:
    """Return the response and matrix that explain cells, given the prior of `PairFit.headroom`."""
    problem = _PairProblem(cells, headroom)
    state = problem.start() if start is None else start.state
    problem.reweight(state, np.hypot(1, problem.chroma))
    for number in range(ROUNDS):
        state = problem.solved(state)
        problem.reweight_by_errors(state, leaves_out=number >= LENIENT)
    return problem.unpacked(state)


class _PairProblem(ResponseProblem):
    """Least squares for pairs: the unknowns are the weights, the matrix row by row, and the stops of each cause.

    Causes are the surroundings, the corner, the tilt of each shot, and the offset of each but the first. Observations
    are the three channels of one cell after the other.
    """

    def __init__(self, cells: Cells, headroom: tuple[float, float]) -> None:
        codes, self.is_open = cells.codes, cells.is_open & ~cells.is_saturated[:, None]
        is_white = cells.is_white & (codes.min(axis=1, keepdims=True) > 200) & ~cells.is_saturated[:, None]
        self.cells, self.expected, shots = cells, headroom, cells.shot.shape[1]
        tilts = (cells.shot[:, :, None] * cells.place[:, None]).reshape(len(codes), -1)
        corner = (cells.place**2).sum(axis=1)
        self.causes = np.column_stack([cells.surroundings, corner, tilts, cells.shot[:, 1:]])
        of_shots = [TILT_DEVIATION] * 2 * shots + [SHOT_DEVIATION] * (shots - 1)
        spread = np.array([MATRIX_DEVIATION] * 9 + [LOCAL_DEVIATION, CORNER_DEVIATION, *of_shots])
        super().__init__(codes.ravel() / 255, cells.deviation.ravel() / 255, is_white.ravel(), spread)
        self.chroma = np.ptp(codes, axis=1, keepdims=True) / np.maximum(codes.max(axis=1, keepdims=True), 1) / 0.35

    def start(self) -> Float64Array:
        """Return the mean response and a neutral matrix of the scale at which gray cells fit."""
        light = in_camera_mean().inverse(self.cells.codes / 255)
        known = self.is_open & (self.cells.codes > 20) & (self.cells.light > 1e-4)
        scale = np.exp2(np.median(np.log2(light[known] / self.cells.light[known])))
        state = self.center.copy()
        state[self.size : self.size + 9] = (scale * np.eye(3)).ravel()
        return state

    def unpacked(self, state: Float64Array) -> PairFit:
        """Return the fit, with its covariance."""
        shots = self.cells.shot.shape[1]
        ends = np.cumsum([self.size, 9, 2, 2 * shots])
        weights, matrix, (local, corner), tilts, offsets = np.split(state, ends)
        counts, log_light = np.isfinite(self.deviation).reshape(-1, 3), self.light(state)[0].reshape(-1, 3)
        brightness, _ = self.model.brightness(weights, log_light)
        return PairFit(
            weights=weights,
            matrix=matrix.reshape(3, 3),
            local=float(local),
            corner=float(corner),
            tilts=tilts.reshape(shots, 2),
            offsets=np.append(0.0, offsets),
            covariance=self.covariance(state),
            log_light=log_light,
            residual=np.where(counts & self.is_open, self.cells.codes / 255 - brightness, np.nan),
            state=state,
            headroom=_headroom(matrix.reshape(3, 3).sum(axis=1)),
            outliers=float(1 - counts[self.counts(state)].mean()),
        )

    def light(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return log2 of the light that the response takes, and its derivatives by the matrix and the causes."""
        stops = self.causes @ state[self.size + 9 :]
        behind = self.behind_matrix(state)
        relative = self.cells.light[:, None] / behind[..., None] / np.log(2)
        by_matrix = np.einsum("ncd,ce->nced", relative, np.eye(3)).reshape(-1, 9)
        return (np.log2(behind) + stops[:, None]).ravel(), np.hstack([by_matrix, np.repeat(self.causes, 3, axis=0)])

    def behind_matrix(self, state: Float64Array) -> Float64Array:
        """Return the light behind the matrix, (N, 3)."""
        matrix = state[self.size : self.size + 9].reshape(3, 3)
        return np.maximum(self.cells.light @ matrix.T, FLOOR)

    def constraint(self, others: Float64Array) -> tuple[float, Float64Array]:
        """Return the distance of raw saturation from white, less the expected one."""
        white, (mean, deviation), row = others[:9].reshape(3, 3).sum(axis=1), self.expected, 0 * others
        row[:9] = np.repeat(1 / (3 * np.log(2) * white), 3) / deviation
        return (_headroom(white) - mean) / deviation, row

    def counts(self, state: Float64Array) -> BoolArray:
        """Return which channels of cells count: those neither clipped in a mixture, nor faint against the brightest."""
        light = self.behind_matrix(state)
        is_faint = light <= np.maximum(FAINT * light.max(axis=1, keepdims=True), FLOOR)
        return np.asarray((self.is_open | self.is_white.reshape(-1, 3)) & ~is_faint)

    def reweight(self, state: Float64Array, factor: Float64Array | float) -> None:
        """Set the deviations of what counts to so many times the expected ones."""
        deviation = np.where(self.counts(state), self.cells.deviation / 255 * factor, np.inf)
        self.deviation = deviation.ravel()

    def reweight_by_errors(self, state: Float64Array, *, leaves_out: bool) -> None:
        """Set the deviations to as many times the expected ones as the typical error has, without the outliers."""
        off, _ = self.off(state, self.light(state)[0])
        scaled = np.abs(off.reshape(-1, 3)) / self.cells.deviation * 255
        typical = max(1.0, float(np.median(scaled[self.counts(state)])) / 0.67)
        is_outlier = leaves_out & (scaled > OUTLIER * typical)
        self.reweight(state, np.where(is_outlier, np.inf, typical))


def _headroom(white: Float64Array) -> float:
    """Return the stops from white to the light of a saturated white surface: the mean of the channels."""
    return float(np.log2(np.maximum(white, FLOOR)).mean())
