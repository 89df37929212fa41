# SPDX-License-Identifier: GPL-3.0-or-later
"""An estimate from its entries in a .blend file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from crfnet_core import ResponseCurve, ResponseEstimate, Window, WindowEstimate


def estimate_of(entries: Mapping[str, Any]) -> ResponseEstimate:
    """Return the estimate that `storage.store` made these entries of."""
    return ResponseEstimate(
        curve=ResponseCurve(np.array(entries["brightness"])),
        weights=np.array(entries["weights"]),
        windows=tuple(_windows(entries)),
        spread=entries["spread"],
        uncertainty=entries["uncertainty"],
        band=np.array([entries["lower"], entries["upper"]]),
        warnings=_texts(entries["warnings"]),
        model=entries["model"],
        photos=_texts(entries["photos"]),
    )


def _windows(entries: Mapping[str, Any]) -> Iterator[WindowEstimate]:
    """Yield what each window said."""
    count = len(entries["window_photos"])
    places = np.reshape(entries["window_places"], (count, -1)).tolist()
    weights = np.reshape(np.array(entries["window_weights"]), (count, -1))
    for n in range(count):
        yield WindowEstimate(
            photo=entries["window_photos"][n],
            window=Window(*places[n]),
            weights=weights[n],
            expected_error=entries["window_errors"][n],
            kept=bool(entries["window_kept"][n]),
        )


def _texts(joined: str) -> tuple[str, ...]:
    """Return texts that were stored as lines."""
    return tuple(joined.split("\n")) if joined else ()
