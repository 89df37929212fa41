"""Estimates, plates and LUTs in words: the lines that the command and the add-on show."""

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from crfnet_core.estimate.result import CameraAnswer, ResponseEstimate
from crfnet_core.library import Camera
from crfnet_core.posterior import Family, Verdict
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE, brightness_percent

from ..defaults import GAMMA_ERROR, GAMMA_SHAPE_ERROR, MIDDLE_GRAY, WHITE_ERROR
from ..output_files import OutputFiles
from ..plates.frame_numbers import format_frames
from ..plates.linear import PlateReport
from .documents import QUARTERS
from .facts import COMMAND, Phrases, agreeing, basis, curve_error_words, expected_errors, shape_error_words

VERDICTS = {
    Verdict.USABLE: "usable: look at the linear plate before you rely on it",
    Verdict.DO_NOT_TRUST: "not to be trusted",
}

#: How much an estimate from photographs may claim.
RANK = (
    f"On real cameras white was off by {WHITE_ERROR:.1f} stop. These errors are averages and hardly rank photographs."
)

#: Difference from 0.18 by which 18 % gray lies where it should: 0.004 stop.
GRAY_TOLERANCE = 0.0005

#: Advice about a picture that is not to be trusted and of such a family.
REMEDIES = {
    Family.LINEAR: "it seems to be linear already, so give it a linear color space",
    Family.LOG: "it seems to be log footage, so give it the color space of its log curve",
    Family.UNEXPLAINED: "no camera response explains this picture, so use the file as the camera wrote it",
}


def source_line(estimate: ResponseEstimate) -> str:
    """Return from which photographs a response was estimated."""
    first, *others = estimate.photos
    return f"Response estimated from {first}" + (f" and {len(others)} more frames." if others else ".")


def verdict_lines(estimate: ResponseEstimate, phrases: Phrases = COMMAND) -> list[str]:
    """Return the verdict, the expected errors, the kind of response, what it rests on, and warnings: one line each."""
    kind, rests_on, advice = estimate.likely_kind, basis(estimate), verdict_advice(estimate, phrases)
    verdict = f"{VERDICTS[Verdict.DO_NOT_TRUST]}: {advice}" if advice else VERDICTS[estimate.verdict]
    return [
        f"The {'response' if estimate.camera else 'estimate'} is {verdict}.",
        _expectation(estimate, phrases),
        *([RANK] if estimate.prior and estimate.verdict is Verdict.USABLE else []),
        *([f"Most likely {kind}."] if kind else []),
        *([f"{rests_on}."] if rests_on else []),
        *([f"{agreeing(estimate)}."] if estimate.windows and not estimate.camera else []),
        *(f"Warning: {warning}." for warning in estimate.warnings),
    ]


def result_line(estimate: ResponseEstimate, *, name: str) -> str:
    """Return the photograph, the verdict, the uncertainty and the kind on one line, for lists of estimates."""
    notes = [*filter(None, [estimate.likely_kind]), *estimate.warnings]
    more = "".join(f"; {note}" for note in notes)
    return f"{name}: {estimate.verdict}, expected error {expected_errors(estimate)}{more}"


def file_lines(files: OutputFiles, *, sheet: str = "the curve, its uncertainty and the plate") -> list[str]:
    """Return what was written, one line for each kind of file; names are relative to the folder."""
    rows = [
        (files.luts, "inverse response as a LUT"),
        (files.forward, "response as a LUT: light in, code values out"),
        ((files.config,), f'OpenColorIO config with "{files.color_space}"'),
        (files.linear, "linear plate"),
        ((files.sheet,), sheet),
        ((files.report,), "all figures"),
    ]
    named = [(", ".join(path.name for path in paths if path), meaning) for paths, meaning in rows]
    width = min(48, max(len(names) for names, _ in named))
    return [f"  {names:<{width}}  {meaning}" for names, meaning in named if names]


def light_lines(document: Mapping[str, Any]) -> list[str]:
    """Return the primaries and the exposure of linear plates, from an `estimate_document` or a `plate_document`."""
    primaries, space = document["primaries"], document["output_space"]
    tagged, is_unknown = document.get("tagged"), "white" not in primaries
    return [
        *([f"Warning: the plate is tagged as {tagged}; the response is undone in it all the same."] * bool(tagged)),
        f"Primaries: {primaries['name']} ({primaries['source']}); the linear EXR is {space['name']}"
        f" ({space['interop_id']}).",
        *(["Warning: the colors are not converted; state the primaries with --primaries."] * is_unknown),
        _exposure_line(document["exposure"]),
    ]


def plate_lines(report: PlateReport) -> list[str]:
    """Return how much was clipped, and which frames were written, left alone or missing, one line each."""
    lines = []
    if report.clipped:
        lines.append(f"Warning: {100 * report.clipped:.2g} % of the values are outside the LUT and were clipped.")
    if report.sizes[1:]:
        sizes = ", ".join("{} x {}".format(*size) for size in report.sizes[:4]) + ", ..." * bool(report.sizes[4:])
        lines.append(f"Warning: the frames have different sizes: {sizes}.")
    if report.written:
        lines.append(f"Written: {_first_and_last(report.written)}.")
    if report.skipped:
        lines.append(f"Already there and left alone (--overwrite replaces them): {_first_and_last(report.skipped)}.")
    if report.missing:
        lines.append(f"Missing frames: {format_frames(report.missing)}.")
    return lines


def lut_lines(document: Mapping[str, Any]) -> list[str]:
    """Return what a LUT file holds, from its `lut_document`."""
    rows = document["at_quarters"] if document["channels"] == 3 else [document["at_quarters"]]
    quarters = ", ".join(
        f"{brightness} -> {' '.join(f'{value:.4f}' for value in values)}"
        for brightness, values in zip(QUARTERS, zip(*rows, strict=True), strict=True)
    )
    low, high = document["domain"]
    bottom, top = document["range"]
    first, second = document["converts"]
    return [
        f"{document['file']}: 1D LUT of {document['length']} entries, strictly increasing",
        f"  {first} {low:g} to {high:g} becomes {second} {bottom:g} to {top:g}; {quarters}",
        f"  {document['response']}",
        *(f"  {line}" for line in document["provenance"]),
    ]


def offer_lines(offers: Sequence[CameraAnswer]) -> list[str]:
    """Return one line that offers stored cameras of a photograph's make and model; nothing without any."""
    if not offers:
        return []
    named = " or ".join(f"--camera {shlex.quote(offer.name)} ({offer.basis})" for offer in offers)
    return [f"A response of this camera is known; to use it, add {named}."]


def camera_line(camera: Camera) -> str:
    """Return a camera in one line, for lists; its make and model where its name does not begin with them."""
    model = camera.settings.camera
    is_named = camera.name.casefold().startswith(model.casefold())
    return f"{camera.name}: {camera.basis if is_named else f'{model}; {camera.basis}'}"


def verdict_advice(estimate: ResponseEstimate, phrases: Phrases = COMMAND) -> str:
    """Return the advice about an estimate that is not to be trusted; empty for any other."""
    if estimate.recognition:
        return estimate.recognition.advice
    if estimate.verdict is not Verdict.DO_NOT_TRUST:
        return ""
    kind = estimate.likely_kind
    remedies = [REMEDIES[family] for family in kind.families if family in REMEDIES] if kind else []
    is_known = any(origin.names_device for origin in estimate.origins)
    is_stored = not estimate.windows  # a stored camera has none, and nobody is asked what it is
    advice = remedies[0] if remedies else f"give the file that the camera wrote{phrases.calibrate}"
    return advice + ("" if is_known or is_stored else phrases.state_device)


def _expectation(estimate: ResponseEstimate, phrases: Phrases) -> str:
    """Return how far the answer is expected to be off, and gamma 2.2; without stops if they are not known."""
    shape, curve = shape_error_words(estimate), curve_error_words(estimate, phrases)
    gamma = f"{brightness_percent(GAMMA_ERROR):.0f} %"
    if not shape:
        return f"Expected error: {curve} in the curve; gamma 2.2 usually has {gamma}."
    return (
        f"Expected error: {shape} in the linear light once the exposure is matched (RMS, codes {FIRST_SHAPE_CODE} to"
        f" {LAST_SHAPE_CODE}), {curve} in the curve; gamma 2.2 usually has {GAMMA_SHAPE_ERROR:.1f} stop and {gamma}."
    )


def _exposure_line(exposure: Mapping[str, Any]) -> str:
    """Return the exposure, where 18 % gray lies by it, and how many stops would put it right."""
    code, linear, wanted = round(255 * exposure["gray_brightness"]), exposure["gray_linear"], exposure["gray_stops"]
    line = f"Exposure: {exposure['stops']:+.2f} stop, which puts code {code} (18 % gray by convention) at {linear:.3f}"
    if wanted is None or abs(linear - MIDDLE_GRAY) < GRAY_TOLERANCE:
        return f"{line}."
    return f"{line}; --exposure gray puts it at {MIDDLE_GRAY} ({wanted:+.2f} stop)."


def _first_and_last(paths: Sequence[Path]) -> str:
    """Return a path, or the number of several paths and the first and the last of them."""
    return str(paths[0]) if len(paths) == 1 else f"{len(paths)} frames, {paths[0]} to {paths[-1].name}"
