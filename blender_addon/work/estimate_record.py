# SPDX-License-Identifier: GPL-3.0-or-later
"""An estimate as the entries that a .blend file keeps, and back.

A custom property holds texts, numbers and flat lists of numbers; several texts are joined by line breaks, and nested
values are JSON. A change of the entries needs a new `scene.stored_estimate.LAYOUT`.
"""

import dataclasses
import json
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from crfnet_core import ResponseCurve, ResponseEstimate
from crfnet_core.errors import Notice
from crfnet_core.estimate.result import CameraAnswer, WindowEstimate
from crfnet_core.photograph.metadata import FileOrigin
from crfnet_core.photograph.recognition import Recognition
from crfnet_core.posterior import Family, Verdict
from crfnet_core.statistics.windows import Window
from crfnet_core.types import typed_value


def entries_of(estimate: ResponseEstimate) -> dict[str, Any]:
    """Return the entries of an estimate, from which `estimate_of` makes its equal."""
    windows = estimate.windows
    return {
        "model": estimate.model,
        "photos": "\n".join(estimate.photos),
        "verdict": estimate.verdict.value,
        "uncertainty": estimate.uncertainty,
        "shape_uncertainty": estimate.shape_uncertainty,
        "families": json.dumps(dict(estimate.families)),
        "prior": estimate.prior,
        "metadata": json.dumps([dataclasses.asdict(origin) for origin in estimate.origins], ensure_ascii=False),
        "recognition": json.dumps(estimate.recognition and dataclasses.asdict(estimate.recognition)),
        "camera": json.dumps(estimate.camera and dataclasses.asdict(estimate.camera), ensure_ascii=False),
        "notices": json.dumps([[notice.code, dict(notice.facts)] for notice in estimate.warnings], ensure_ascii=False),
        "weights": estimate.weights.tolist(),
        "brightness": estimate.curve.brightness.tolist(),
        "lower": estimate.band[0].tolist(),
        "upper": estimate.band[1].tolist(),
        "window_photos": [w.photo for w in windows],
        "window_places": [n for w in windows for n in (w.window.x, w.window.y, w.window.step, w.window.filled)],
        "window_weights": [weight for w in windows for weight in w.weights.tolist()],
        "window_errors": [w.expected_error for w in windows],
        "window_kept": [int(w.kept) for w in windows],
    }


def loaded_estimate(curve: ResponseCurve, model: str) -> ResponseEstimate:
    """Return a response from a LUT file in the place of an estimate; `model` names the file.

    Its errors are NaN, and its band has no width. Its verdict, which is not shown, lets it be applied.
    """
    return ResponseEstimate(
        curve=curve,
        weights=curve.brightness[:0],
        windows=(),
        uncertainty=math.nan,
        shape_uncertainty=math.nan,
        band=np.array([curve.brightness, curve.brightness]),
        families={},
        verdict=Verdict.USABLE,
        prior="",
        origins=(),
        warnings=(),
        model=model,
        photos=(),
    )


def estimate_of(entries: Mapping[str, Any]) -> ResponseEstimate:
    """Return the estimate that `entries_of` made these entries from; raise CurveError if their curve was damaged."""
    return ResponseEstimate(
        curve=ResponseCurve(np.array(entries["brightness"])),
        weights=np.array(entries["weights"]),
        windows=tuple(_windows(entries)),
        uncertainty=entries["uncertainty"],
        shape_uncertainty=entries["shape_uncertainty"],
        band=np.array([entries["lower"], entries["upper"]]),
        families={Family(name): share for name, share in json.loads(entries["families"]).items()},
        verdict=Verdict(entries["verdict"]),
        prior=entries["prior"],
        origins=typed_value(json.loads(entries["metadata"]), tuple[FileOrigin, ...]),
        warnings=tuple(Notice(code, facts) for code, facts in json.loads(entries["notices"])),
        model=entries["model"],
        photos=tuple(entries["photos"].splitlines()),
        recognition=typed_value(json.loads(entries["recognition"]), Recognition | None),
        camera=typed_value(json.loads(entries["camera"]), CameraAnswer | None),
    )


def _windows(entries: Mapping[str, Any]) -> Iterator[WindowEstimate]:
    """Yield the estimate of each window."""
    count = len(entries["window_photos"])
    if not count:
        return
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
