"""A camera as a JSON document, and back; and the document of `crfnet calibrate` as a measured response."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core.errors import CameraError, CRFNetError, one_line
from crfnet_core.estimate.analysis import THUMBNAIL, AnalyzedPhotograph, CutPhotograph
from crfnet_core.files import read_json
from crfnet_core.library.camera import Camera, CameraSettings, KeptPhotograph, MeasuredResponse, checked_name
from crfnet_core.photograph.metadata import FileOrigin
from crfnet_core.photograph.recognition import Levels
from crfnet_core.photograph.recognition.levels import BINS
from crfnet_core.posterior import UNUSUAL, Evidence
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Float64Array, plain_values

#: The version of the document. Entries may be added to it; if one changes its meaning or goes, the version rises.
CAMERA_VERSION = 1

#: Bounds of the numbers of evidence and levels, and of standard deviations in stops: far beyond all that is measured.
LARGEST_NUMBER, LARGEST_DEVIATION = 1e9, 100.0


def camera_document(camera: Camera) -> dict[str, Any]:
    """Return a camera as plain lists, texts and numbers, ready for JSON; `read_camera` gives one with the same."""
    measured = camera.measured
    document = {
        "kind": "camera",
        "camera_version": CAMERA_VERSION,
        "name": camera.name,
        "measured": _measured_document(measured) if measured else None,
        "photographs": [_photograph_document(photograph) for photograph in camera.photographs],
    }
    return dict(plain_values(document))


def read_camera(path: Path) -> Camera:
    """Return the camera in a JSON file.

    Raises
    ------
    CameraError
        If the file cannot be read, is damaged, or is of a later version.
    """
    document = _read_object(path)
    if document.get("kind") != "camera":
        raise CameraError(f"{path}: describes no camera; remove the file, or restore it")
    if (version := document.get("camera_version")) != CAMERA_VERSION:
        raise CameraError(
            f"{path}: has camera_version {one_line(str(version))}, this crfnet reads {CAMERA_VERSION}: update it"
        )
    try:
        measured = document["measured"]
        return Camera(
            name=checked_name(document["name"]),
            measured=_measured(measured) if measured else None,
            photographs=tuple(map(_photograph, document["photographs"])),
        )
    except (CRFNetError, AttributeError, KeyError, OverflowError, TypeError, ValueError) as problem:
        raise CameraError(f"{path}: is damaged ({one_line(problem)}); restore or remove it") from None


def read_calibration(path: Path) -> MeasuredResponse:
    """Return the measured response in the document that `crfnet calibrate` writes.

    Raises
    ------
    CameraError
        If the file cannot be read, or is no such document.
    """
    document = _read_object(path)
    if document.get("kind") != "calibration":
        raise CameraError(f"{path}: is no measured response; give the JSON that crfnet calibrate wrote")
    try:
        frames, camera = document["frames"], document["camera"]
        used = [frame for frame in frames if frame["used"]]
        iso = _sensitivities({round(frame["iso"]) for frame in used if frame["iso"]})
        return MeasuredResponse(
            curve=ResponseCurve.restored(document["response"]["brightness"]),
            shape_stops=_deviation(document["shape_uncertainty_stops"]),
            scale_stops=_deviation(document["scale_uncertainty_stops"]),
            source=f"{len(used)} exposures",
            settings=CameraSettings(camera["make"], camera["model"], camera["firmware"], iso),
            warnings=tuple(map(str, document["warnings"])),
        )
    except (CRFNetError, AttributeError, KeyError, OverflowError, TypeError, ValueError) as problem:
        raise CameraError(f"{path}: is damaged ({one_line(problem)}); calibrate again") from None


def _read_object(path: Path) -> dict[str, Any]:
    """Return the object in a JSON file."""
    try:
        document = read_json(path)
    except OSError as problem:
        raise CameraError(f"{path}: cannot be read ({problem.strerror}); check its name") from None
    except ValueError:
        raise CameraError(f"{path}: is not JSON; restore or remove it") from None
    return document if isinstance(document, dict) else {}


def _measured_document(measured: MeasuredResponse) -> dict[str, Any]:
    """Return a measured response, ready for JSON."""
    return {
        **asdict(measured.settings),
        "source": measured.source,
        "shape_stops": measured.shape_stops,
        "scale_stops": measured.scale_stops,
        "warnings": measured.warnings,
        "brightness": measured.curve.brightness,
    }


def _measured(entry: Mapping[str, Any]) -> MeasuredResponse:
    """Return the measured response in a document."""
    return MeasuredResponse(
        curve=ResponseCurve(np.array(entry["brightness"], np.float64)),
        shape_stops=_deviation(entry["shape_stops"]),
        scale_stops=_deviation(entry["scale_stops"]),
        source=str(entry["source"]),
        settings=_settings(entry),
        warnings=tuple(map(str, entry["warnings"])),
    )


def _photograph_document(photograph: KeptPhotograph) -> dict[str, Any]:
    """Return what is kept of a photograph, ready for JSON."""
    analyzed = photograph.analyzed.photograph
    return {
        "name": analyzed.name,
        "sha256": photograph.sha256,
        **asdict(photograph.settings),
        "network": photograph.model,
        "origin": asdict(analyzed.origin) if analyzed.origin else None,
        "is_gray": analyzed.is_gray,
        "clipped": analyzed.clipped,
        "evidence": vars(photograph.analyzed.evidence),
        "levels": {name: counts.astype(np.int64) for name, counts in vars(analyzed.levels).items()},
        "thumbnail": analyzed.thumbnail.ravel().astype(np.int64),
    }


def _photograph(entry: Mapping[str, Any]) -> KeptPhotograph:
    """Return the photograph in a document."""
    evidence, levels, settings = entry["evidence"], entry["levels"], _settings(entry)
    size, odds = EVIDENCE_WEIGHTS, len(UNUSUAL)
    return KeptPhotograph(
        sha256=str(entry["sha256"]),
        model=str(entry["network"]),
        settings=settings,
        analyzed=AnalyzedPhotograph(
            photograph=CutPhotograph(
                name=str(entry["name"]),
                windows=(),
                samples=np.empty((0, 0, 0, 3), np.float32),
                thumbnail=_numbers(entry["thumbnail"], THUMBNAIL * THUMBNAIL).reshape(THUMBNAIL, THUMBNAIL),
                levels=Levels(_numbers(levels["histogram"], BINS), _numbers(levels["luma"], BINS)),
                make=settings.make,
                origin=FileOrigin.from_dict(entry["origin"]) if entry["origin"] else None,
                is_gray=bool(entry["is_gray"]),
                clipped=float(entry["clipped"]),
            ),
            evidence=Evidence(
                location=_numbers(evidence["location"], size),
                factor=_numbers(evidence["factor"], size, size),
                log_odds=_numbers(evidence["log_odds"], odds),
            ),
        ),
    )


def _settings(entry: Mapping[str, Any]) -> CameraSettings:
    """Return the settings in a document."""
    make, model, software = (str(entry[name]) for name in ("make", "model", "software"))
    return CameraSettings(make, model, software, _sensitivities(entry["iso"]))


def _sensitivities(values: Iterable[Any]) -> tuple[int, ...]:
    """Return ISO sensitivities, sorted."""
    iso = tuple(sorted(map(int, values)))
    if iso and not 1 <= iso[0] <= iso[-1] < LARGEST_NUMBER:
        raise ValueError(f"{iso[0] if iso[0] < 1 else iso[-1]:.3g} is no ISO sensitivity")
    return iso


def _numbers(values: Any, *shape: int) -> Float64Array:
    """Return numbers of this shape, which can be computed with."""
    numbers = np.array(values, np.float64)
    if numbers.shape != shape or not (np.abs(numbers) < LARGEST_NUMBER).all():
        raise ValueError(f"numbers of shape {numbers.shape} instead of {shape}, or too large")
    return numbers


def _deviation(value: Any) -> float:
    """Return a standard deviation in stops."""
    if not 0 <= (deviation := float(value)) < LARGEST_DEVIATION:
        raise ValueError(f"{value} is no standard deviation")
    return deviation
