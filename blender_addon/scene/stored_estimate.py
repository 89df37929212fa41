# SPDX-License-Identifier: GPL-3.0-or-later
"""An estimate as a custom property of its image or clip, complete: it survives in the .blend file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .. import lazy_import

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate

    from .plates import Datablock

#: The custom property.
KEY = "camera_response"

#: In it: the colour space for which a plate waits until Blender is started again.
PENDING = "pending_color_space"

#: Version of its layout.
LAYOUT = 1


def store(datablock: Datablock, estimate: ResponseEstimate, lines: list[str]) -> None:
    """Keep an estimate, and what is to be said of it, on a datablock.

    Parameters
    ----------
    datablock : Image or MovieClip
        Gets the custom property `KEY`.
    estimate : ResponseEstimate
        Kept whole, in double precision: `restored` returns its equal.
    lines : list of str
        For the panel, which must not load the estimator to draw.
    """
    windows = [w.window for w in estimate.windows]
    datablock[KEY] = {
        "layout": LAYOUT,
        "model": estimate.model,
        "photos": "\n".join(estimate.photos),
        "verdict": estimate.verdict,
        "uncertainty": estimate.uncertainty,
        "spread": estimate.spread,
        "warnings": "\n".join(estimate.warnings),
        "lines": "\n".join(lines),
        "weights": estimate.weights.tolist(),
        "brightness": estimate.curve.brightness.tolist(),
        "lower": estimate.band[0].tolist(),
        "upper": estimate.band[1].tolist(),
        "window_photos": [w.photo for w in estimate.windows],
        "window_places": [n for w in windows for n in (w.x, w.y, w.step, w.filled)],
        "window_weights": np.concatenate([w.weights for w in estimate.windows]).tolist(),
        "window_errors": [w.expected_error for w in estimate.windows],
        "window_kept": [int(w.kept) for w in estimate.windows],
    }


def is_stored(datablock: Datablock | None) -> bool:
    """Return whether a datablock has an estimate of this layout."""
    entries = datablock.get(KEY) if datablock is not None else None
    return hasattr(entries, "get") and entries.get("layout") == LAYOUT


def lines(datablock: Datablock) -> list[str]:
    """Return what is to be said of a stored estimate."""
    return datablock[KEY]["lines"].split("\n")


def curve_and_band(datablock: Datablock) -> np.ndarray:
    """Return a stored response and the ends of its band, shape (3, 1024)."""
    entries = datablock[KEY]
    return np.array([entries[name].to_list() for name in ("brightness", "lower", "upper")])


def restored(datablock: Datablock) -> ResponseEstimate:
    """Return the stored estimate.

    Raises
    ------
    CurveError
        If the stored curve was tampered with.
    """
    return lazy_import.load(".work.estimate_record").estimate_of(datablock[KEY].to_dict())


def remember(datablock: Datablock, name: str, value: Any) -> None:
    """Keep one more fact beside an estimate."""
    datablock[KEY][name] = value


def recall(datablock: Datablock, name: str) -> Any:
    """Return such a fact, or None."""
    return datablock[KEY].get(name)


def forget(datablock: Datablock, name: str) -> None:
    """Drop such a fact, if it is there."""
    datablock[KEY].pop(name, None)


def fingerprint(datablock: Datablock) -> str:
    """Return a key that differs between estimates."""
    entries = datablock[KEY]
    return f"{entries['model']} {entries['uncertainty']!r} {entries['weights'].to_list()!r}"
