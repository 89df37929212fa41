"""What is wrong with a stack: refused in one line that says what to do."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from crfnet_core.calibration.blocks import Observations
from crfnet_core.calibration.exposures import LEAST_RANGE, ROUNDING, Exposures
from crfnet_core.calibration.frames import LEAST_FRAMES, Frame
from crfnet_core.calibration.measurement import Measurement
from crfnet_core.errors import CalibrationError, beside_limits
from crfnet_core.photograph.metadata import file_origin
from crfnet_core.posterior import IN_CAMERA, ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE
from crfnet_core.types import Float64Array

#: Stops between two neighbouring exposures beyond which hardly a surface is seen between black and white in both.
LARGEST_STEP = 6.0

#: Largest difference in stops between a frame's exposure and its label.
MOST_OFFSET = 0.3

#: Offset in stops from its label, and fraction of samples left out, from which a warning says so.
NOTABLE_OFFSET, NOTABLE_OUTLIERS = 0.1, 0.1

#: Largest root mean square residual in 8-bit codes, and largest fraction of samples that fit in no way.
MOST_RESIDUAL, MOST_OUTLIERS = 2.5, 0.3

#: Largest E_est between a measured response and the nearest known one.
MOST_UNKNOWN = 2.0

#: If nothing moved, blocks of equal code in one frame are equal in the next, whatever curve each was rendered with.
#: From this scatter on, in 8-bit codes, something has moved.
MOST_SCATTER = 6.0

#: Levels that blocks count as equal within.
EQUAL_LEVELS = 48

#: Parts that the codes are divided into, and how many of them have to be seen.
CODE_BINS, LEAST_BINS = 28, 0.5


def check_labels(frames: Sequence[Frame], *, accept_edited: bool) -> None:
    """Refuse frames without exposure times, and frames that a program has edited.

    Raises
    ------
    CalibrationError
        In either case; edited frames only if `accept_edited` is false.
    """
    if untimed := [frame for frame in frames if frame.label.seconds is None]:
        raise CalibrationError(
            f"{untimed[0].path}: names no exposure time; give the times of all frames with --times 1/60,1/30,..."
            " or a CSV file"
        )
    editors = [file_origin(frame.metadata).editor for frame in frames]
    if any(editors) and not accept_edited:
        editor, frame = next((editor, frame) for editor, frame in zip(editors, frames, strict=True) if editor)
        raise CalibrationError(
            f"{frame.path}: saved by {editor}, which may have changed the tones; give the camera's own files,"
            " or add --accept-edited to measure what that program makes of them"
        )


def check_range(exposures: Exposures) -> None:
    """Refuse a stack whose exposures lie too close together, or too far apart.

    Raises
    ------
    CalibrationError
        If they span less than `LEAST_RANGE` stops, or two neighbours are more than `LARGEST_STEP` stops apart.
    """
    if exposures.range < LEAST_RANGE - ROUNDING:
        raise CalibrationError(
            f"the exposures span {beside_limits(exposures.range, LEAST_RANGE)} stops, by EXIF or --times; a stack needs"
            f" {LEAST_RANGE:g} or more, from nearly nothing white to nearly everything white"
        )
    if (step := float(np.diff(np.sort(exposures.nominal)).max())) > LARGEST_STEP + ROUNDING:
        raise CalibrationError(
            f"two neighbouring exposures are {beside_limits(step, LARGEST_STEP)} stops apart, by EXIF or --times; check"
            " the times, or take frames one or two stops apart"
        )


def check_seen(brightness: Float64Array) -> None:
    """Refuse a stack that does not show enough of the codes between black and white.

    Parameters
    ----------
    brightness : ndarray, float64, shape (N,)
        What was measured, the largest code of the file = 1.

    Raises
    ------
    CalibrationError
        If fewer than `LEAST_BINS` of the codes that the shape is measured over occur.
    """
    edges = np.linspace(FIRST_SHAPE_CODE, LAST_SHAPE_CODE, CODE_BINS + 1)
    counts = np.histogram(255 * brightness, edges)[0]
    if np.mean(counts > 0) < LEAST_BINS:
        raise CalibrationError(
            f"flat parts of the pictures show {np.mean(counts > 0):.0%} of the codes between {FIRST_SHAPE_CODE} and"
            f" {LAST_SHAPE_CODE}; take a scene with more range, or frames closer together"
        )


def check_measurement(measurement: Measurement, names: Sequence[str], *, white: float) -> None:
    """Refuse what no camera response explains, and say why.

    Parameters
    ----------
    measurement : Measurement
        The response.
    names : sequence of str
        The names of all frames.
    white : float
        The code of white as a part of the largest code.

    Raises
    ------
    CalibrationError
        If the frames moved, are mistimed, or follow no one curve, or the curve is far from every known response.
    """
    used, left_out = _names(measurement, names)
    is_moved = measurement.frames.sum() < LEAST_FRAMES or measurement.outliers > MOST_OUTLIERS
    residual = white * measurement.residual
    if residual > MOST_RESIDUAL:
        is_moved = is_moved or scatter(measurement.seen, measurement.exposures) > MOST_SCATTER
    if is_moved:
        which = f"{', '.join(left_out)} and more" if left_out else "some blocks"
        raise CalibrationError(
            f"the frames do not show the same scene: {which} differ from the others even after alignment; the camera or"
            " the scene has moved, so use a tripod and a still scene, or leave these frames out"
        )
    _check_offsets(measurement, used)
    if residual > MOST_RESIDUAL:
        raise CalibrationError(
            "no single curve explains the frames: they are off by"
            f" {beside_limits(residual, MOST_RESIDUAL)} codes (RMS), at most {MOST_RESIDUAL:g} are usual; each was"
            " rendered or edited on its own (automatic tones, local tone mapping, HDR): switch that off, and give the"
            " camera's own files"
        )
    if (distance := nearest_known(measurement.curve)) > MOST_UNKNOWN and measurement.anchor.is_seen:
        raise CalibrationError(
            "the curve that explains the frames is far from every known response (E_est"
            f" {beside_limits(distance, MOST_UNKNOWN)}, at most {MOST_UNKNOWN:g}); the exposure times are probably"
            " wrong, so check them, or the files were edited"
        )


def warnings_of(
    measurement: Measurement, names: Sequence[str], exposures: Exposures, *, white: float
) -> tuple[str, ...]:
    """Return what to know of a measurement that is no reason to refuse it, in words.

    Parameters
    ----------
    measurement : Measurement
        The response.
    names : sequence of str
        The names of all frames.
    exposures : Exposures
        Their exposures.
    white : float
        The code of white as a part of the largest code.
    """
    used, left_out = _names(measurement, names)
    warnings = [f"{name} does not fit the other frames and was left out" for name in left_out]
    offsets = zip(used, off_trend(measurement), strict=True)
    warnings += [
        f"{name} is {off:+.2f} stop from its exposure label" for name, off in offsets if abs(off) > NOTABLE_OFFSET
    ]
    if exposures.differing:
        differing = " and ".join(exposures.differing)
        warnings.append(f"{differing} differ between the frames: exposures are time x ISO / f-number^2")
    if (distance := nearest_known(measurement.curve, in_camera=True)) > MOST_UNKNOWN:
        warnings.append(f"unlike every camera's own rendering that is known (E_est {distance:.1f}): check the times")
    highest = 255 * float(measurement.seen.brightness[measurement.seen.is_used].max())  # white = 255
    if highest < LAST_SHAPE_CODE:
        warnings.append(f"no code above {white * highest:.0f} is seen: there the curve is that of known responses")
    if not measurement.anchor.is_seen:
        warnings.append("no frame reaches white: the scale is a guess; add a longer exposure")
    if measurement.outliers > NOTABLE_OUTLIERS:
        warnings.append(f"{measurement.outliers:.0%} of the blocks do not fit and were left out: something moved")
    if white < 1:
        warnings.append(f"white is {255 * white:.0f} of 255 codes: the codes above it are white too")
    return tuple(warnings)


def nearest_known(curve: ResponseCurve, *, in_camera: bool = False) -> float:
    """Return E_est between a response and the nearest packaged one: ordinary, or of cameras' own rendering only."""
    bank = ResponseBank.load()
    members = np.any([bank.members(family) for family in IN_CAMERA], axis=0) if in_camera else bank.ordinary
    off = bank.brightness[members] - curve.brightness
    return float(np.sqrt((off**2).sum(axis=1).min()))


def scatter(seen: Observations, exposures: Float64Array) -> float:
    """Return by how many codes blocks of one code differ in the next frame: the median over pairs of frames.

    Frames are compared with the next brighter one, per channel, in `EQUAL_LEVELS` levels.
    """
    order = exposures.argsort()
    found = []
    for first, second in pairwise(order.tolist()):
        for channel in np.unique(seen.channel):
            both = seen.is_used[:, first] & seen.is_used[:, second] & (seen.channel == channel)
            codes = 255 * seen.brightness[both][:, [first, second]]
            level = np.floor(codes[:, 0] * EQUAL_LEVELS / 256).astype(int)
            parts = [codes[level == value, 1] for value in np.unique(level)]
            found += [float(np.std(part)) for part in parts if len(part) >= 4]
    return float(np.median(found)) if found else 0.0


def off_trend(measurement: Measurement) -> Float64Array:
    """Return by how many stops green is brighter than its label in each used frame, beside the trend of most: (T,).

    The slope is Theil and Sen's, the median over pairs, so that one wrong label does not spoil the others.
    """
    offsets = measurement.fit.offsets[:, measurement.fit.offsets.shape[1] // 2]
    first, second = np.triu_indices(len(offsets), 1)
    distance = measurement.exposures[second] - measurement.exposures[first]
    apart = np.abs(distance) > 0.1
    slope = np.median((offsets[second] - offsets[first])[apart] / distance[apart])
    rest = offsets - slope * measurement.exposures
    return np.asarray(rest - np.median(rest), dtype=np.float64)


def _names(measurement: Measurement, names: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return the names of the frames that are used, and of those that are left out."""
    frames = list(zip(names, measurement.frames, strict=True))
    return [name for name, is_used in frames if is_used], [name for name, is_used in frames if not is_used]


def _check_offsets(measurement: Measurement, names: Sequence[str]) -> None:
    """Refuse a frame whose exposure is not the one of its label."""
    offsets = off_trend(measurement)
    worst = int(np.abs(offsets).argmax())
    if abs(offsets[worst]) > MOST_OFFSET:
        direction = "brighter" if offsets[worst] > 0 else "darker"
        raise CalibrationError(
            f"{names[worst]}: is {abs(offsets[worst]):.2f} stop {direction} than its exposure time says, beside the"
            " other frames; correct its time with --times, or leave the frame out"
        )
