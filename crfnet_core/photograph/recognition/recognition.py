"""What a picture is if it is no photograph as a camera renders it: its kind, in words, with what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from crfnet_core.photograph.metadata import FileOrigin
from crfnet_core.photograph.recognition.levels import Levels
from crfnet_core.photograph.recognition.limited_range import is_limited_range
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES
from crfnet_core.photograph.recognition.log_footage import nearest_curves

#: Probability of log footage above which it counts as recognized.
RECOGNIZED = 0.5


class Kind(StrEnum):
    """What is recognized."""

    LOG_FOOTAGE = "log footage"
    LIMITED_RANGE = "limited range"
    RENDERING = "rendering"
    SENT_COPY = "sent copy"


@dataclass(frozen=True)
class Recognition:
    """What a picture is, by its pixels or its metadata.

    Parameters
    ----------
    kind : Kind
        What it is.
    reason : str
        What was measured, in words.
    advice : str
        What to do.
    curves : tuple of str
        Of log footage up to four published curves whose levels fit, the likeliest first.
    probabilities : tuple of float
        Of each, by the levels alone.
    errors : tuple of float
        How far the light of each is expected to be off, in stops.
    color_space : str
        The name in ACES configs of the one whose light is expected to be off least; empty if it has none.
    """

    kind: Kind
    reason: str
    advice: str
    curves: tuple[str, ...] = ()
    probabilities: tuple[float, ...] = ()
    errors: tuple[float, ...] = ()
    color_space: str = ""

    @classmethod
    def from_dict(cls, entry: Mapping[str, Any] | None) -> Recognition | None:
        """Return what `dataclasses.asdict` made of a recognition, also after JSON; None for an ordinary picture."""
        if entry is None:
            return None
        several = {name: tuple(entry.get(name, ())) for name in ("curves", "probabilities", "errors")}
        return cls(**{**entry, **several, "kind": Kind(entry["kind"])})


def recognize(
    levels: Levels,
    *,
    log_probability: float,
    makes: tuple[str, ...] = (),
    origins: Sequence[FileOrigin] = (),
) -> Recognition | None:
    """Return what the pictures of an estimate are, if they are no photographs as a camera renders them; else None.

    Parameters
    ----------
    levels : Levels
        Of all photographs of an estimate together.
    log_probability : float
        The probability of log footage, in which the levels have been counted: see `log_factor`.
    makes : tuple of str
        The makers that the files name.
    origins : sequence of FileOrigin
        What the metadata says of each picture.
    """
    if is_limited_range(levels):
        return _LIMITED_RANGE
    if log_probability > RECOGNIZED:
        return _log_footage(levels, makes)
    return next(filter(None, map(_by_origin, origins)), None)


def _by_origin(origin: FileOrigin) -> Recognition | None:
    """Return what the metadata says that a picture is, if it is a rendering or a sent copy."""
    if origin.renderer:
        return Recognition(
            kind=Kind.RENDERING,
            reason=f"a rendering by {origin.renderer}, as its metadata says: no camera made it",
            advice="render a linear EXR, or undo the view transform with the renderer's OpenColorIO config",
        )
    if origin.is_sent_copy:
        return Recognition(
            kind=Kind.SENT_COPY,
            reason="a copy as messengers and web sites send it: no camera named, scaled, and compressed as JPEG of"
            f" quality {origin.jpeg_quality}; both change what the estimate reads",
            advice="ask for the file that the camera wrote",
        )
    return None


def _log_footage(levels: Levels, makes: tuple[str, ...]) -> Recognition:
    """Return that a picture is log footage, with the curves that fit."""
    near = nearest_curves(levels, makes)
    least = min(near, key=lambda each: each.expected_error)
    spaces = " or ".join(f'"{COLOR_SPACES[each.name]}"' for each in near if each.name in COLOR_SPACES)
    fit, guess = f"its maker's curve is {least.name}", ""
    if len(near) > 1:
        likely = ", ".join(f"{each.name} ({100 * each.probability:.0f} %)" for each in near)
        fit = f"by its levels the curve may be {likely}"
        guess = f"; if nothing says, {least.name} is safest: its light may be off by {least.expected_error:.1f} stop"
    return Recognition(
        kind=Kind.LOG_FOOTAGE,
        reason=f"log footage: black lies at code {255 * levels.black:.0f} of 255; {fit}",
        advice="give it the colour space of the log curve that the camera was set to, which its menu or the clip's"
        " metadata say" + (f", in ACES configs {spaces}" if spaces else "") + guess,
        curves=tuple(each.name for each in near),
        probabilities=tuple(each.probability for each in near),
        errors=tuple(each.expected_error for each in near),
        color_space=COLOR_SPACES.get(least.name, ""),
    )


_LIMITED_RANGE = Recognition(
    kind=Kind.LIMITED_RANGE,
    reason="limited range stored as full: the codes end at 16 and 235 of 255, which are black and white of video",
    advice="expand the range first, when frames are extracted with ffmpeg -i MOVIE -vf"
    " scale=in_range=limited:out_range=full FRAME.%04d.png",
)
