# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on says of an estimate, in the American English of Blender's interface."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate

#: British spellings in the messages of `crfnet_core` and `ocio`, and the American ones.
_AMERICAN = {
    "colour": "color",
    "grey": "gray",
    "linearise": "linearize",
    "linearisation": "linearization",
    "analyse": "analyze",
    "cancelled": "canceled",
    "centre": "center",
}

_BRITISH = re.compile("|".join(_AMERICAN), re.IGNORECASE)

#: What messages say of the command's options and of Python's packages, and what there is in Blender instead.
_IN_BLENDER = {
    "ignore metadata": "tick Estimate Anyway under Advanced",
    "add --encoded": "choose for it a color space that is not linear, or tick Estimate Anyway under Advanced",
    "with --taken-with which": "with Taken With under Advanced which",
    "there is no such file; check the name, or give a sequence such as plate.%04d.png or plate.####.png": "there is no"
    " such file; find it with File, External Data",
    "are too far apart; say which frames to use": "are too far apart to be one sequence; move those away that do not"
    " belong to it",
    "give any, camera or a JSON file": "choose another Prior File, or expect Camera",
    "there is no frame of this name; check the name and the frames": "none of its frames is found; find them with File,"
    " External Data",
    ", or give the primaries of all with --primaries": "",
    ", or run crfnet calibrate": "",
    "pip install 'pi-heif' 'pillow'": "install the add-on again from its zip, or save it as JPEG or PNG",
    "pip install 'av', or save it": "save it",
}

#: The remedy in Blender by the code of an error, whose own sentence names none; it follows the sentence after "; ".
REMEDIES = {
    # library
    "no_camera": "choose another Camera under Advanced, or none",
}

#: What shows that a word is part of a path, a file name or a quoted name.
_NAME = re.compile(r"[/\\\"']|\.\w")

#: The estimation error in the units of the literature, which the panel leaves out.
_ESTIMATION_ERROR = re.compile(r" \(E_est [\d.]+\)")

#: How the warning begins of a picture that hardly tells one response from another, such as a gray card.
_SAYS_TOO_LITTLE = "no window covers the range of brightness"

#: Each verdict as a sentence about the response, for one-line reports.
_SENTENCES = {
    "good": "the response is good",
    "usable": "the response is usable",
    "do not trust": "the response is not to be trusted",
}

#: How the model of a response is named that was loaded from a LUT file, so that it is no estimate and has no verdict.
LOADED = "loaded from "


def is_loaded(estimate: ResponseEstimate) -> bool:
    """Return whether a response was loaded from a LUT file."""
    return estimate.model.startswith(LOADED)


def loaded_line(model: str) -> str:
    """Return what the panel says of a response that was loaded from a LUT file, in place of a verdict."""
    return f"The response is {model}: this is no estimate, so there is no verdict."


def american(text: str) -> str:
    """Return a message in American spelling, with Blender's settings in the place of the command's options.

    Words that belong to a file or a quoted name stay as they are.
    """
    for of_command, in_blender in _IN_BLENDER.items():
        text = text.replace(of_command, in_blender)
    return " ".join(word if _NAME.search(word) else _BRITISH.sub(_spelled, word) for word in text.split(" "))


def problem_line(problem: Exception) -> str:
    """Return the sentence of an error, with the remedy in Blender."""
    remedy = REMEDIES.get(getattr(problem, "code", ""))
    return american(f"{problem}; {remedy}" if remedy else str(problem))


def panel_line(line: str) -> str:
    """Return a line of the report as the panel says it: in American spelling, without E_est."""
    return american(_ESTIMATION_ERROR.sub("", line))


def capitalized(text: str) -> str:
    """Return a text with a capital letter at its beginning; the others stay as they are."""
    return text[:1].upper() + text[1:]


def says_too_little(verdict: str, warnings: Iterable[str]) -> bool:
    """Return whether an estimate is little more than the mean of cameras, though its verdict is good or usable."""
    return verdict != "do not trust" and any(warning.startswith(_SAYS_TOO_LITTLE) for warning in warnings)


def report_line(name: str, estimate: ResponseEstimate, done: str) -> str:
    """Return one line for Blender's status bar: the plate, the verdict, the first warning, and what was done.

    Blender cuts lines that are too long in their middle, so the advice behind the colon of a warning is left out.
    """
    if is_loaded(estimate):
        return f"{name}: the response is {estimate.model}; {done}"
    first, *others = estimate.warnings or ("",)
    finding = first.partition(": ")[0]
    warning = f" (warning: {finding}{f', and {len(others)} more' if others else ''})" if first else ""
    sentence = _SENTENCES[estimate.verdict.value]
    if says_too_little(estimate.verdict.value, estimate.warnings):
        sentence = "the response is little more than the mean of cameras"
    return american(f"{name}: {sentence}{warning}; {done}")


def _spelled(match: re.Match[str]) -> str:
    """Return the American spelling of a British one, with its capital letter."""
    american_word = _AMERICAN[match[0].lower()]
    return american_word.capitalize() if match[0][0].isupper() else american_word
