"""Refuse stacks that cannot be measured, and note doubts about those that can."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from crfnet_core.calibration.blocks import Observations, medians_of_bins, members_of_bins
from crfnet_core.calibration.curve_model import in_camera_responses
from crfnet_core.calibration.exposures import LEAST_RANGE, ROUNDING, Exposures
from crfnet_core.calibration.frames import LEAST_FRAMES, Frame
from crfnet_core.calibration.measured import FrameReport
from crfnet_core.calibration.measurement import Measurement
from crfnet_core.calibration.robust import rms_codes
from crfnet_core.calibration.solver import StackFit
from crfnet_core.errors import CalibrationError, Notice, beside_limits
from crfnet_core.photograph.metadata import file_origin
from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE
from crfnet_core.types import Float64Array

#: Stops between two neighboring exposures beyond which hardly a surface is seen between black and white in both.
LARGEST_STEP = 6.0

#: Difference in stops between a frame's exposure and its label, and fraction of samples that fit in no way: the largest
#: that are not refused, and the least that are worth a notice.
MOST_OFFSET, MOST_OUTLIERS, NOTABLE_OFFSET, NOTABLE_OUTLIERS = 0.3, 0.3, 0.1, 0.1

#: Stops by which stated times may differ from the files' own without a notice: EXIF's 1/60 s may be 1/64 s.
NOTABLE_RESTATED = 0.25

#: Largest root mean square residual in 8-bit codes.
MOST_RESIDUAL = 2.5

#: Largest E_est between a measured response and the nearest known one.
MOST_UNKNOWN = 2.0

#: Parts of the codes in which frames are compared with their common curve, the samples that one needs, and the codes
#: from which on they differ: three simulated stacks of two responses have 0.8 to 1.3, seven of one at most 0.5.
FRAME_PARTS, LEAST_IN_PART, NOTABLE_DIFFERENCE = 8, 20, 0.65

#: If nothing moved, blocks of equal code in one frame are equal in the next, whatever curve each was rendered with.
#: The scatter in 8-bit codes from which on something has moved, and the levels within which blocks count as equal.
MOST_SCATTER, EQUAL_LEVELS = 6.0, 48

#: Parts that the codes are divided into, and how many of them have to be seen.
CODE_BINS, LEAST_BINS = 28, 0.5


def check_labels(frames: Sequence[Frame], *, accept_edited: bool) -> None:
    """Refuse frames without exposure times, and frames that a program has edited."""
    for frame in frames:
        if frame.label.seconds is None:
            raise CalibrationError("frame_untimed", path=frame.path)
        if not accept_edited and (editor := file_origin(frame.metadata).editor):
            raise CalibrationError("frame_edited", path=frame.path, editor=editor)


def check_range(exposures: Exposures) -> None:
    """Refuse exposures that span less than `LEAST_RANGE` stops, or neighbors more than `LARGEST_STEP` stops apart."""
    if (span := float(np.ptp(exposures.nominal))) < LEAST_RANGE - ROUNDING:
        raise CalibrationError("exposures_span", span=beside_limits(span, LEAST_RANGE), least=LEAST_RANGE)
    if (step := float(np.diff(np.sort(exposures.nominal)).max())) > LARGEST_STEP + ROUNDING:
        raise CalibrationError("exposures_gap", step=beside_limits(step, LARGEST_STEP))


def check_seen(brightness: Float64Array) -> None:
    """Refuse a stack whose brightness, shape (N,), shows fewer than `LEAST_BINS` of the codes that give the shape."""
    edges = np.linspace(FIRST_SHAPE_CODE, LAST_SHAPE_CODE, CODE_BINS + 1)
    part = float(np.mean(np.histogram(255 * brightness, edges)[0] > 0))
    if part < LEAST_BINS:
        raise CalibrationError("codes_unseen", part=part, first=FIRST_SHAPE_CODE, last=LAST_SHAPE_CODE)


def check_measurement(measurement: Measurement, frames: Sequence[FrameReport], *, white: float) -> None:
    """Refuse frames that moved, are mistimed or follow no single curve, and a curve far from every known response."""
    left_out = ", ".join(frame.path.name for frame in frames if not frame.is_used)
    residual = white * rms_codes(measurement.fit.residual)
    is_moved = measurement.frames.sum() < LEAST_FRAMES or measurement.outliers > MOST_OUTLIERS
    if is_moved or (residual > MOST_RESIDUAL and scatter(measurement.seen, measurement.exposures) > MOST_SCATTER):
        raise CalibrationError("scene_moved", which=f"{left_out} and more" if left_out else "some blocks")
    offsets = off_trend(measurement)
    worst = int(np.abs(offsets).argmax())
    if abs(offsets[worst]) > MOST_OFFSET:
        path = [frame.path.name for frame in frames if frame.is_used][worst]
        direction = "brighter" if offsets[worst] > 0 else "darker"
        raise CalibrationError("frame_mistimed", path=path, stops=abs(offsets[worst]), direction=direction)
    if residual > MOST_RESIDUAL:
        raise CalibrationError("no_single_curve", residual=beside_limits(residual, MOST_RESIDUAL), most=MOST_RESIDUAL)
    if (distance := nearest_known(measurement.curve)) > MOST_UNKNOWN and measurement.anchor.is_seen:
        raise CalibrationError("unknown_curve", distance=beside_limits(distance, MOST_UNKNOWN), most=MOST_UNKNOWN)


def notices_of(
    measurement: Measurement, frames: Sequence[FrameReport], exposures: Exposures, *, white: float
) -> tuple[Notice, ...]:
    """Return the doubts about a measurement that are not a reason to refuse it."""
    used = [frame.path.name for frame in frames if frame.is_used]
    offsets = zip(used, off_trend(measurement).tolist(), strict=True)
    highest = 255 * float(measurement.seen.brightness[measurement.seen.is_used].max())  # white = 255
    labels = [frame.label for frame in frames]
    ratios = [label.seconds / label.file_seconds for label in labels if label.seconds and label.file_seconds]
    restated = float(np.ptp(np.log2(ratios or [1.0])))  # a common factor has no effect
    apart = frame_differences(measurement.fit, measurement.seen.brightness)
    distance, part = nearest_known(measurement.curve, in_camera=True), measurement.outliers
    doubts = [
        *(("frame_unfit", {"name": frame.path.name}, not frame.is_used) for frame in frames),
        *(("frame_off", {"name": name, "off": off}, abs(off) > NOTABLE_OFFSET) for name, off in offsets),
        ("times_differ", {"stops": restated}, restated > NOTABLE_RESTATED),
        ("settings_differ", {"settings": " and ".join(exposures.differing)}, exposures.differing),
        ("unlike_cameras", {"distance": distance}, distance > MOST_UNKNOWN),
        ("codes_above_unseen", {"highest": white * highest}, highest < LAST_SHAPE_CODE),
        ("frames_differ", {"codes": apart}, apart > NOTABLE_DIFFERENCE),
        ("white_unseen", {}, not measurement.anchor.is_seen),
        ("blocks_left_out", {"part": part}, part > NOTABLE_OUTLIERS),
        ("white_below_largest", {"code": 255 * white}, white < 1),
    ]
    return tuple(Notice(code, facts) for code, facts, is_so in doubts if is_so)


def nearest_known(curve: ResponseCurve, *, in_camera: bool = False) -> float:
    """Return E_est between a response and the nearest packaged one: ordinary, or of cameras' own rendering only."""
    bank = ResponseBank.load()
    known = in_camera_responses() if in_camera else bank.brightness[bank.ordinary]
    return float(np.linalg.norm(known - curve.brightness, axis=1).min())


def scatter(seen: Observations, exposures: Float64Array) -> float:
    """Return by how many codes blocks of one code differ in the next frame: the median over pairs of frames.

    Frames are compared with the next brighter one, per channel, in `EQUAL_LEVELS` levels.
    """
    deviations = []
    for first, second in pairwise(exposures.argsort().tolist()):
        both = seen.is_used[:, first] & seen.is_used[:, second]
        before, after = 255 * seen.brightness[both][:, [first, second]].T
        levels = np.floor(before * EQUAL_LEVELS / 256) + EQUAL_LEVELS * seen.channel[both]
        deviations += [after[part].std() for part in members_of_bins(levels, after) if len(part) >= 4]
    return float(np.median(deviations)) if deviations else 0.0


def frame_differences(fit: StackFit, brightness: Float64Array) -> float:
    """Return by how many codes frames are off their common curve: the mean over frames and parts of the codes.

    Of each part the median residual counts, so that only what its samples have in common does.
    """
    frames = np.broadcast_to(np.arange(brightness.shape[1]), brightness.shape)
    parts = frames + np.floor(np.minimum(brightness, 0.999) * FRAME_PARTS) / FRAME_PARTS
    counts = np.isfinite(fit.residual)
    medians = medians_of_bins(255 * fit.residual[counts], parts[counts], LEAST_IN_PART)
    return float(np.abs(medians).mean()) if len(medians) else 0.0


def off_trend(measurement: Measurement) -> Float64Array:
    """Return by how many stops green is brighter than its label in each used frame, less the trend of most: (T,).

    The slope is Theil and Sen's, the median over pairs, so that one wrong label does not spoil the others.
    """
    offsets = measurement.fit.offsets[:, measurement.fit.offsets.shape[1] // 2]
    first, second = np.triu_indices(len(offsets), 1)
    distance = measurement.exposures[second] - measurement.exposures[first]
    apart = np.abs(distance) > 0.1
    slope = np.median((offsets[second] - offsets[first])[apart] / distance[apart])
    rest = offsets - slope * measurement.exposures
    return np.asarray(rest - np.median(rest), dtype=np.float64)
