# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's own sentences about estimates and errors, by their codes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate

#: Code of an error -> what to do in Blender, behind "; " at the end of its sentence, which names no button.
REMEDIES = {
    "no_camera": "choose another Camera under Advanced, or none",
    "exr_untagged": "choose for it a color space that is not linear, or tick Estimate Anyway under Advanced",
    "frames_far_apart": "move those away that do not belong to the sequence",
    "no_such_frames": "find them with File, External Data",
    "no_such_plate": "find it with File, External Data",
    "heif_package_missing": "install the add-on again from its zip, or save it as JPEG or PNG",
    "tagged_color_space": "tick Estimate Anyway under Advanced",
    "tagged_encoding": "tick Estimate Anyway under Advanced",
    "tagged_linear": "tick Estimate Anyway under Advanced",
    "file_exists": "tick Overwrite",
    "files_exist": "tick Overwrite",
}

#: Code of a warning -> the few words that fit into Blender's status bar; other warnings stand there as they are.
SHORT_WARNINGS = {
    "answer_of_windows": "the paper's network, worse than the default",
    "clipped": "mostly clipped",
    "developed": "developed from a raw file by {editor}",
    "edited": "saved by {editor}",
    "gray": "gray photograph",
    "narrow_range": "no window covers the range of brightness",
}


class PanelText(NamedTuple):
    """The panel's sentences about an estimate: paragraphs are separated by line breaks."""

    advice: str = ""
    details: str = ""
    warnings: str = ""


def panel_text(estimate: ResponseEstimate) -> PanelText:
    """Return the panel's sentences about an estimate."""
    from crfnet.report.facts import Phrases
    from crfnet.report.words import verdict_advice, verdict_lines

    if is_loaded(estimate.uncertainty):
        return PanelText(details=f"The response is {estimate.model}: it is not an estimate, so it has no verdict.")
    device = ", or say with Taken With under Advanced which kind of camera took it, if it is a photograph"
    phrases = Phrases(calibrate="", state_device=device, has_e_est=False)
    _verdict, *lines = verdict_lines(estimate, phrases)
    return PanelText(
        advice=_sentence(verdict_advice(estimate, phrases)),
        details="\n".join(lines[: len(lines) - len(estimate.warnings)]),  # the warnings come last
        warnings="\n".join(_sentence(str(warning)) for warning in estimate.warnings),
    )


def is_loaded(uncertainty: float) -> bool:
    """Return whether a response of this expected error was loaded from a LUT file: then it is NaN."""
    return math.isnan(uncertainty)


def problem_line(problem: Exception) -> str:
    """Return the sentence of an error, with the remedy in Blender."""
    remedy = REMEDIES.get(getattr(problem, "code", ""))
    return f"{problem}; {remedy}" if remedy else str(problem)


def _sentence(text: str) -> str:
    """Return a text with a capital letter and a full stop; an empty one as it is."""
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def says_too_little(verdict: str, codes: Iterable[str]) -> bool:
    """Return whether an estimate is little more than the mean of cameras, though its verdict is usable."""
    return verdict != "do not trust" and "narrow_range" in codes


def report_line(name: str, estimate: ResponseEstimate, done: str) -> str:
    """Return one line for Blender's status bar: the plate, the verdict, the first warning, and what was done.

    Blender cuts lines that are too long in their middle, so names and warnings are short.
    """
    name = shortened(name)
    if is_loaded(estimate.uncertainty):
        return f"{name}: the response is {estimate.model}; {done}"
    warning = ""
    if estimate.warnings:
        more = f", and {len(estimate.warnings) - 1} more" if estimate.warnings[1:] else ""
        warning = f" (warning: {_first_warning(estimate)}{more})"
    verdict = estimate.verdict.value
    sentence = f"the response is {'not to be trusted' if verdict == 'do not trust' else verdict}"
    if says_too_little(verdict, [each.code for each in estimate.warnings]):
        sentence = "the response is little more than the mean of cameras"
    return f"{name}: {sentence}{warning}; {done}"


def shortened(text: str, most: int = 48) -> str:
    """Return a name or path of at most so many letters: the middle of a longer one is left out."""
    return text if len(text) <= most else f"{text[: most // 2 - 2]}...{text[1 - most // 2 :]}"


def _first_warning(estimate: ResponseEstimate) -> str:
    """Return the first warning in a few words."""
    first = estimate.warnings[0]
    if estimate.recognition and first.code == "recognized":
        return estimate.recognition.kind.value
    short = SHORT_WARNINGS.get(first.code)
    return short.format(**first.facts) if short else str(first)
