"""Stored cameras in words and as JSON."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from crfnet_core.estimate.result import CameraAnswer
from crfnet_core.library import Camera, KeptPhotograph

from .facts import COMMAND, Phrases, agreement


def offer_lines(offers: Sequence[CameraAnswer]) -> list[str]:
    """Return one line that offers stored cameras of a photograph's make and model; nothing without any."""
    if not offers:
        return []
    named = " or ".join(f"--camera {shlex.quote(offer.name)} ({offer_words(offer)})" for offer in offers)
    return [f"A response of this camera is known; to use it, add {named}."]


def offer_words(offer: CameraAnswer, phrases: Phrases = COMMAND) -> str:
    """Return what a stored camera's response rests on, and how far the photograph's own estimate is from it."""
    return f"{offer.basis}; this estimate is {agreement(offer, phrases)}"


def camera_line(camera: Camera) -> str:
    """Return a camera in one line, for lists; its make and model where its name does not begin with them."""
    model = camera.settings.camera
    is_named = camera.name.casefold().startswith(model.casefold())
    return f"{camera.name}: {camera.basis if is_named else f'{model}; {camera.basis}'}"


def camera_summary(camera: Camera) -> dict[str, Any]:
    """Return a camera in short, ready for JSON."""
    settings = asdict(camera.settings) | {"iso": list(camera.settings.iso)}
    return {
        "name": camera.name,
        **settings,
        "is_measured": camera.measured is not None,
        "photographs": len(camera.photographs),
        "basis": camera.basis,
    }


def photograph_documents(camera: Camera, found: Mapping[str, CameraAnswer]) -> list[dict[str, Any]]:
    """Return a camera's photographs, with how far each is from the others, ready for JSON.

    Parameters
    ----------
    camera : Camera
        The camera.
    found : mapping of str to CameraAnswer
        As `crfnet_core.library.differences` returns it.
    """
    return [_photograph_document(each, found.get(each.sha256)) for each in camera.photographs]


def _photograph_document(photograph: KeptPhotograph, answer: CameraAnswer | None) -> dict[str, Any]:
    """Return a photograph, with how far it is from the others; null where that is not known."""
    return {
        "name": photograph.name,
        "sha256": photograph.sha256,
        "network": photograph.model,
        "iso": next(iter(photograph.settings.iso), None),
        "difference_stops": answer and answer.difference_stops,
        "difference": answer and answer.difference,
        "agrees": answer and answer.agrees,
    }


def photograph_lines(camera: Camera, found: Mapping[str, CameraAnswer], *, model: str) -> list[str]:
    """Return a camera's photographs, one line each, with how far each is from the others or from the measurement."""
    lines = []
    for photograph in camera.photographs:
        answer = found.get(photograph.sha256)
        words = f"its own estimate is {agreement(answer)}" if answer else "the only one"
        if photograph.model != model:
            words = f"read by {photograph.model}, so it does not count; add it again"
        iso = f", ISO {photograph.settings.iso[0]}" if photograph.settings.iso else ""
        lines.append(f"  {_label(camera, photograph)}{iso}: {words}")
    return lines


def disagreement_lines(camera: Camera, found: Mapping[str, CameraAnswer]) -> list[str]:
    """Return a warning for each photograph that disagrees with the others or with the measurement."""
    return [
        f"Warning: {_label(camera, photograph)} disagrees; was its picture mode another one? To take it out:"
        f" crfnet camera remove {shlex.quote(camera.name)} {shlex.quote(camera.key_of(photograph))}"
        for photograph in camera.photographs
        if (answer := found.get(photograph.sha256)) and not answer.agrees
    ]


def _label(camera: Camera, photograph: KeptPhotograph) -> str:
    """Return a photograph's file name, with the beginning of its SHA-256 where several have that name."""
    key = camera.key_of(photograph)
    return photograph.name if key == photograph.name else f"{photograph.name} (SHA-256 {key})"
