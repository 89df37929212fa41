# SPDX-License-Identifier: GPL-3.0-or-later
"""An estimate as the entries that a .blend file keeps, and back.

The entries are texts, numbers and flat lists of numbers in double precision, because a custom property holds nothing
else; several texts are one, with a line each. Files saved with these names must stay readable: a change of them needs
a new `scene.stored_estimate.LAYOUT`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from crfnet_core import ResponseCurve, ResponseEstimate, Window, WindowEstimate


def entries_of(estimate: ResponseEstimate) -> dict[str, Any]:
    """Return the entries of an estimate, from which `estimate_of` makes its equal."""
    windows = estimate.windows
    return {
        "model": estimate.model,
        "photos": "\n".join(estimate.photos),
        "verdict": estimate.verdict.value,
        "uncertainty": estimate.uncertainty,
        "spread": estimate.spread,
        "warnings": "\n".join(estimate.warnings),
        "weights": estimate.weights.tolist(),
        "brightness": estimate.curve.brightness.tolist(),
        "lower": estimate.band[0].tolist(),
        "upper": estimate.band[1].tolist(),
        "window_photos": [w.photo for w in windows],
        "window_places": [n for w in windows for n in (w.window.x, w.window.y, w.window.step, w.window.filled)],
        "window_weights": np.concatenate([w.weights for w in windows]).tolist(),
        "window_errors": [w.expected_error for w in windows],
        "window_kept": [int(w.kept) for w in windows],
    }


def estimate_of(entries: Mapping[str, Any]) -> ResponseEstimate:
    """Return the estimate of which `entries_of` made these entries.

    Raises
    ------
    CurveError
        If the curve is no longer that of a response, because another program changed it.
    """
    return ResponseEstimate(
        curve=ResponseCurve(np.array(entries["brightness"])),
        weights=np.array(entries["weights"]),
        windows=tuple(_windows(entries)),
        spread=entries["spread"],
        uncertainty=entries["uncertainty"],
        band=np.array([entries["lower"], entries["upper"]]),
        warnings=_lines(entries["warnings"]),
        model=entries["model"],
        photos=_lines(entries["photos"]),
    )


def _windows(entries: Mapping[str, Any]) -> Iterator[WindowEstimate]:
    """Yield the estimate of each window."""
    count = len(entries["window_photos"])
    positions = np.reshape(entries["window_places"], (count, -1)).tolist()
    weights = np.reshape(np.array(entries["window_weights"]), (count, -1))
    for n in range(count):
        yield WindowEstimate(
            photo=entries["window_photos"][n],
            window=Window(*positions[n]),
            weights=weights[n],
            expected_error=entries["window_errors"][n],
            kept=bool(entries["window_kept"][n]),
        )


def _lines(text: str) -> tuple[str, ...]:
    """Return the lines of a text; none of an empty one."""
    return tuple(text.split("\n")) if text else ()
