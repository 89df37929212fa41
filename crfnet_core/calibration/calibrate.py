"""Measure a camera's response from an exposure stack: the whole of it on one screen; and the door to raw pairs."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import compress
from pathlib import Path

import numpy as np

from crfnet_core.calibration import checks
from crfnet_core.calibration.alignment import align
from crfnet_core.calibration.blocks import Observations, block_means, observe
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.calibration.exposures import Exposures, stack_exposures
from crfnet_core.calibration.frames import Frame, code_steps, read_frames, white_level
from crfnet_core.calibration.measured import Calibration, FrameReport, PairCalibration
from crfnet_core.calibration.measurement import Measurement, fit_and_anchor, frame_residuals, measure, uncertainty_of
from crfnet_core.calibration.robust import rms_codes
from crfnet_core.errors import CalibrationError
from crfnet_core.photograph.metadata.devices import Device, device_of
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float64Array, IndexArray, Progress

#: By how much the cost of exact powers of two may exceed the cost of the labels as they are.
SNAPPED_BONUS = 30.0


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
    frames = read_frames(paths, seconds, progress=progress)
    checks.check_labels(frames, accept_edited=accept_edited)
    exposures = stack_exposures([frame.label for frame in frames])
    checks.check_range(exposures)
    white = white_level(frames)
    codes, shifts = align([frame.codes for frame in frames], exposures.nominal.argsort().tolist())
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
        counts=_best_counts(frames, measurement),
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


def _readings(exposures: Exposures, first: Frame) -> dict[str, Float64Array]:
    """Return the readings of the labels to try: phones expose by any time, so theirs stay as they are."""
    if exposures.snapped is None or device_of(first.metadata.make, first.metadata.model) is Device.PHONE:
        return {"nominal": exposures.nominal}
    return {"exact powers of two": exposures.snapped, "nominal": exposures.nominal}


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
    frames: Sequence[Frame], measurement: Measurement, stops: Float64Array, shifts: IndexArray, *, white: float
) -> tuple[FrameReport, ...]:
    """Return a report of each frame."""
    offsets = np.full((len(frames), measurement.fit.offsets.shape[1]), np.nan)
    offsets[measurement.frames] = measurement.fit.offsets
    residuals = np.full(len(frames), np.nan)
    residuals[measurement.frames] = white * frame_residuals(measurement.fit)
    columns = (stops.tolist(), offsets, (shifts * frames[0].stride).tolist(), residuals.tolist(), measurement.frames)
    return tuple(
        FrameReport(frame.path, frame.label, stop, offset, (down, right), residual, bool(is_used))
        for frame, stop, offset, (down, right), residual, is_used in zip(frames, *columns, strict=True)
    )


def _points(measurement: Measurement, *, white: float) -> Float64Array:
    """Return `Calibration.points`."""
    log_irradiance = measurement.fit.log_light - measurement.anchor.log_white
    used = np.broadcast_to(np.flatnonzero(measurement.frames), log_irradiance.shape)
    columns = (log_irradiance, white * measurement.seen.brightness, white * measurement.fit.residual, used)
    return np.stack([column[measurement.seen.is_used] for column in columns], axis=1)


def _best_counts(frames: Sequence[Frame], measurement: Measurement) -> Float64Array:
    """Return `Calibration.counts`: of the used frame whose mean brightness is nearest to the middle."""
    used = compress(frames, measurement.frames)
    best = min(used, key=lambda frame: abs(frame.codes.mean() / frame.largest - 0.45))
    return np.bincount(code_steps(best).ravel(), minlength=256).astype(np.float64)
