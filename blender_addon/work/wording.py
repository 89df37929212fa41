# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's own sentences about estimates and errors, by their codes."""

from __future__ import annotations

import math
import re
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


class PanelText(NamedTuple):
    """The panel's sentences about an estimate: paragraphs are separated by line breaks."""

    advice: str = ""  # of an estimate that is not to be trusted: the cause, then the remedy
    details: str = ""
    warnings: str = ""


def panel_text(estimate: ResponseEstimate) -> PanelText:
    """Return the panel's sentences about an estimate."""
    from crfnet.report.facts import Phrases
    from crfnet.report.words import verdict_advice, verdict_lines

    if is_loaded(estimate.uncertainty):
        return PanelText(details=f"The response is {estimate.model}: it is not an estimate, so it has no verdict.")
    phrases = Phrases(calibrate="", state_device=", or choose Advanced > Taken With", has_e_est=False)
    _verdict, *lines = verdict_lines(estimate, phrases)
    causes = [warning for warning in estimate.warnings if warning.code == "recognized"]
    others = [warning for warning in estimate.warnings if warning not in causes]
    return PanelText(
        advice=_sentences([*causes, *verdict_advice(estimate, phrases).split(", so ")]),
        details="\n".join(lines[: len(lines) - len(estimate.warnings)]),  # the warnings come last
        warnings=_sentences(others),
    )


def is_loaded(uncertainty: float) -> bool:
    """Return whether a response of this expected error was loaded from a LUT file: then it is NaN."""
    return math.isnan(uncertainty)


def problem_line(problem: Exception) -> str:
    """Return the sentence of an error, with the remedy in Blender."""
    remedy = REMEDIES.get(getattr(problem, "code", ""))
    return f"{problem}; {remedy}" if remedy else str(problem)


def _sentences(texts: Iterable[object]) -> str:
    """Return texts with a capital letter and a full stop, a line each; empty ones are left out."""
    return "\n".join(f"{text[:1].upper()}{text[1:]}." for text in map(str, texts) if text)


def says_too_little(verdict: str, codes: Iterable[str]) -> bool:
    """Return whether an estimate is little more than the mean of cameras, though its verdict is usable."""
    return verdict != "do not trust" and "narrow_range" in codes


def report_line(name: str, estimate: ResponseEstimate, done: str) -> str:
    """Return one line for Blender's status bar: the plate, the verdict, the first warning, and what was done.

    Blender cuts lines that are too long in their middle, so the name is short, and the warning only its first part.
    """
    name = shortened(name)
    if is_loaded(estimate.uncertainty):
        return f"{name}: the response is {estimate.model}; {done}"
    warning = ""
    if estimate.warnings:
        first, *others = map(str, estimate.warnings)
        more = f", and {len(others)} more" if others else ""
        warning = f" (warning: {re.split('[:,;] ', first)[0]}{more})"
    verdict = estimate.verdict.value
    sentence = f"the response is {'not to be trusted' if verdict == 'do not trust' else verdict}"
    if says_too_little(verdict, [each.code for each in estimate.warnings]):
        sentence = "the response is little more than the mean of cameras"
    return f"{name}: {sentence}{warning}; {done}"


def shortened(text: str, most: int = 48) -> str:
    """Return a name or path of at most so many letters: the middle of a longer one is left out."""
    return text if len(text) <= most else f"{text[: most // 2 - 2]}...{text[1 - most // 2 :]}"
