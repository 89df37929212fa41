"""From observations to an anchored response: start, fit, anchor; frames and samples that do not fit are left out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from crfnet_core.calibration.anchor import Anchor, find_white
from crfnet_core.calibration.blocks import Observations, pick_blocks
from crfnet_core.calibration.curve_model import CurveModel
from crfnet_core.calibration.frames import LEAST_FRAMES
from crfnet_core.calibration.solver import StackFit, fit_stack
from crfnet_core.errors import CalibrationError, beside_limits
from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import SAMPLES, ResponseCurve
from crfnet_core.types import BoolArray, Float64Array

#: Fits with the anchor corrected in between.
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


#: Samples that the known responses are compared on, and the seed of their choice.
COMPARED, SEED = 400, 0

#: Largest disagreement in 8-bit codes that counts: beyond, a sample is an outlier.
LARGEST_SPREAD = 20.0

#: Stops that a code is at least worth: where it is worth less, it does not separate responses.
LEAST_STOPS = 0.004


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


def measure(every: Observations, exposures: Float64Array, model: CurveModel) -> Measurement:
    """Return the response that explains the samples of all blocks; frames and samples that do not fit are left out.

    `exposures` are the labels in stops, shape (T,).

    Raise CalibrationError if too few blocks are seen often (see `pick_blocks`), or frames do not fit and the rest spans
    too few stops.
    """
    frames = np.ones(len(exposures), dtype=bool)
    while True:
        within, stops = every.in_frames(frames), exposures[frames]
        known = best_known_response(within, stops)
        seen = pick_blocks(within, rough_irradiance(within, stops, known))
        measurement = fit_and_anchor(seen, stops, model, known)
        worst = _worst_frame(measurement.fit)
        if worst is None or frames.sum() < LEAST_FRAMES:
            break
        frames[np.flatnonzero(frames)[worst]] = False
        _check_rest(exposures[frames], len(frames))
    is_outlier = _outliers(seen, measurement.fit)
    if is_outlier.any() and not is_outlier.all():
        measurement = fit_and_anchor(seen.subset(~is_outlier), stops, model, measurement.curve)
    return replace(measurement, frames=frames, outliers=float(is_outlier.mean()))


def fit_and_anchor(
    seen: Observations, exposures: Float64Array, model: CurveModel, start: ResponseCurve, *, rounds: int = ROUNDS
) -> Measurement:
    """Return the response of some samples in all their frames, beginning at a response that is near."""
    curve = start
    irradiance = rough_irradiance(seen, exposures, start)
    for _ in range(rounds):
        fit = fit_stack(seen, exposures, model, model.weights_of(curve), irradiance)
        anchor = find_white(seen, exposures, model, fit)
        curve = model.response(fit.weights, log_white=anchor.log_white)
        irradiance = fit.log_irradiance - anchor.log_white
    return Measurement(seen, exposures, np.ones(len(exposures), dtype=bool), fit, anchor, curve, 0.0)


def best_known_response(seen: Observations, exposures: Float64Array) -> ResponseCurve:
    """Return the response of the packaged bank under which samples have the same irradiance in every frame.

    The measure is the mean spread over frames of log2 g(B) less the exposure, in units of the spread that one code of
    noise makes. Source: Mitsunaga and Nayar, "Radiometric self calibration", CVPR 1999.
    """
    bank = ResponseBank.load()
    rng = np.random.default_rng(SEED)
    often = np.flatnonzero(seen.is_used.sum(axis=1) >= 2)
    some = seen.subset(rng.permutation(often)[:COMPARED])
    tables = bank.log_irradiance[bank.ordinary]
    code = np.rint(some.brightness * (SAMPLES - 1)).astype(np.intp)
    noise = np.gradient(tables, axis=1) * np.float32((SAMPLES - 1) / 255)
    disagreement = np.zeros(len(tables))
    for start in range(0, len(tables), 256):
        part = slice(start, start + 256)
        logs = tables[part][:, code] - exposures.astype(np.float32)  # (256, M, T)
        per_code = np.maximum(noise[part][:, code], LEAST_STOPS)
        weight = np.where(some.is_used, per_code**-2, 0)
        mean = (weight * logs).sum(axis=2, keepdims=True) / np.maximum(weight.sum(axis=2, keepdims=True), 1e-9)
        codes_off = np.where(some.is_used, np.minimum(np.abs(logs - mean) / per_code, LARGEST_SPREAD), 0)
        disagreement[part] = (codes_off**2).sum(axis=(1, 2))
    best = int(disagreement.argmin())
    return ResponseCurve.from_samples(bank.brightness[bank.ordinary][best])


def rough_irradiance(seen: Observations, exposures: Float64Array, curve: ResponseCurve) -> Float64Array:
    """Return log2 of each sample's irradiance under a response, shape (M,): the mean over frames, NaN if none shows it.

    Frames count by their slope df/du, so that the best exposed ones decide.
    """
    codes = np.linspace(0, 1, SAMPLES)
    table = np.log2(np.maximum(curve.inverse(codes), 2.0**-14))  # the least of `CurveModel`'s table
    slope = 1 / np.maximum(np.gradient(table, codes), 1e-3)
    index = np.rint(seen.brightness * (SAMPLES - 1)).astype(np.intp)
    weight = seen.is_used * slope[index] ** 2
    total = weight.sum(axis=1)
    mean = (weight * (table[index] - exposures)).sum(axis=1) / np.maximum(total, 1e-12)
    return np.where(total > 0, mean, np.nan)


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
