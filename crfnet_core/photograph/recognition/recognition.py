"""Detect inputs that are not camera photographs, and advise what to use instead; refuse published curves by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from crfnet_core.errors import Notice, PhotoError
from crfnet_core.photograph.metadata import Device, FileOrigin
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.metadata.editors import is_merger
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition.levels import Levels, has_few_levels, is_limited_range, is_mostly_ends
from crfnet_core.photograph.recognition.log_footage import nearest_curves
from crfnet_core.response.log_curves import COLOR_SPACES

RECOGNIZED = 0.5  # probability of log footage above which it counts as recognized

#: Range of luma below which a picture is flat, whatever else it is: 16 codes of 255, as black frames and gray cards
#: without noise; and below which too little of the response shows: files of 16 bits with white at 16384 or 32768 have
#: at most half. The least of 151 real photographs and crops is 0.83.
FLAT_RANGE, NARROW_RANGE = 16.5 / 255, 0.51

#: Encoding by the name that tags give it -> color space of OpenColorIO's ACES studio config.
TAGGED_SPACES = COLOR_SPACES | {"HLG": "Rec.2100-HLG - Display", "PQ": "Rec.2100-PQ - Display"}


class Kind(StrEnum):
    """A kind of input that is not a camera photograph."""

    LOG_FOOTAGE = "log footage"
    LIMITED_RANGE = "limited range"
    RENDERING = "rendering"
    THERMAL = "thermal picture"
    MERGED = "merged exposures"
    SENT_COPY = "sent copy"
    FLAT = "flat frame"
    FEW_LEVELS = "few levels"


@dataclass(frozen=True)
class Recognition:
    """An input that is not a camera photograph, by its pixels or its metadata."""

    kind: Kind
    reason: str  # the measurement, in words
    advice: str  # a better input, in words
    curves: tuple[str, ...] = ()  # of log footage, up to four whose levels fit, the likeliest first
    probabilities: tuple[float, ...] = ()  # of each curve, by the levels alone
    errors: tuple[float, ...] = ()  # expected, of the light of each, in stops
    color_space: str = ""  # in ACES configs, of the curve with the least expected error; empty if it has none


def recognize(
    levels: Levels,
    *,
    log_probability: float,
    is_noise: bool = False,
    makes: tuple[str, ...] = (),
    origins: Sequence[FileOrigin] = (),
) -> Recognition | None:
    """Return the recognition of all pictures of an estimate, or None for ordinary camera photographs.

    `log_probability` counts the levels by `log_factor`; `is_noise`: whether none shows a scene; `makes`: in the files.
    """
    low, high = levels.luma_ends
    flat = _recognized(Kind.FLAT, "flat_frame", "flat_frame_advice", low=round(255 * low), high=round(255 * high))
    if high - low < FLAT_RANGE:
        return flat
    if is_noise:
        return _recognized(Kind.FLAT, "noise_frame", "noise_frame_advice")
    if is_limited_range(levels):
        return _recognized(Kind.LIMITED_RANGE, "limited_range", "limited_range_advice")
    if has_few_levels(levels):
        return _recognized(Kind.FEW_LEVELS, "few_levels", "few_levels_advice")
    if is_mostly_ends(levels) and not any(origin.names_device for origin in origins):
        return _recognized(Kind.FEW_LEVELS, "mostly_ends", "few_levels_advice")
    if log_probability > RECOGNIZED:
        return _log_footage(levels, makes)
    for origin in origins:
        if origin.renderer:
            return _recognized(Kind.RENDERING, "rendering", "rendering_advice", renderer=origin.renderer)
        if origin.device is Device.THERMAL:
            return _recognized(Kind.THERMAL, "thermal", "thermal_advice", camera=origin.camera)
        if is_merger(origin.editor):
            return _recognized(Kind.MERGED, "merged", "merged_advice", editor=origin.editor)
        if origin.is_sent_copy:
            return _recognized(Kind.SENT_COPY, "sent_copy", "sent_copy_advice", quality=origin.jpeg_quality)
    return flat if high - low < NARROW_RANGE else None


def refuse_tagged(photo: Photo) -> None:
    """Raise PhotoError if the metadata name an encoding with a published curve, with the color space to choose."""
    color = photo.metadata.color if photo.metadata else ColorTags()
    refuse_linear(color, photo.path)
    if color.transfer:
        space = TAGGED_SPACES.get(color.transfer, "")
        code = "tagged_color_space" if space else "tagged_encoding"
        raise PhotoError(code, path=photo.path, transfer=color.transfer, source=color.transfer_source, space=space)


def refuse_linear(color: ColorTags, path: Path) -> None:
    """Raise PhotoError if the tags of a file say that it is linear."""
    if color.transfer == "linear":
        raise PhotoError("tagged_linear", path=path, source=color.transfer_source)


def _recognized(kind: Kind, reason: str, advice: str, **facts: object) -> Recognition:
    """Return the recognition of a kind, in the sentences of the codes of a reason, with its facts, and an advice."""
    return Recognition(kind, str(Notice(reason, facts)), str(Notice(advice)))


def _log_footage(levels: Levels, makes: tuple[str, ...]) -> Recognition:
    """Return the recognition of log footage, with the curves that fit; the safest has the least expected error."""
    near = nearest_curves(levels, makes)
    safest = min(near, key=lambda curve: curve.expected_error)
    spaces = " or ".join(f'"{COLOR_SPACES[curve.name]}"' for curve in near if curve.name in COLOR_SPACES)
    advice = [Notice("log_footage_spaces", {"spaces": spaces}) if spaces else Notice("log_footage_advice")]
    code = round(255 * levels.black)
    if len(near) == 1:
        reason = Notice("log_footage_of_maker", {"code": code, "curve": safest.name})
    else:
        likely = ", ".join(f"{curve.name} ({100 * curve.probability:.0f} %)" for curve in near)
        reason = Notice("log_footage", {"code": code, "curves": likely})
        advice.append(Notice("log_footage_safest", {"curve": safest.name, "stops": f"{safest.expected_error:.1f}"}))
    return Recognition(
        kind=Kind.LOG_FOOTAGE,
        reason=str(reason),
        advice="; ".join(map(str, advice)),
        curves=tuple(curve.name for curve in near),
        probabilities=tuple(curve.probability for curve in near),
        errors=tuple(curve.expected_error for curve in near),
        color_space=COLOR_SPACES.get(safest.name, ""),
    )
