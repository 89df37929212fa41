"""A response measured from raw files and their JPEGs: in words, as JSON, and as the provenance in LUT files."""

from __future__ import annotations

from typing import Any

from crfnet_core.calibration import Comparison, PairCalibration, ShotReport
from crfnet_core.photograph.metadata.devices import camera_name

from ..output_files import OutputFiles
from .calibration import calibration_document, calibration_lines, calibration_provenance, common_document, deviations
from .documents import rounded


@calibration_lines.register
def _(calibration: PairCalibration) -> list[str]:
    low, high = calibration.codes_seen
    shape, scale = calibration.uncertainty.shape_stops, calibration.uncertainty.scale_stops
    offsets = [shot.offset for shot in calibration.shots]
    apart = f"; the shots are {max(offsets) - min(offsets):.2f} stop apart at most" if len(offsets) > 1 else ""
    corner = f" The camera brightens the corners by {calibration.corner:.2f} stop." if calibration.corner > 0.1 else ""
    return [
        f"{_shots_words(calibration)}.",
        f"The response is measured: the shape of the linear light to {shape:.2f} stop, its scale relative to white to"
        f" {scale:.2f} stop (standard deviations). Codes {low:.0f} to {high:.0f} were seen; where white"
        f" is: {calibration.white_basis}.",
        f"One curve and one color matrix explain the JPEG to {calibration.residual:.1f} of 255 codes (RMS){apart}."
        f"{corner}",
        *(f"Warning: {warning}." for warning in calibration.warnings),
    ]


@calibration_provenance.register
def _(calibration: PairCalibration) -> tuple[str, ...]:
    low, high = calibration.codes_seen
    return (
        "Inverse camera response: encoded brightness in, relative scene-linear irradiance out",
        f"Measured from {_shots_words(calibration)}, codes {low:.0f} to {high:.0f}",
        deviations(calibration),
    )


@calibration_document.register
def _(calibration: PairCalibration, files: OutputFiles, comparison: Comparison | None = None) -> dict[str, Any]:
    own = {
        "method": "raw pairs",
        "frames": [_shot_document(shot) for shot in calibration.shots],
        "white_basis": str(calibration.white_basis),
        "codes_seen": rounded(list(calibration.codes_seen)),
        "color_matrix": rounded(calibration.matrix),
        "local_exponent": rounded(calibration.local),
        "corner_stops": rounded(calibration.corner),
    }
    return common_document(calibration, files, comparison) | own


def _shot_document(shot: ShotReport) -> dict[str, Any]:
    """Return the report of a pair for JSON."""
    return {
        "name": shot.path.name,
        "jpeg": shot.jpeg and shot.jpeg.name,
        "iso": shot.iso,
        "cells": shot.cells,
        "offset_stops": rounded(shot.offset),
        "residual_codes": rounded(shot.residual),
        "correlation": rounded(shot.correlation),
        "used": True,
    }


def _shots_words(calibration: PairCalibration) -> str:
    """Return the number of raw files, their camera and their sensitivity, in words."""
    camera = camera_name(calibration.metadata.make, calibration.metadata.model) or "an unnamed camera"
    count = len(calibration.shots)
    iso = {shot.iso for shot in calibration.shots}
    inside = sum(shot.jpeg is None for shot in calibration.shots)
    parts = [
        f"{count} raw file{'s' * (count > 1)} of {camera}",
        *(f"ISO {value}" for value in iso if value and len(iso) == 1),
    ]
    return ", ".join([*parts, "with the JPEG inside" if inside == count else "with its JPEG"])
