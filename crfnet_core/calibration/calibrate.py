"""Measure a camera's response from an exposure stack: the whole of it on one screen; and the door to raw pairs."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from crfnet_core.calibration import checks
from crfnet_core.calibration.alignment import Shift
from crfnet_core.calibration.blocks import Observations, block_means, observe
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.calibration.exposures import Exposures, stack_exposures
from crfnet_core.calibration.frames import Frame, align, read_frames, white_level
from crfnet_core.calibration.measured import Calibration, FrameReport, PairCalibration
from crfnet_core.calibration.measurement import Measurement, fit_and_anchor, frame_residuals, measure, uncertainty_of
from crfnet_core.calibration.robust import rms_codes
from crfnet_core.errors import CalibrationError
from crfnet_core.photograph.metadata.devices import Device, device_of
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float64Array, Progress

#: By how much the cost of exact powers of two may exceed the cost of the labels as they are.
SNAPPED_BONUS = 30.0

#: Largest distance in stops between nominal and snapped labels that makes no difference.
SAME_LABELS = 0.005


def calibrate_stack(
    paths: Sequence[Path],
    *,
    seconds: Sequence[float] | None = None,
    accept_edited: bool = False,
    progress: Progress | None = None,
) -> Calibration:
    """Measure the response of the camera that took an exposure stack of one static scene.

    `seconds` are the exposure times of the frames, by default EXIF's; ISO and f-number count too where EXIF has them.
    Files that a program has edited are refused unless `accept_edited`. `progress` is called with (done, total) after
    every frame that is read.

    Raise PhotoError if a frame cannot be read, and CalibrationError if the frames are not a stack, or no camera
    response explains them.
    """
    frames = read_frames(paths, progress=progress)
    frames = frames if seconds is None else _labeled(frames, seconds)
    checks.check_labels(frames, accept_edited=accept_edited)
    exposures = stack_exposures([frame.label for frame in frames])
    checks.check_range(exposures)
    white = white_level(frames)
    codes, shifts = align(frames, exposures.nominal.argsort().tolist())
    means = [block_means(cut, white * frame.largest) for cut, frame in zip(codes, frames, strict=True)]
    every = observe(means, is_gray=all(frame.is_gray for frame in frames))
    checks.check_seen(white * every.brightness[every.is_used])
    readings = _readings(exposures, frames[0])
    labels, measurement, other = _measured(every, readings)
    reports = _frame_reports(frames, measurement, readings[labels], shifts, white=white)
    checks.check_measurement(measurement, reports, white=white)
    curve = in_file_codes(measurement.curve, white)
    return Calibration(
        curve=curve,
        weights=EmorBasis.load().project(curve.brightness),
        uncertainty=uncertainty_of(measurement, other, white=white),
        residual=white * rms_codes(measurement.fit.residual),
        white=white,
        reaches_white=measurement.anchor.is_seen,
        labels=labels,
        nearest_known=checks.nearest_known(measurement.curve),
        metadata=frames[0].metadata,
        frames=reports,
        points=_points(measurement, white=white),
        counts=_best_exposed(frames, measurement).counts,
        warnings=checks.notices_of(measurement, reports, exposures, white=white),
    )


def calibrate_pairs(
    paths: Sequence[Path], *, accept_edited: bool = False, progress: Progress | None = None
) -> PairCalibration:
    """Return the result of `raw_pairs.measure.measure_pairs`; CalibrationError if its optional packages are absent."""
    try:
        from crfnet_core.calibration.raw_pairs.measure import measure_pairs
    except ImportError:
        raise CalibrationError("rawpy_missing", path=paths[0]) from None
    return measure_pairs(paths, accept_edited=accept_edited, progress=progress)


def _labeled(frames: Sequence[Frame], seconds: Sequence[float]) -> list[Frame]:
    """Return the frames with stated times."""
    if len(seconds) != len(frames):
        raise CalibrationError("times_count", times=len(seconds), frames=len(frames))
    return [
        replace(frame, label=replace(frame.label, seconds=time)) for frame, time in zip(frames, seconds, strict=True)
    ]


def _readings(exposures: Exposures, first: Frame) -> dict[str, Float64Array]:
    """Return the readings of the labels to try: phones expose by any time, so theirs stay as they are."""
    nominal = {"nominal": exposures.nominal}
    if exposures.snapped is None or device_of(first.metadata.make, first.metadata.model) is Device.PHONE:
        return nominal
    snapped = {"exact powers of two": exposures.snapped}
    is_same = np.abs(exposures.snapped - exposures.nominal).max() < SAME_LABELS
    return snapped if is_same else snapped | nominal


def _measured(
    every: Observations, readings: Mapping[str, Float64Array]
) -> tuple[str, Measurement, ResponseCurve | None]:
    """Return the first reading of the labels or a much better other, its measurement, and the other's response."""
    (labels, stops), *others = readings.items()
    measurement = measure(every, stops)
    for other, stops in others:
        again = fit_and_anchor(measurement.seen, stops[measurement.frames], measurement.fit.weights)
        if measurement.fit.cost > again.fit.cost + SNAPPED_BONUS:
            again = replace(again, frames=measurement.frames, outliers=measurement.outliers)
            return other, again, measurement.curve
        return labels, measurement, again.curve
    return labels, measurement, None


def _frame_reports(
    frames: Sequence[Frame], measurement: Measurement, stops: Float64Array, shifts: Sequence[Shift], *, white: float
) -> tuple[FrameReport, ...]:
    """Return a report of each frame."""
    offsets = np.full((len(frames), measurement.fit.offsets.shape[1]), np.nan)
    offsets[measurement.frames] = measurement.fit.offsets
    residuals = np.full(len(frames), np.nan)
    residuals[measurement.frames] = white * frame_residuals(measurement.fit)
    return tuple(
        FrameReport(frame.path, frame.label, float(stops[i]), offsets[i], shifts[i], float(residuals[i]), bool(is_used))
        for i, (frame, is_used) in enumerate(zip(frames, measurement.frames, strict=True))
    )


def _points(measurement: Measurement, *, white: float) -> Float64Array:
    """Return `Calibration.points`."""
    log_irradiance = measurement.fit.log_light - measurement.anchor.log_white
    used = np.broadcast_to(np.flatnonzero(measurement.frames), log_irradiance.shape)
    columns = (log_irradiance, white * measurement.seen.brightness, white * measurement.fit.residual, used)
    return np.stack([column[measurement.seen.is_used] for column in columns], axis=1)


def _best_exposed(frames: Sequence[Frame], measurement: Measurement) -> Frame:
    """Return the used frame whose mean brightness is nearest to the middle."""
    used = [frame for frame, is_used in zip(frames, measurement.frames, strict=True) if is_used]
    steps = np.arange(256) / 255
    return min(used, key=lambda frame: abs(float(np.average(steps, weights=frame.counts)) - 0.45))
