# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole estimate as a custom property of its image or clip, so that it is saved in the .blend file.

What the panel draws is read here without importing the estimator.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import lazy_import
from ..work.wording import LOADED

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate
    from crfnet_core.colorimetry import Primaries
    from crfnet_core.types import BoolArray, Float64Array, IndexArray

    from .plates import Datablock

#: The name of the custom property.
KEY = "camera_response"

#: The version of its entries, and those that are read.
LAYOUT, READABLE_LAYOUTS = 2, (1, 2)

#: The entry with the exposure that was applied, in stops; it is set later.
EXPOSURE = "exposure"

#: The entry that says where a response comes from, in words, if it was not estimated from its plate.
ORIGIN = "origin"

#: The entry with the state of the plate's file that was analysed, see `plates.file_state`; and how far the times of a
#: file and its copy may differ, in seconds, because archives and some file systems round them.
FILE_STATE, _SAME_TIME = "file_state", 2

#: The entry with the stored cameras of the plate's make and model, in JSON: name and words of each.
OFFERS = "offers"

#: The primaries of the plate, in JSON: the fields of `crfnet_core.colorimetry.Primaries`.
PRIMARIES = "primaries"

#: The verdict of an estimate that is not to be trusted: `crfnet_core.posterior.Verdict`, repeated because the panel is
#: drawn without the estimator.
DO_NOT_TRUST = "do not trust"


def store(datablock: Datablock, estimate: ResponseEstimate, *, lines: Iterable[str]) -> None:
    """Store an estimate on its image or clip.

    What is known of the file that was analysed stays, and of its camera: the estimate may be the stored one again.

    Parameters
    ----------
    datablock : Image or MovieClip
        Gets the custom property `KEY`.
    estimate : ResponseEstimate
        Stored whole and in double precision: `restored` returns its equal.
    lines : iterable of str
        What the panel says of the estimate.
    """
    entries = lazy_import.load(".work.estimate_record").entries_of(estimate)
    names = (FILE_STATE, OFFERS)
    kept = {name: datablock[KEY].get(name) for name in names if is_stored(datablock)}
    datablock[KEY] = {"layout": LAYOUT, "lines": "\n".join(lines), **entries}
    for name, value in kept.items():
        if value:
            set_entry(datablock, name, value)


def remove(datablock: Datablock) -> None:
    """Remove the estimate and the settings from a copy of a plate, which is no plate itself."""
    datablock.pop(KEY, None)
    datablock.property_unset("camera_response_settings")


def is_stored(datablock: Datablock | None) -> bool:
    """Return whether an image or clip has a stored estimate of a layout that is read."""
    entries: Any = datablock.get(KEY) if datablock is not None else None
    return hasattr(entries, "get") and entries.get("layout") in READABLE_LAYOUTS


def verdict(datablock: Datablock) -> str:
    """Return the verdict of the stored estimate: "good", "usable" or `DO_NOT_TRUST`."""
    return datablock[KEY]["verdict"]


def expected_stops(datablock: Datablock) -> float:
    """Return by how many stops the linear light is expected to be off; NaN in layout 1, which did not know it."""
    return datablock[KEY].get("shape_uncertainty", math.nan)


def lines(datablock: Datablock) -> list[str]:
    """Return what the panel says of the stored estimate."""
    return datablock[KEY]["lines"].split("\n")


def recognized_as(datablock: Datablock) -> str:
    """Return what the photographs are, if they are "log footage" or "limited range"; else an empty text."""
    found = json.loads(datablock[KEY].get("recognition", "null"))
    return found["kind"] if found else ""


def warning_codes(datablock: Datablock) -> list[str]:
    """Return the codes of the warnings of the stored estimate; files of earlier versions have none."""
    return [code for code, _ in json.loads(datablock[KEY].get("notices", "[]"))]


def camera_models(datablock: Datablock) -> list[str]:
    """Return make and model of the cameras that a plate's photographs name."""
    origins = json.loads(datablock[KEY].get("metadata", "[]"))
    return [origin["camera"] for origin in origins if origin["camera"]]


def camera(datablock: Datablock) -> str:
    """Return the name of the stored camera whose response it is; empty if it was estimated."""
    found = json.loads(datablock[KEY].get("camera", "null"))
    return found["name"] if found else ""


def offers(datablock: Datablock) -> list[tuple[str, str]]:
    """Return the stored cameras of the plate's make and model: their names, and what each is, in words."""
    return [(name, words) for name, words in json.loads(datablock[KEY].get(OFFERS, "[]"))]


def set_offers(datablock: Datablock, cameras: Iterable[tuple[str, str]]) -> None:
    """Keep the stored cameras of the plate's make and model with an estimate."""
    set_entry(datablock, OFFERS, json.dumps(list(cameras), ensure_ascii=False))


def curve_and_band(datablock: Datablock) -> Float64Array:
    """Return the stored response and the lower and upper end of its band, shape (3, 1024)."""
    entries = datablock[KEY]
    return np.array([entries[name].to_list() for name in ("brightness", "lower", "upper")])


def photos(datablock: Datablock) -> list[str]:
    """Return the names of the photographs or frames that were analysed, those of the plate first."""
    return datablock[KEY]["photos"].splitlines()


def windows(datablock: Datablock) -> tuple[IndexArray, IndexArray, BoolArray]:
    """Return the windows that were analysed.

    Returns
    -------
    places : ndarray, intp, shape (N, 4)
        The fields of `crfnet_core.statistics.windows.Window`: x, y, step, filled.
    photos : ndarray, intp, shape (N,)
        Which of the photographs each window lies in.
    agrees : ndarray, bool, shape (N,)
        Whether the window agrees with the others.
    """
    entries = datablock[KEY]
    places, in_photos, kept = (list(entries[f"window_{name}"]) for name in ("places", "photos", "kept"))
    return np.array(places, np.intp).reshape(-1, 4), np.array(in_photos, np.intp), np.array(kept, bool)


def restored(datablock: Datablock) -> ResponseEstimate:
    """Return the stored estimate.

    Raises
    ------
    CurveError
        If the stored curve is no longer that of a response, because another program changed it.
    """
    return lazy_import.load(".work.estimate_record").estimate_of(datablock[KEY].to_dict())


def set_entry(datablock: Datablock, name: str, value: Any) -> None:
    """Set one more entry of the stored estimate."""
    datablock[KEY][name] = value


def is_loaded(datablock: Datablock) -> bool:
    """Return whether the response was loaded from a LUT file, so that it has no verdict."""
    return datablock[KEY]["model"].startswith(LOADED)


def origin(datablock: Datablock) -> str:
    """Return where the response comes from, in words; empty if it was estimated from the plate."""
    return datablock[KEY].get(ORIGIN, "")


def exposure(datablock: Datablock) -> float:
    """Return the stops that the linear plate was given; 0 if that was not stored."""
    return datablock[KEY].get(EXPOSURE, 0.0)


def is_file_changed(datablock: Datablock, state: str) -> bool:
    """Return whether the file that was analysed was another one than that of a state, or has been changed since.

    It is False if that is unknown, as of estimates of earlier versions, or the response comes from elsewhere.
    """
    earlier = datablock[KEY].get(FILE_STATE, "")
    if not earlier or not state or origin(datablock):
        return False
    *file, time = earlier.split("\n")
    *present_file, present_time = state.split("\n")
    return file != present_file or abs(int(time) - int(present_time)) > _SAME_TIME


def matrix(datablock: Datablock) -> Float64Array | None:
    """Return the matrix from a plate's linear RGB to linear Rec.709, shape (3, 3); None if they are the same."""
    tags, found = lazy_import.load("crfnet_core.colorimetry"), primaries(datablock)
    return None if found in (None, tags.REC709) else tags.conversion_matrix(found, tags.REC709)


def primaries(datablock: Datablock) -> Primaries | None:
    """Return the primaries of a plate; None if they are not stored, as with estimates of earlier versions."""
    text = datablock[KEY].get(PRIMARIES) if is_stored(datablock) else None
    if text is None:
        return None
    fields = {name: tuple(value) if isinstance(value, list) else value for name, value in json.loads(text).items()}
    return lazy_import.load("crfnet_core.colorimetry").Primaries(**fields)


def set_primaries(datablock: Datablock, found: Primaries) -> None:
    """Keep the primaries of a plate with an estimate."""
    set_entry(datablock, PRIMARIES, json.dumps(dataclasses.asdict(found)))


def fingerprint(datablock: Datablock) -> str:
    """Return a text that differs between different estimates."""
    entries = datablock[KEY]
    if is_loaded(datablock):
        return f"{entries['model']} {hash(tuple(entries['brightness'].to_list()))}"
    return f"{entries['model']} {entries['uncertainty']!r} {entries['weights'].to_list()!r}"
