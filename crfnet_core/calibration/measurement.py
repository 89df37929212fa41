"""From observations to an anchored response: start, fit, anchor; frames and samples that do not fit are left out."""

from dataclasses import dataclass, replace

import numpy as np

from crfnet_core.calibration.anchor import Anchor, find_white
from crfnet_core.calibration.blocks import Observations, pick_blocks
from crfnet_core.calibration.curve_model import CurveModel
from crfnet_core.calibration.frames import LEAST_FRAMES
from crfnet_core.calibration.solver import StackFit, fit_stack, rough_irradiance
from crfnet_core.errors import CalibrationError, beside_limits
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import BoolArray, Float64Array

#: Fits from different starts.
ROUNDS = 2

#: Residual in 8-bit codes from which a frame does not fit, and by which factor it has to exceed the others.
WORST_FRAME, WORSE_THAN_OTHERS = 4.0, 2.0

#: Stops that the frames that fit each other have to span, fewer than a whole stack: over one stop, whose labels may be
#: 1/15 and 1/8 s, the shape of 22 of 23 simulated stacks was within two of its stated standard deviations; over a third
#: of a stop the scale of every second one was not, and over none no solution exists.
LEAST_REST = 0.9

#: A sample is an outlier if its largest residual, in expected standard deviations, exceeds this many times that of the
#: median sample, or this many if the median is below 1.
OUTLIER = 5.0


@dataclass(frozen=True, eq=False)
class Measurement:
    """An anchored response, and the samples that it was measured on."""

    seen: Observations  # the samples that were used, in the frames that were used
    exposures: Float64Array  # (T,): the labels of these frames, in stops
    frames: BoolArray  # (all frames,): which frames these are
    fit: StackFit  # its unit of irradiance is white but for `anchor`
    anchor: Anchor  # where white is in that unit
    curve: ResponseCurve  # the response, in parts of white; see `crfnet_core.calibration.curve_model.in_file_codes`
    outliers: float  # fraction of the samples that were left out

    @property
    def residual(self) -> float:
        """Root mean square of brightness less the model's, white = 255."""
        return float(255 * np.sqrt(np.nanmean(self.fit.residual**2)))


def measure(every: Observations, exposures: Float64Array) -> Measurement:
    """Return the response that explains the samples of all blocks; frames and samples that do not fit are left out.

    `exposures` are the labels in stops, shape (T,).

    Raise CalibrationError if too few blocks are seen often (see `pick_blocks`), or frames do not fit and the rest spans
    too few stops.
    """
    frames, start = np.ones(len(exposures), dtype=bool), CurveModel.load().center
    while True:
        within, stops = every.in_frames(frames), exposures[frames]
        seen = pick_blocks(within, rough_irradiance(within, stops, start))
        measurement = fit_and_anchor(seen, stops, start)
        worst = _worst_frame(measurement.fit)
        if worst is None or frames.sum() < LEAST_FRAMES:
            break
        frames[np.flatnonzero(frames)[worst]] = False
        _check_rest(exposures[frames], len(frames))
    is_outlier = _outliers(seen, measurement.fit)
    if is_outlier.any() and not is_outlier.all():
        measurement = fit_and_anchor(seen.subset(~is_outlier), stops, measurement.fit.weights)
    return replace(measurement, frames=frames, outliers=float(is_outlier.mean()))


def fit_and_anchor(
    seen: Observations, exposures: Float64Array, start: Float64Array, *, rounds: int = ROUNDS
) -> Measurement:
    """Return the response of some samples in all their frames, beginning at the weights of a response that is near.

    Each round begins at the anchored response of the one before; the fit of least cost counts.
    """
    found = []
    for _ in range(rounds):
        fit = fit_stack(seen, exposures, start)
        anchor = find_white(seen, exposures, fit)
        curve = fit.response(log_white=anchor.log_white)
        start = CurveModel.load().weights_of(curve)
        found.append(Measurement(seen, exposures, np.ones(len(exposures), dtype=bool), fit, anchor, curve, 0.0))
    return min(found, key=lambda measurement: measurement.fit.cost)


def frame_residuals(fit: StackFit) -> Float64Array:
    """Return the root mean square residual of each frame, white = 255, shape (T,); 0 where it shows nothing."""
    squares = np.where(np.isfinite(fit.residual), fit.residual, 0) ** 2
    count = np.isfinite(fit.residual).sum(axis=0)
    return np.asarray(255 * np.sqrt(squares.sum(axis=0) / np.maximum(count, 1)), dtype=np.float64)


def _worst_frame(fit: StackFit) -> int | None:
    """Return the frame that does not fit, if there is one."""
    residuals = frame_residuals(fit)
    worst = int(residuals.argmax())
    others = float(np.median(np.delete(residuals, worst)))
    return worst if residuals[worst] > max(WORST_FRAME, WORSE_THAN_OTHERS * others) else None


def _check_rest(stops: Float64Array, count: int) -> None:
    """Refuse the frames that fit each other, of `count` frames, if their exposures span too few stops."""
    if (span := float(np.ptp(stops))) < LEAST_REST:
        span_text = beside_limits(span, LEAST_REST)
        raise CalibrationError("rest_span", unfit=count - len(stops), count=count, span=span_text, least=LEAST_REST)


def _outliers(seen: Observations, fit: StackFit) -> BoolArray:
    """Return which samples do not fit in some frame, shape (M,)."""
    scaled = np.abs(np.where(np.isfinite(fit.residual), fit.residual, 0)) / seen.deviation
    worst = scaled.max(axis=1)
    return np.asarray(worst > OUTLIER * max(1.0, float(np.median(worst))), dtype=bool)
