"""An estimate in words for people, as a document for machines, and as provenance lines for LUT files."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.estimate import ResponseEstimate, WindowEstimate
from crfnet_core.network import ModelConfig, Verdict
from crfnet_core.photo import Photo
from crfnet_core.response import SAMPLES
from ocio.defaults import GAMMA_ERROR
from ocio.luts.lut1d import Lut1D
from ocio.output_files import OutputFiles
from ocio.plates.frames import format_frames
from ocio.plates.linear import PlateReport

#: Digits kept in the JSON document.
DIGITS = 6

#: The verdicts in words for people.
VERDICTS = {
    Verdict.GOOD: "good",
    Verdict.USABLE: "usable: look at the plate before you rely on it",
    Verdict.DO_NOT_TRUST: "not to be trusted: take another photograph of this camera, or several together",
}


@dataclass(frozen=True)
class PhotoFacts:
    """What the report says of a photograph once its pixels are gone: file name, pixels across and down, bits."""

    name: str
    width: int
    height: int
    bit_depth: int

    @classmethod
    def of(cls, photo: Photo) -> PhotoFacts:
        """Return the facts of a photograph."""
        height, width = photo.pixels.shape[:2]
        return cls(photo.path.name, width, height, photo.bit_depth)

    def __str__(self) -> str:
        """Return one line for people."""
        return f"{self.name}: {self.width} x {self.height}, {self.bit_depth} bits"


def brightness_percent(error: float) -> float:
    """Return an estimation error (E_est) as root-mean-square percent of the brightness range."""
    return float(100 * error / np.sqrt(SAMPLES))


def agreeing(estimate: ResponseEstimate) -> str:
    """Return how many windows agree with the others, in words."""
    return f"{sum(window.kept for window in estimate.windows)} of {len(estimate.windows)} windows agree"


def source_line(estimate: ResponseEstimate) -> str:
    """Return which photographs an estimate comes from, in words."""
    first, *others = estimate.photos
    return f"Response estimated from {first}" + (f" and {len(others)} more frames." if others else ".")


def verdict_lines(estimate: ResponseEstimate) -> list[str]:
    """Return the verdict, its uncertainty in words and the warnings, one line each."""
    off, gamma = brightness_percent(estimate.uncertainty), brightness_percent(GAMMA_ERROR)
    return [
        f"{agreeing(estimate)}.",
        f"The estimate is {VERDICTS[estimate.verdict]}.",
        f"Expect it to be off by {off:.1f} % of the brightness range (E_est {estimate.uncertainty:.2f});"
        f" gamma 2.2 is usually off by {gamma:.0f} %.",
        *(f"Warning: {warning}." for warning in estimate.warnings),
    ]


def provenance(estimate: ResponseEstimate) -> tuple[str, ...]:
    """Return the lines that LUT files carry: what this is, of which photographs, by which model, how sure."""
    return (
        "Inverse camera response: encoded brightness in, relative scene-linear irradiance out",
        f"Photographs: {', '.join(estimate.photos)}",
        f"Model: {estimate.model}",
        f"Verdict: {estimate.verdict}, expected estimation error {estimate.uncertainty:.2f}"
        f" ({brightness_percent(estimate.uncertainty):.1f} % of the brightness range)",
    )


def oiiotool_lines(photo: Path, files: OutputFiles) -> list[str]:
    """Return two command lines that make the linear plate in oiiotool: with the LUT and with the config."""
    lut, config, plate = (shlex.quote(str(path)) for path in (files.spi1d, files.config, photo))
    space = shlex.quote(files.color_space)
    return [
        f"oiiotool {plate} --ociofiletransform {lut} -d half -o linear.exr",
        f"oiiotool --colorconfig {config} {plate} --colorconvert {space} scene_linear -d half -o linear.exr",
    ]


def result_line(estimate: ResponseEstimate) -> str:
    """Return photograph, verdict and uncertainty on one line, for lists of many."""
    off = brightness_percent(estimate.uncertainty)
    cautions = "".join(f"; {warning}" for warning in estimate.warnings)
    return (
        f"{estimate.photos[0]}: {estimate.verdict}, expected error {estimate.uncertainty:.2f} ({off:.1f} %){cautions}"
    )


def file_lines(files: OutputFiles) -> list[str]:
    """Return what was written, one line a kind, as names relative to the folder."""
    rows = [
        ((files.spi1d, files.cube, files.clf), "inverse response as a LUT"),
        ((files.config,), f'OpenColorIO config with "{files.color_space}"'),
        (files.linear, "linear plate"),
        ((files.sheet,), "the curve, its uncertainty and the windows"),
        ((files.report,), "all figures"),
    ]
    named = [(", ".join(path.name for path in paths if path), meaning) for paths, meaning in rows]
    width = min(48, max(len(names) for names, _ in named))
    return [f"  {names:<{width}}  {meaning}" for names, meaning in named if names]


def estimate_document(estimate: ResponseEstimate, photos: Sequence[PhotoFacts], files: OutputFiles) -> dict[str, Any]:
    """Return everything that is known of an estimate, ready for JSON; file names are relative to the folder."""
    return {
        "photographs": [vars(photo) for photo in photos],
        **_judgement(estimate),
        "weights": _rounded(estimate.weights),
        "windows": [_window_document(window) for window in estimate.windows],
        "response": {
            "brightness": _rounded(estimate.curve.brightness),
            "lower": _rounded(estimate.band[0]),
            "upper": _rounded(estimate.band[1]),
        },
        "color_space": files.color_space,
        "files": _file_names(files),
    }


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document as JSON text: any language as it is written, and each row of numbers on one line."""
    text = json.dumps(document, indent=1, ensure_ascii=False)
    return re.sub(r"\[\n[-+\d.eE,\s]+\]", lambda row: " ".join(row[0].split()), text) + "\n"


def plate_document(report: PlateReport, estimate: ResponseEstimate | None) -> dict[str, Any]:
    """Return what became of plates, and the response if it was estimated from them, ready for JSON."""
    return {
        "written": [str(path) for path in report.written],
        "skipped": [str(path) for path in report.skipped],
        "missing": list(report.missing),
        "estimate": {"photographs": list(estimate.photos), **_judgement(estimate)} if estimate else None,
    }


def plate_lines(report: PlateReport) -> list[str]:
    """Return `plate_document` in words."""
    lines = []
    if report.written:
        lines.append(f"Written: {_first_and_last(report.written)}.")
    if report.skipped:
        lines.append(f"Already there and left alone (add --overwrite otherwise): {_first_and_last(report.skipped)}.")
    if report.missing:
        lines.append(f"Missing frames: {format_frames(report.missing)}.")
    return lines


def lut_document(path: Path, lut: Lut1D) -> dict[str, Any]:
    """Return what a LUT file holds, ready for JSON."""
    first, last = lut.domain
    return {
        "kind": "lut",
        "file": path.name,
        "length": len(lut.values),
        "domain": [_rounded(first), _rounded(last)],
        "range": [_rounded(lut.values[0]), _rounded(lut.values[-1])],
        "at_quarters": _rounded(lut.apply(np.array([0.25, 0.5, 0.75]))),
        "provenance": list(lut.comments),
    }


def lut_lines(document: Mapping[str, Any]) -> list[str]:
    """Return `lut_document` in words."""
    quarters = ", ".join(f"{b} -> {e:.4f}" for b, e in zip((0.25, 0.5, 0.75), document["at_quarters"], strict=True))
    low, high = document["domain"]
    bottom, top = document["range"]
    return [
        f"{document['file']}: 1D LUT of {document['length']} entries, strictly increasing",
        f"  brightness {low:g} to {high:g} becomes irradiance {bottom:g} to {top:g}; {quarters}",
        *(f"  {line}" for line in document["provenance"]),
    ]


def model_document(config: ModelConfig) -> dict[str, Any]:
    """Return what a model's configuration says, ready for JSON."""
    return {"kind": "model", **asdict(config)}


def model_lines(document: Mapping[str, Any]) -> list[str]:
    """Return `model_document` in words."""
    left_out = ("kind", "name", "uncertainty_model", "accuracy")
    return [
        f"{document['name']}: model",
        *(f"  {key}: {_listed(value)}" for key, value in document.items() if key not in left_out),
        *(
            f"  accuracy, {protocol}, {figure}: {value}"
            for protocol, figures in document["accuracy"].items()
            for figure, value in figures.items()
        ),
    ]


def _listed(value: object) -> str:
    """Return a value in words, a sequence as its parts."""
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _judgement(estimate: ResponseEstimate) -> dict[str, Any]:
    """Return how far to trust an estimate, ready for JSON."""
    return {
        "verdict": estimate.verdict,
        "uncertainty": _rounded(estimate.uncertainty),
        "uncertainty_percent": _rounded(brightness_percent(estimate.uncertainty)),
        "spread": _rounded(estimate.spread),
        "warnings": list(estimate.warnings),
        "model": estimate.model,
    }


def _first_and_last(paths: Sequence[Path]) -> str:
    """Return a path, or the first and the last of several and their number."""
    return str(paths[0]) if len(paths) == 1 else f"{len(paths)} frames, {paths[0]} to {paths[-1].name}"


def _window_document(estimate: WindowEstimate) -> dict[str, Any]:
    """Return where a window lies and what became of it."""
    window = estimate.window
    place = {"photo": estimate.photo, "x": window.x, "y": window.y, "extent": window.extent, "filled": window.filled}
    return {**place, "expected_error": _rounded(estimate.expected_error), "kept": estimate.kept}


def _file_names(files: OutputFiles) -> dict[str, str | list[str] | None]:
    """Return the names of the files, by kind."""
    return {
        "spi1d": files.spi1d.name,
        "cube": files.cube.name,
        "clf": files.clf.name,
        "config": files.config.name,
        "linear": [path.name for path in files.linear],
        "sheet": files.sheet.name if files.sheet else None,
        "report": files.report.name,
    }


def _rounded(values: ArrayLike) -> Any:
    """Return a number, or a list of numbers, of at most `DIGITS` decimals."""
    return np.round(np.asarray(values, dtype=np.float64), DIGITS).tolist()
