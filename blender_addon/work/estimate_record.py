# SPDX-License-Identifier: GPL-3.0-or-later
"""An estimate as the entries that a .blend file keeps, and back.

The entries are texts, numbers and flat lists of numbers in double precision, because a custom property holds nothing
else; several texts are one, with a line each; families, what the metadata says, what the photographs are recognized as
and the stored camera are texts in JSON. Files saved with these names must stay readable: a change of them needs a new
`scene.stored_estimate.LAYOUT`. Layout 1 knew neither the expected shape error nor families, prior and metadata; the
first files of layout 2 have neither recognition nor a stored camera.
"""

from __future__ import annotations

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
        "warnings": "\n".join(map(str, estimate.warnings)),
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
    """Return a response that was not estimated, in the place of an estimate.

    Its errors are NaN, its band has no width, and it has no windows and no families. Its verdict, which is not shown,
    lets it be applied.

    Parameters
    ----------
    curve : ResponseCurve
        The response.
    model : str
        Where it comes from, beginning with `wording.LOADED`.
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
    """Return the estimate of which `entries_of` made these entries.

    Of an estimate of layout 1, the expected shape error is NaN, and there are no families, no prior and no metadata.

    Raises
    ------
    CurveError
        If the curve is no longer that of a response, because another program changed it.
    """
    return ResponseEstimate(
        curve=ResponseCurve(np.array(entries["brightness"])),
        weights=np.array(entries["weights"]),
        windows=tuple(_windows(entries)),
        uncertainty=entries["uncertainty"],
        shape_uncertainty=entries.get("shape_uncertainty", math.nan),
        band=np.array([entries["lower"], entries["upper"]]),
        families={Family(name): share for name, share in json.loads(entries.get("families", "{}")).items()},
        verdict=Verdict(entries["verdict"]),
        prior=entries.get("prior", ""),
        origins=tuple(map(FileOrigin.from_dict, json.loads(entries.get("metadata", "[]")))),
        warnings=tuple(_warnings(entries)),
        model=entries["model"],
        photos=_lines(entries["photos"]),
        recognition=Recognition.from_dict(json.loads(entries.get("recognition", "null"))),
        camera=CameraAnswer.from_dict(json.loads(entries.get("camera", "null"))),
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


def _warnings(entries: Mapping[str, Any]) -> Iterator[Notice]:
    """Yield the warnings; files of earlier versions have their sentences alone."""
    if "notices" in entries:
        yield from (Notice(code, facts) for code, facts in json.loads(entries["notices"]))
    else:
        yield from map(Notice.from_text, _lines(entries["warnings"]))


def _lines(text: str) -> tuple[str, ...]:
    """Return the lines of a text; none of an empty one."""
    return tuple(text.split("\n")) if text else ()
