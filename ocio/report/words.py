"""Estimates, plates, LUTs and models in words: the lines that the command and the add-on show."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from crfnet_core.estimate import ResponseEstimate
from crfnet_core.network import Verdict
from ocio.defaults import GAMMA_ERROR
from ocio.output_files import OutputFiles
from ocio.plates.frames import format_frames
from ocio.plates.linear import PlateReport
from ocio.report.documents import QUARTERS
from ocio.report.facts import agreeing, brightness_percent

#: The verdicts in words for people.
VERDICTS = {
    Verdict.GOOD: "good",
    Verdict.USABLE: "usable: look at the plate before you rely on it",
    Verdict.DO_NOT_TRUST: "not to be trusted: take another photograph of this camera, or several together",
}


def source_line(estimate: ResponseEstimate) -> str:
    """Return from which photographs a response was estimated."""
    first, *others = estimate.photos
    return f"Response estimated from {first}" + (f" and {len(others)} more frames." if others else ".")


def verdict_lines(estimate: ResponseEstimate) -> list[str]:
    """Return the agreement of the windows, the verdict, the uncertainty and the warnings, one line each."""
    error, gamma_error = brightness_percent(estimate.uncertainty), brightness_percent(GAMMA_ERROR)
    return [
        f"{agreeing(estimate)}.",
        f"The estimate is {VERDICTS[estimate.verdict]}.",
        f"Expect it to be off by {error:.1f} % of the brightness range (E_est {estimate.uncertainty:.2f});"
        f" gamma 2.2 is usually off by {gamma_error:.0f} %.",
        *(f"Warning: {warning}." for warning in estimate.warnings),
    ]


def result_line(estimate: ResponseEstimate) -> str:
    """Return the photograph, the verdict and the uncertainty on one line, for lists of estimates."""
    percent = brightness_percent(estimate.uncertainty)
    warnings = "".join(f"; {warning}" for warning in estimate.warnings)
    error = f"expected error {estimate.uncertainty:.2f} ({percent:.1f} %)"
    return f"{estimate.photos[0]}: {estimate.verdict}, {error}{warnings}"


def file_lines(files: OutputFiles) -> list[str]:
    """Return what was written, one line for each kind of file; names are relative to the folder."""
    rows = [
        (files.luts, "inverse response as a LUT"),
        ((files.config,), f'OpenColorIO config with "{files.color_space}"'),
        (files.linear, "linear plate"),
        ((files.sheet,), "the curve, its uncertainty and the windows"),
        ((files.report,), "all figures"),
    ]
    named = [(", ".join(path.name for path in paths if path), meaning) for paths, meaning in rows]
    width = min(48, max(len(names) for names, _ in named))
    return [f"  {names:<{width}}  {meaning}" for names, meaning in named if names]


def oiiotool_lines(photo: Path, files: OutputFiles) -> list[str]:
    """Return two command lines by which oiiotool makes the linear plate: with the LUT and with the config."""
    lut, config, plate = (shlex.quote(str(path)) for path in (files.spi1d, files.config, photo))
    space = shlex.quote(files.color_space)
    return [
        f"oiiotool {plate} --ociofiletransform {lut} -d half -o linear.exr",
        f"oiiotool --colorconfig {config} {plate} --colorconvert {space} scene_linear -d half -o linear.exr",
    ]


def plate_lines(report: PlateReport) -> list[str]:
    """Return which frames were written, left alone or missing, one line each."""
    lines = []
    if report.written:
        lines.append(f"Written: {_first_and_last(report.written)}.")
    if report.skipped:
        lines.append(f"Already there and left alone (add --overwrite otherwise): {_first_and_last(report.skipped)}.")
    if report.missing:
        lines.append(f"Missing frames: {format_frames(report.missing)}.")
    return lines


def lut_lines(document: Mapping[str, Any]) -> list[str]:
    """Return what a LUT file holds, from its `lut_document`."""
    quarters = ", ".join(f"{b} -> {e:.4f}" for b, e in zip(QUARTERS, document["at_quarters"], strict=True))
    low, high = document["domain"]
    bottom, top = document["range"]
    return [
        f"{document['file']}: 1D LUT of {document['length']} entries, strictly increasing",
        f"  brightness {low:g} to {high:g} becomes irradiance {bottom:g} to {top:g}; {quarters}",
        *(f"  {line}" for line in document["provenance"]),
    ]


def model_lines(document: Mapping[str, Any]) -> list[str]:
    """Return what a model's configuration says, from its `model_document`."""
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


def _first_and_last(paths: Sequence[Path]) -> str:
    """Return a path, or the number of several paths and the first and the last of them."""
    return str(paths[0]) if len(paths) == 1 else f"{len(paths)} frames, {paths[0]} to {paths[-1].name}"


def _listed(value: object) -> str:
    """Return a value as text, a tuple as its elements with commas between."""
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)
