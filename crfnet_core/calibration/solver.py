"""Response, exposures and irradiances that explain a stack (Eq. C.2)."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.calibration.blocks import Observations
from crfnet_core.calibration.curve_model import HIGHEST, LOWEST, CurveModel
from crfnet_core.calibration.robust import FittedResponse, ResponseProblem, huber_weight
from crfnet_core.types import Float64Array

#: Prior standard deviations in stops of a frame's exposure around its label, and of the other channels' around
#: green's: cameras that change the white balance between frames leave green alone.
TIME_DEVIATION, BALANCE_DEVIATION = 0.05, 0.3

#: The same, in stops a stop, of the trend of green's offsets over the exposures. A power of the exposures cannot be
#: distinguished from a power in the response, so the labels decide.
TREND_DEVIATION = 5e-4

#: Steps to the irradiances at most, and the longest last one in stops.
MOST_STEPS, LAST_STEP = 12, 1e-4


@dataclass(frozen=True, eq=False)
class StackFit(FittedResponse):
    """The response and exposures that explain a stack, and the light of M samples in T frames, (M, T)."""

    offsets: Float64Array  # (T, C): stops by which each frame is brighter than its label, in each channel
    cost: float  # Eq. C.2


def fit_stack(seen: Observations, exposures: Float64Array, weights: Float64Array) -> StackFit:
    """Return the most likely response, exposures and irradiances, beginning at the weights of a response, (K,).

    Source: the model of Mann and Picard (1995) and of Debevec and Malik (1997), with the response as a forward model.
    """
    problem = _StackProblem(seen, exposures, weights)
    state = problem.solved(np.append(weights, problem.center[problem.size :]))
    offsets = problem.offsets @ state[problem.size :]
    log_light = problem.irradiance(state)[:, None] + exposures + offsets.T[seen.channel]
    brightness, _ = problem.model.brightness(state[: problem.size], log_light)
    return StackFit(
        weights=state[: problem.size],
        covariance=problem.covariance(state),
        log_light=log_light,
        residual=np.where(seen.is_used, seen.brightness - brightness, np.nan),
        offsets=offsets,
        cost=problem.cost(state),
    )


def rough_irradiance(seen: Observations, exposures: Float64Array, weights: Float64Array) -> Float64Array:
    """Return log2 of each sample's irradiance under a response, shape (M,): the mean over frames, NaN if none shows it.

    Frames count by their slope df/du, so that the best exposed ones decide.
    """
    model = CurveModel.load()
    stops = model.log_irradiance(weights, seen.brightness)
    weight = seen.is_used * model.brightness(weights, stops)[1] ** 2
    total = weight.sum(axis=1)
    mean = (weight * (stops - exposures)).sum(axis=1) / np.maximum(total, 1e-12)
    return np.where(total > 0, mean, np.nan)


class _StackProblem(ResponseProblem):
    """Least squares for a stack: the unknowns beside the weights make the offsets of its frames by way of `offsets`.

    These are the time of a frame, which its channels share, and the white balance of each channel but green. The
    irradiances of the samples are thousands, but each touches a few observations only.
    """

    def __init__(self, seen: Observations, exposures: Float64Array, weights: Float64Array) -> None:
        self.sample, self.frame = at = np.nonzero(seen.is_used | seen.is_white)
        channels = int(seen.channel.max()) + 1
        spread = np.tile([TIME_DEVIATION] + [BALANCE_DEVIATION] * (channels - 1), len(exposures))
        super().__init__(seen.brightness[at], seen.deviation[at], seen.is_white[at], spread)
        each = np.insert(np.eye(channels)[:, np.arange(channels) != channels // 2], 0, 1, axis=1)
        self.offsets = np.asarray(np.kron(np.eye(len(exposures))[:, None], each), dtype=np.float64)  # (T, C, R)
        self.log_irradiance = rough_irradiance(seen, exposures, weights)
        self.starts = np.flatnonzero(np.diff(self.sample, prepend=-1))
        self.exposure = exposures[self.frame]
        self.rows = self.offsets[self.frame, seen.channel[self.sample]]
        slope = (exposures - exposures.mean()) / (np.ptp(exposures) ** 2 * len(exposures) / 12)
        self.trend = np.asarray(slope @ self.offsets[:, channels // 2] / TREND_DEVIATION, dtype=np.float64)

    def light(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return log2 of the light, and its derivatives by the offsets' unknowns at constant irradiance."""
        return np.asarray(self.irradiance(state)[self.sample] + self.stops(state)), self.rows

    def stops(self, state: Float64Array) -> Float64Array:
        """Return the exposure of every observation, in stops."""
        return np.asarray(self.exposure + self.rows @ state[self.size :])

    def irradiance(self, state: Float64Array) -> Float64Array:
        """Return log2 of the irradiance that explains each sample best, shape (M,), near `log_irradiance`."""
        stops, found = self.stops(state), self.log_irradiance
        for _ in range(MOST_STEPS):
            off, slope = self.off(state, found[self.sample] + stops)
            pull = huber_weight(off / self.deviation) * slope / self.deviation**2
            step = np.clip(self._sums(pull * off) / (self._sums(pull * slope) + 1e-5), -1, 1)
            found = np.clip(found + step, LOWEST, HIGHEST + 8)
            if np.abs(step).max() < LAST_STEP:
                break
        return np.asarray(found)

    def constraint(self, others: Float64Array) -> tuple[float, Float64Array]:
        """Return the trend of green's offsets, which is 0."""
        return float(self.trend @ others), self.trend

    def normal_equations(self, state: Float64Array) -> tuple[Float64Array, Float64Array]:
        """Return the same; the next irradiances are near the ones here."""
        self.log_irradiance = self.irradiance(state)
        return super().normal_equations(state)

    def _sums(self, values: Float64Array) -> Float64Array:
        """Return the sums over the observations of every sample, shape (M,)."""
        return np.bincount(self.sample, values, len(self.log_irradiance)).astype(np.float64)
