"""The measured responses of camera bodies: facts that a prior may be made from, out of fold wherever it is measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.response.curve import ResponseCurve
from training.data.real.photographs import RealPhotograph, real_photographs


@dataclass(frozen=True)
class Body:
    """A camera body, of a kind as in `RealPhotograph`, and a response of each exposure stack."""

    key: str
    kind: str
    responses: tuple[ResponseCurve, ...]


def measured_bodies(data: Path, *, without: RealPhotograph | None = None) -> list[Body]:
    """Return the bodies of DATA/real and DATA/real_bodies whose photographs are the cameras' own renderings.

    The fold of the photograph `without` is left out, and every body of the models in this fold, in both folders.
    """
    photographs = [photograph for folder in real_photographs(data).values() for photograph in folder]
    left_out = {model_key(other) for other in photographs if without is not None and _shares_fold(other, without)}
    kept = [
        photograph
        for photograph in photographs
        if model_key(photograph) not in left_out and not photograph.is_developed
    ]
    return [_body(key, kept) for key in sorted({photograph.body_key for photograph in kept})]


def model_key(photograph: RealPhotograph) -> str:
    """Return the camera model without what DATA/real says in brackets: two bodies of one model share it."""
    return photograph.body_key.partition(" (")[0]


def _shares_fold(photograph: RealPhotograph, other: RealPhotograph) -> bool:
    """Return whether two photographs are of one folder and one fold."""
    return photograph.photograph.parents[1] == other.photograph.parents[1] and photograph.fold == other.fold


def _body(key: str, photographs: Sequence[RealPhotograph]) -> Body:
    """Return the body of this key."""
    of_body = [photograph for photograph in photographs if photograph.body_key == key]
    measured = {photograph.measured: photograph for photograph in of_body}
    return Body(key, of_body[0].kind, tuple(photograph.truth() for photograph in measured.values()))
