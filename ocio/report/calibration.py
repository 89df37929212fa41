"""A measured response in words, as JSON, and as the provenance in LUT files."""

from __future__ import annotations

from collections.abc import Mapping
from functools import singledispatch
from typing import Any

import numpy as np

from crfnet_core.calibration import Calibration, Comparison, FrameReport, MeasuredResponse
from crfnet_core.photograph.metadata.devices import camera_name
from crfnet_core.response.metrics import brightness_percent
from crfnet_core.types import plain_values

from ..output_files import OutputFiles
from .documents import file_names, rounded


@singledispatch
def calibration_lines(calibration: Any) -> list[str]:
    """Return the measurement and how far to trust it, in plain words: one line each."""
    raise TypeError(type(calibration))


@calibration_lines.register
def _(calibration: Calibration) -> list[str]:
    shape, scale = calibration.uncertainty.shape_stops, calibration.uncertainty.scale_stops
    white = "white is reached" if calibration.reaches_white else "no frame reaches white, so the scale is a guess"
    return [
        f"{_frames_words(calibration)}.",
        f"The response is measured: the shape of the linear light to {shape:.2f} stop, its scale relative to white to"
        f" {scale:.2f} stop (standard deviations); {white}.",
        f"The curve explains the frames to {calibration.residual:.1f} of 255 codes (RMS); their exposures were read as"
        f" {calibration.labels} and are {_largest_offset(calibration):.2f} stop from that at most.",
        *(f"Warning: {warning}." for warning in calibration.warnings),
    ]


def comparison_lines(comparison: Comparison) -> list[str]:
    """Return how far another response is from the measured one, in plain words."""
    percent = brightness_percent(comparison.estimation_error)
    return [
        "",
        f"The other response is off by {comparison.shape_error:.2f} stop in shape and"
        f" {comparison.scale_error:+.2f} stop in scale: E_est {comparison.estimation_error:.2f} ({percent:.1f} % of the"
        f" brightness range), E_lin {comparison.linearization_error:.4f} on the best exposed frame.",
    ]


@singledispatch
def calibration_provenance(calibration: Any) -> tuple[str, ...]:
    """Return the comment lines of LUT files: the LUT, its frames, and how far to trust it."""
    raise TypeError(type(calibration))


@calibration_provenance.register
def _(calibration: Calibration) -> tuple[str, ...]:
    return (
        "Inverse camera response: encoded brightness in, relative scene-linear irradiance out",
        f"Measured from {_frames_words(calibration)}",
        deviations(calibration),
    )


def deviations(calibration: MeasuredResponse) -> str:
    """Return both standard deviations, for the comments of LUT files."""
    shape, scale = calibration.uncertainty.shape_stops, calibration.uncertainty.scale_stops
    return f"Standard deviations: shape {shape:.3f} stop, scale {scale:.3f} stop"


@singledispatch
def calibration_document(calibration: Any, files: OutputFiles, comparison: Comparison | None = None) -> dict[str, Any]:
    """Return a measured response, ready for JSON; file names are relative to the folder."""
    raise TypeError(type(calibration), files, comparison)


@calibration_document.register
def _(calibration: Calibration, files: OutputFiles, comparison: Comparison | None = None) -> dict[str, Any]:
    own = {
        "frames": [_frame_document(frame) for frame in calibration.frames],
        "labels": calibration.labels,
        "white": rounded(calibration.white),
        "reaches_white": calibration.reaches_white,
        "nearest_known_response": rounded(calibration.nearest_known),
    }
    return common_document(calibration, files, comparison) | own


def common_document(calibration: MeasuredResponse, files: OutputFiles, comparison: Comparison | None) -> dict[str, Any]:
    """Return the entries of every measured response."""
    metadata, uncertainty = calibration.metadata, calibration.uncertainty
    return {
        "kind": "calibration",
        "camera": {"make": metadata.make, "model": metadata.model, "firmware": metadata.software},
        "size": [metadata.width, metadata.height],
        "shape_uncertainty_stops": rounded(uncertainty.shape_stops),
        "scale_uncertainty_stops": rounded(uncertainty.scale_stops),
        "uncertainty_parts": {"shape": _parts(uncertainty.shape), "scale": _parts(uncertainty.scale)},
        "residual_codes": rounded(calibration.residual),
        "warnings": [str(warning) for warning in calibration.warnings],
        "comparison": None if comparison is None else _parts(vars(comparison)),
        "weights": rounded(calibration.weights),
        "response": {"brightness": plain_values(calibration.curve.brightness)},
        "color_space": files.color_space,
        "files": file_names(files),
    }


def _frame_document(frame: FrameReport) -> dict[str, Any]:
    """Return the report of a frame for JSON; null where it was left out."""
    return {
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


def _parts(values: Mapping[str, float]) -> dict[str, Any]:
    """Return numbers by name, rounded."""
    return {name: rounded(value) for name, value in values.items()}


def _frames_words(calibration: Calibration) -> str:
    """Return the number of frames, their camera and their exposures, in words."""
    labels = [frame.label for frame in calibration.frames]
    times = sorted(label.seconds for label in labels if label.seconds)
    camera = camera_name(calibration.metadata.make, calibration.metadata.model) or "an unnamed camera"
    fixed = {
        "ISO {:g}": {label.iso for label in labels},
        "f/{:.3g}": {label.f_number for label in labels},
    }
    settings = [
        form.format(next(iter(values))) for form, values in fixed.items() if len(values) == 1 and None not in values
    ]
    stops = np.ptp([frame.stops for frame in calibration.frames])
    exposures = f"{_time_words(times[0])} to {_time_words(times[-1])} ({stops:.1f} stops)"
    return ", ".join([f"{len(labels)} frames of {camera}", *settings, exposures])


def _time_words(seconds: float) -> str:
    """Return an exposure time as cameras show it."""
    return f"1/{1 / seconds:.0f} s" if seconds < 0.3 else f"{seconds:.3g} s"


def _largest_offset(calibration: Calibration) -> float:
    """Return by how many stops green in the used frames is from their labels at most."""
    offsets = [float(frame.offsets[len(frame.offsets) // 2]) for frame in calibration.frames if frame.is_used]
    return max(map(abs, offsets))
