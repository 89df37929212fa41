"""A measured response in words, as JSON, and as the provenance in LUT files."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from crfnet_core.calibration import Calibration, PairCalibration
from crfnet_core.photograph.metadata.devices import camera_name
from crfnet_core.response.metrics import brightness_percent
from crfnet_core.types import plain_values

from ..output_files import OutputFiles
from .documents import file_names, rounded

#: A measured response, of a stack or of raw files.
Measured = Calibration | PairCalibration


def calibration_lines(calibration: Measured) -> list[str]:
    """Return the measurement and how far to trust it, in plain words: one line each."""
    fit = _pair_words(calibration) if isinstance(calibration, PairCalibration) else _stack_words(calibration)
    shape, scale = calibration.uncertainty.shape_stops, calibration.uncertainty.scale_stops
    return [
        f"{_source_words(calibration)}.",
        f"Standard deviations: shape {shape:.2f} stop, the error of the linear light once the exposure is matched;"
        f" scale {scale:.2f} stop, the error of the place of white; {white_words(calibration)}.",
        fit,
        *(f"Warning: {warning}." for warning in calibration.warnings),
    ]


def white_words(calibration: Measured) -> str:
    """Return how it is known where white is, and of raw files which codes were seen."""
    if isinstance(calibration, PairCalibration):
        low, high = calibration.codes_seen
        return f"codes {low:.0f} to {high:.0f} were seen; where white is: {calibration.white_basis}"
    return "white is reached" if calibration.reaches_white else "no frame reaches white, so the scale is a guess"


def _stack_words(calibration: Calibration) -> str:
    """Return how well the curve explains a stack."""
    offsets = [float(frame.offsets[len(frame.offsets) // 2]) for frame in calibration.frames if frame.is_used]
    return (
        f"The curve explains the frames to {calibration.residual:.1f} of 255 codes (RMS); their exposures were read as"
        f" {calibration.labels} and are {max(map(abs, offsets)):.2f} stop from that at most."
    )


def _pair_words(calibration: PairCalibration) -> str:
    """Return how well the curve explains raw files and their JPEGs."""
    offsets = [shot.offset for shot in calibration.shots]
    apart = f"; the shots are {np.ptp(offsets):.2f} stop apart at most" if len(offsets) > 1 else ""
    corner = f" The camera brightens the corners by {calibration.corner:.2f} stop." if calibration.corner > 0.1 else ""
    residual = f"{calibration.residual:.1f} of 255 codes (RMS)"
    return f"One curve and one color matrix explain the JPEG to {residual}{apart}.{corner}"


def comparison_lines(comparison: Mapping[str, float]) -> list[str]:
    """Return how far another response is from the measured one, in plain words."""
    distance, linear = comparison["estimation_error"], comparison["linearization_error"]
    return [
        "",
        f"The other response is off by {comparison['shape_error']:.2f} stop in shape and"
        f" {comparison['scale_error']:+.2f} stop in scale: E_est {distance:.2f} ({brightness_percent(distance):.1f} %"
        f" of the brightness range), E_lin {linear:.4f} on the best exposed frame.",
    ]


def calibration_provenance(calibration: Measured) -> tuple[str, ...]:
    """Return the comment lines of LUT files: the LUT, its frames, and how far to trust it."""
    shape, scale = calibration.uncertainty.shape_stops, calibration.uncertainty.scale_stops
    return (
        "Inverse camera response: encoded brightness in, relative scene-linear irradiance out",
        f"Measured from {_source_words(calibration)}; {white_words(calibration)}",
        f"Standard deviations: shape {shape:.3f} stop, scale {scale:.3f} stop",
    )


def calibration_document(
    calibration: Measured, files: OutputFiles, comparison: Mapping[str, float] | None
) -> dict[str, Any]:
    """Return a measured response, ready for JSON; file names are relative to the folder."""
    own = _pair_document(calibration) if isinstance(calibration, PairCalibration) else _stack_document(calibration)
    metadata, uncertainty = calibration.metadata, calibration.uncertainty
    common = {
        "kind": "calibration",
        "camera": {"make": metadata.make, "model": metadata.model, "firmware": metadata.software},
        "size": [metadata.width, metadata.height],
        "shape_uncertainty_stops": rounded(uncertainty.shape_stops),
        "scale_uncertainty_stops": rounded(uncertainty.scale_stops),
        "uncertainty_parts": {"shape": rounded(uncertainty.shape), "scale": rounded(uncertainty.scale)},
        "residual_codes": rounded(calibration.residual),
        "warnings": [str(warning) for warning in calibration.warnings],
        "comparison": None if comparison is None else rounded(comparison),
        "weights": rounded(calibration.weights),
        "response": {"brightness": plain_values(calibration.curve.brightness)},
        "color_space": files.color_space,
        "files": file_names(files),
    }
    return common | own


def _stack_document(calibration: Calibration) -> dict[str, Any]:
    """Return the entries that only a stack has; null of a frame that was left out."""
    frames = [
        {
            "name": frame.path.name,
            "seconds": frame.label.seconds,
            "f_number": frame.label.f_number,
            "iso": frame.label.iso,
            "stops": rounded(frame.stops),
            "offsets_stops": rounded(frame.offsets) if frame.is_used else None,
            "shift_pixels": list(frame.shift),
            "residual_codes": rounded(frame.residual) if frame.is_used else None,
            "used": frame.is_used,
        }
        for frame in calibration.frames
    ]
    return {
        "frames": frames,
        "labels": calibration.labels,
        "white": rounded(calibration.white),
        "reaches_white": calibration.reaches_white,
        "nearest_known_response": rounded(calibration.nearest_known),
    }


def _pair_document(calibration: PairCalibration) -> dict[str, Any]:
    """Return the entries that only raw files have."""
    shots = [
        {
            "name": shot.path.name,
            "jpeg": shot.jpeg and shot.jpeg.name,
            "iso": shot.iso,
            "cells": shot.cells,
            "offset_stops": rounded(shot.offset),
            "residual_codes": rounded(shot.residual),
            "correlation": rounded(shot.correlation),
            "used": True,
        }
        for shot in calibration.shots
    ]
    return {
        "method": "raw pairs",
        "frames": shots,
        "white_basis": str(calibration.white_basis),
        "codes_seen": rounded(list(calibration.codes_seen)),
        "color_matrix": rounded(calibration.matrix),
        "local_exponent": rounded(calibration.local),
        "corner_stops": rounded(calibration.corner),
    }


def _source_words(calibration: Measured) -> str:
    """Return the number of files, their camera, the settings that they have in common, and how they differ."""
    if isinstance(calibration, PairCalibration):
        count = len(calibration.shots)
        files = f"{count} raw file{'s' * (count > 1)}"
        settings: dict[str, list[Any]] = {"ISO {:g}": [shot.iso for shot in calibration.shots]}
        end = "with its JPEG" if any(shot.jpeg for shot in calibration.shots) else "with the JPEG inside"
    else:
        labels = [frame.label for frame in calibration.frames]
        times = sorted(label.seconds for label in labels if label.seconds)
        stops = np.ptp([frame.stops for frame in calibration.frames])
        files = f"{len(labels)} frames"
        settings = {"ISO {:g}": [label.iso for label in labels], "f/{:.3g}": [label.f_number for label in labels]}
        end = f"{_time_words(times[0])} to {_time_words(times[-1])} ({stops:.1f} stops)"
    camera = camera_name(calibration.metadata.make, calibration.metadata.model) or "an unnamed camera"
    common = [form.format(values[0]) for form, values in settings.items() if values[0] and len(set(values)) == 1]
    return ", ".join([f"{files} of {camera}", *common, end])


def _time_words(seconds: float) -> str:
    """Return an exposure time as cameras show it."""
    return f"1/{1 / seconds:.0f} s" if seconds < 0.3 else f"{seconds:.3g} s"
