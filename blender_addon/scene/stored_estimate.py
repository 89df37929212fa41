# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole estimate as a custom property of its image or clip, so that it is saved in the .blend file.

The panel draws these entries without importing the estimator.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import lazy_import
from ..work.job import file_state
from ..work.wording import PanelText, is_loaded, panel_text

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate
    from crfnet_core.colorimetry import Primaries
    from crfnet_core.types import Float64Array

    from .plates import Datablock

#: The name of the custom property, and the version of its entries.
KEY, LAYOUT = "camera_response", 3

# Entries that are set later:
EXPOSURE = "exposure"  # that was applied, in stops
ORIGIN = "origin"  # in words, of a response that was not estimated from its plate
FILE_STATE = "file_state"  # of the analyzed file: `work.job.file_state`
OFFERS = "offers"  # in JSON, the stored cameras of the plate's make and model: name and description of each
OWN_FILES = "own_files"  # in JSON, the files that the plate wrote: `work.job.file_state` of each path
PRIMARIES = "primaries"  # in JSON, of the plate: the fields of `crfnet_core.colorimetry.Primaries`

#: The largest difference, in seconds, between the times of a file and its copy: archives and file systems round them.
_SAME_TIME = 2

#: The verdict of an estimate that is not to be trusted, as in `crfnet_core.posterior.Verdict`, which the panel does
#: not import.
DO_NOT_TRUST = "do not trust"


def store(datablock: Datablock, estimate: ResponseEstimate) -> None:
    """Store an estimate on its image or clip, with the panel's sentences about it; `restored` returns its equal.

    The entries about the analyzed file and its camera stay: the estimate may be the stored one again.
    """
    entries = lazy_import.load(".work.estimate_record").entries_of(estimate)
    earlier = datablock[KEY].to_dict() if is_stored(datablock) else {}
    file_entries = {name: earlier[name] for name in (FILE_STATE, OFFERS, OWN_FILES) if earlier.get(name)}
    datablock.pop(KEY, None)  # Blender 4.5 does not replace one that reading `camera_response` has made
    datablock[KEY] = {"layout": LAYOUT, **panel_text(estimate)._asdict(), **entries, **file_entries}


def remove(datablock: Datablock) -> None:
    """Remove the estimate and the settings from the copy of a plate, which is not a plate itself."""
    datablock.pop(KEY, None)
    datablock.property_unset("camera_response_settings")


def is_stored(datablock: Datablock | None) -> bool:
    """Return whether an image or clip has a stored estimate of the present layout."""
    entries: Any = datablock.get(KEY) if datablock is not None else None
    return hasattr(entries, "get") and entries.get("layout") == LAYOUT


def verdict(datablock: Datablock) -> str:
    """Return the verdict of the stored estimate: "usable" or `DO_NOT_TRUST`."""
    return datablock[KEY]["verdict"]


def expected_stops(datablock: Datablock) -> float:
    """Return the expected error of the linear light in stops; NaN for a response from a LUT file."""
    return datablock[KEY]["shape_uncertainty"]


def panel_paragraphs(datablock: Datablock) -> tuple[list[str], list[str], list[str]]:
    """Return the panel's paragraphs about the stored estimate: advice, details, warnings."""
    advice, details, warnings = (datablock[KEY][name].splitlines() for name in PanelText._fields)
    return advice, details, warnings


def warning_codes(datablock: Datablock) -> list[str]:
    """Return the codes of the warnings of the stored estimate."""
    return [code for code, _ in json.loads(datablock[KEY]["notices"])]


def camera_models(datablock: Datablock) -> list[str]:
    """Return make and model of each camera that the files of the analyzed photographs name."""
    origins = json.loads(datablock[KEY]["metadata"])
    return [origin["camera"] for origin in origins if origin["camera"]]


def camera(datablock: Datablock) -> str:
    """Return the name of the stored camera whose response it is; empty if it was estimated."""
    answer = json.loads(datablock[KEY]["camera"])
    return answer["name"] if answer else ""


def offers(datablock: Datablock) -> list[tuple[str, str]]:
    """Return the stored cameras of the plate's make and model: name and description of each."""
    return [(name, words) for name, words in json.loads(datablock[KEY].get(OFFERS, "[]"))]


def own_files(datablock: Datablock) -> dict[str, str]:
    """Return the files that a plate wrote, as it left them: `file_state` of each path."""
    return json.loads(datablock[KEY].get(OWN_FILES, "{}")) if is_stored(datablock) else {}


def add_own_files(datablock: Datablock, files: Iterable[Path]) -> None:
    """Remember files that a plate with an estimate has just written: it may replace them."""
    states = own_files(datablock) | {str(path): file_state(path) for path in files}
    set_entry(datablock, OWN_FILES, json.dumps(states, ensure_ascii=False))


def curve_and_band(datablock: Datablock) -> Float64Array:
    """Return the stored response and the lower and upper end of its band, shape (3, 1024)."""
    entries = datablock[KEY]
    return np.array([entries[name].to_list() for name in ("brightness", "lower", "upper")])


def restored(datablock: Datablock) -> ResponseEstimate:
    """Return the stored estimate; raise CurveError if another program has damaged its curve."""
    return lazy_import.load(".work.estimate_record").estimate_of(datablock[KEY].to_dict())


def set_entry(datablock: Datablock, name: str, value: Any) -> None:
    """Set one more entry of the stored estimate."""
    datablock[KEY][name] = value


def has_verdict(datablock: Datablock) -> bool:
    """Return whether the response was estimated, not loaded from a LUT file."""
    return not is_loaded(datablock[KEY]["uncertainty"])


def origin(datablock: Datablock) -> str:
    """Return the origin of a response that was not estimated from the plate, in words; else an empty text."""
    return datablock[KEY].get(ORIGIN, "")


def exposure(datablock: Datablock) -> float:
    """Return the exposure of the linear plate in stops; 0 if none was stored."""
    return datablock[KEY].get(EXPOSURE, 0.0)


def is_file_changed(datablock: Datablock, state: str) -> bool:
    """Return whether the analyzed file differs from the file of a state; False if it is unknown.

    It is unknown where the plate has no file of its own, or the response comes from elsewhere.
    """
    earlier = datablock[KEY].get(FILE_STATE, "")
    if not earlier or not state or origin(datablock):
        return False
    *file, time = earlier.split("\n")
    *present_file, present_time = state.split("\n")
    return file != present_file or abs(int(time) - int(present_time)) > _SAME_TIME


def matrix(datablock: Datablock) -> Float64Array | None:
    """Return the matrix from a plate's linear RGB to linear Rec.709, shape (3, 3); None if they are the same."""
    colorimetry, source = lazy_import.load("crfnet_core.colorimetry"), primaries(datablock)
    return None if source in (None, colorimetry.REC709) else colorimetry.conversion_matrix(source, colorimetry.REC709)


def primaries(datablock: Datablock) -> Primaries | None:
    """Return the primaries of a plate; None if it has no estimate."""
    if not is_stored(datablock):
        return None
    return lazy_import.load("crfnet_core.colorimetry").Primaries.from_dict(json.loads(datablock[KEY][PRIMARIES]))


def set_primaries(datablock: Datablock, primaries: Primaries) -> None:
    """Store the primaries of a plate with its estimate."""
    set_entry(datablock, PRIMARIES, json.dumps(dataclasses.asdict(primaries)))


def fingerprint(datablock: Datablock) -> str:
    """Return a text that differs between responses and their bands."""
    return f"{datablock[KEY]['model']} {hash(curve_and_band(datablock).tobytes())}"
