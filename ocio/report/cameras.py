"""Stored cameras in words and as JSON."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from crfnet_core.estimate.result import CameraAnswer
from crfnet_core.library import Camera


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


def camera_summary(camera: Camera) -> dict[str, Any]:
    """Return a camera in short, ready for JSON."""
    settings = asdict(camera.settings) | {"iso": list(camera.settings.iso)}
    return {"name": camera.name, **settings, "basis": camera.basis}
