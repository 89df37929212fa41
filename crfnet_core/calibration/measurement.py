"""From observations to a response whose scale is where codes reach white (Eq. C.3), and how far it may be off."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from crfnet_core.calibration.blocks import PARTLY_WHITE, Observations, pick_blocks
from crfnet_core.calibration.curve_model import CurveModel, in_file_codes
from crfnet_core.calibration.frames import LEAST_FRAMES
from crfnet_core.calibration.measured import CHANNEL_PART, Uncertainty
from crfnet_core.calibration.robust import rms_codes
from crfnet_core.calibration.solver import TIME_DEVIATION, StackFit, fit_stack, rough_irradiance
from crfnet_core.errors import CalibrationError, beside_limits
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE, scale_error, shape_error
from crfnet_core.types import BoolArray, Float64Array

#: Fits from different starts.
ROUNDS = 2

#: Residual in 8-bit codes from which a frame does not fit, and by which factor it has to exceed the others.
WORST_FRAME, WORSE_THAN_OTHERS = 4.0, 2.0

#: Stops that the frames that fit each other have to span: over one, whose labels may be 1/15 and 1/8 s, the shape of 22
#: of 23 simulated stacks was within two of its stated deviations; over a third the scale of every second was not.
LEAST_REST = 0.9

#: A sample is an outlier if its largest residual, in expected standard deviations, exceeds this many times that of the
#: median sample, or this many if the median is below 1.
OUTLIER = 5.0

#: 8-bit codes from which the crossing is extrapolated in a straight line, and through which the parabola leads.
LINE_FROM, PARABOLA_FROM, LAST_CODE, WHITE_CODE = 252, 240, 254, 254.5

#: Samples that have to be white in one frame and measured in another for the crossing to be known, and the fraction of
#: these, the flattest, that it is looked for in.
LEAST_CROSSINGS, FLATTEST = 30, 0.5

#: Stops below the crossing in which the fraction of white pixels is taken, and the fraction that noise makes there.
BELOW, NOISE_BELOW = 0.5, 0.02

#: Standard deviation in stops of the anchor where its methods agree (the end of a response is seen in steps of a code),
#: and where no frame reaches white (the end comes from known responses).
LEAST_DEVIATION, UNSEEN_DEVIATION = 0.02, 0.4

#: The rest in stops where nothing disagrees (blocks are not flat, JPEG, the model), and the least samples of a channel
#: for a response of its own.
LEAST_SHAPE, LEAST_SCALE, LEAST_SAMPLES = 0.01, 0.02, 60


@dataclass(frozen=True)
class Anchor:
    """The irradiance at which the codes reach white."""

    log_white: float  # log2 of the irradiance of white, in the units of the fit; 0 if the fit has it right
    deviation: float  # its standard deviation in stops
    is_seen: bool  # whether samples reach white in some frame and are measured in another


@dataclass(frozen=True, eq=False)
class Measurement:
    """An anchored response, and the samples that it was measured on."""

    seen: Observations  # the samples that were used, in the frames that were used
    exposures: Float64Array  # (T,): the labels of these frames, in stops
    fit: StackFit  # its unit of irradiance is white but for `anchor`
    anchor: Anchor  # where white is in that unit
    curve: ResponseCurve  # the response, in parts of white; see `crfnet_core.calibration.curve_model.in_file_codes`
    frames: BoolArray  # (all frames,): which frames were used
    outliers: float = 0.0  # fraction of the samples that were left out


def measure(every: Observations, exposures: Float64Array) -> Measurement:
    """Return the response that explains the samples of all blocks; frames and samples that do not fit are left out.

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
        if (span := float(np.ptp(exposures[frames]))) < LEAST_REST:
            facts = {"unfit": int((~frames).sum()), "count": len(frames), "least": LEAST_REST}
            raise CalibrationError("rest_span", span=beside_limits(span, LEAST_REST), **facts)
    off = (np.abs(np.nan_to_num(measurement.fit.residual)) / seen.deviation).max(axis=1)
    is_outlier = off > OUTLIER * max(1.0, float(np.median(off)))
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
        anchor = find_white(seen, fit)
        curve = fit.response(log_white=anchor.log_white)
        start = CurveModel.load().weights_of(curve)
        found.append(Measurement(seen, exposures, fit, anchor, curve, frames=np.ones(len(exposures), dtype=bool)))
    return min(found, key=lambda measurement: measurement.fit.cost)


def find_white(seen: Observations, fit: StackFit) -> Anchor:
    """Return where white is (Eq. C.3), and its deviation (Eq. C.5).

    Two ways: the irradiance at which half the pixels of flat samples are white, which counts twice; and a parabola over
    the last codes of the fitted curve. Where surfaces have texture, both find white too high, by about the blur.
    """
    crosses = seen.is_white.any(axis=1) & seen.is_used.any(axis=1)
    if crosses.sum() < LEAST_CROSSINGS:
        return Anchor(0.0, UNSEEN_DEVIATION, is_seen=False)
    codes = np.arange(PARABOLA_FROM, LAST_CODE + 1)
    irradiance = np.exp2(CurveModel.load().log_irradiance(fit.weights, codes / 255))
    parabola = np.polyfit(codes / 255 - 1, irradiance, 2)[-1]
    parabolic = float(np.log2(max(parabola, irradiance[-1])))
    crossing, blur = _crossing(seen, fit.log_light)
    per_code = max(np.exp2(crossing) - irradiance[LINE_FROM - PARABOLA_FROM], 0) / (WHITE_CODE - LINE_FROM)
    crossed = float(np.log2(np.exp2(crossing) + per_code * (255 - WHITE_CODE)))
    parts = (LEAST_DEVIATION, (crossed - parabolic) / 2, blur / 2, crossed - crossing)
    return Anchor((2 * crossed + parabolic) / 3 - blur, float(np.linalg.norm(parts)), is_seen=True)


def _crossing(seen: Observations, log_exposed: Float64Array) -> tuple[float, float]:
    """Return log2 of the irradiance that parts white pixels from others best, over the flattest samples; and its blur.

    The blur, in stops, is the fraction of white pixels below, as far as it is more than noise makes.
    """
    partly = (seen.white_fraction > PARTLY_WHITE).any(axis=1)
    flat = seen.spread <= np.quantile(seen.spread[partly], FLATTEST)
    order = log_exposed[flat].ravel().argsort()
    stops, white = log_exposed[flat].ravel()[order], seen.white_fraction[flat].ravel()[order]
    near = np.abs(stops - stops[np.cumsum(white - 0.5).argmin()]) < 1
    stops, white = stops[near], white[near]
    crossing = float(stops[np.cumsum(white - 0.5).argmin()])
    below = white[(stops < crossing) & (stops > crossing - BELOW)]
    return crossing, max(float(below.mean()) - NOISE_BELOW, 0.0) if len(below) else 0.0


def frame_residuals(fit: StackFit) -> Float64Array:
    """Return the root mean square residual of each frame, white = 255, shape (T,); 0 where it shows nothing."""
    return np.nan_to_num([rms_codes(frame) for frame in fit.residual.T])


def _worst_frame(fit: StackFit) -> int | None:
    """Return the frame that does not fit, if there is one."""
    residuals = frame_residuals(fit)
    worst = int(residuals.argmax())
    others = float(np.median(np.delete(residuals, worst)))
    return worst if residuals[worst] > max(WORST_FRAME, WORSE_THAN_OTHERS * others) else None


def uncertainty_of(measurement: Measurement, other_labels: ResponseCurve | None, *, white: float) -> Uncertainty:
    """Return how far a measured response may be off, at the codes of the file (Eq. C.4 and C.5).

    `white` is as in `Calibration`, `other_labels` the response by the other reading of the exposure labels, if any.
    """
    even = measurement.seen.block % 2 == 0
    halves = [_curve_of(measurement.seen.subset(part), measurement.exposures, measurement) for part in (even, ~even)]
    alone = []
    for channel, offsets in enumerate(measurement.fit.offsets.T):  # the exposures that all channels found for it
        part = measurement.seen.subset(measurement.seen.channel == channel)
        gray = replace(part, channel=np.zeros_like(part.channel))
        alone.append(_curve_of(gray, measurement.exposures + offsets, measurement))
    curve, other, first, second, *channels = (
        in_file_codes(each, white) for each in (measurement.curve, other_labels or measurement.curve, *halves, *alone)
    )

    def disagreements(error: Callable[[ResponseCurve, ResponseCurve], float]) -> dict[str, float]:
        """Return how far responses are apart that should be one."""
        return {
            "sampling": abs(error(first, second)) / 2,
            "channels": CHANNEL_PART * float(np.sqrt(np.mean([error(curve, each) ** 2 for each in channels]))),
            "labels": abs(error(curve, other)) / 2,
        }

    codes = np.minimum(np.arange(FIRST_SHAPE_CODE, LAST_SHAPE_CODE + 1) / 255 / white, 1)  # white = 1
    shape, scale = measurement.fit.deviations(codes)
    trend = TIME_DEVIATION / np.linalg.norm(measurement.exposures - measurement.exposures.mean())
    times = float(trend * np.log2(measurement.curve.inverse(codes)).std())
    return Uncertainty(
        {"posterior": shape, **disagreements(shape_error), "times": times, "least": LEAST_SHAPE},
        {"posterior": scale, **disagreements(scale_error), "white": measurement.anchor.deviation, "least": LEAST_SCALE},
    )


def _curve_of(seen: Observations, exposures: Float64Array, measurement: Measurement) -> ResponseCurve:
    """Return the response of a part of the samples, or of all if the part is too small."""
    if len(seen.block) < LEAST_SAMPLES:
        return measurement.curve
    return fit_and_anchor(seen, exposures, measurement.fit.weights, rounds=1).curve
