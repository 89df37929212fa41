# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that a run has to know, gathered from Blender before another thread takes over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..scene import color_management
from ..scene.plates import Datablock, Plate, plate_of
from ..scene.stored_estimate import restored
from .plate_settings import CHOICES
from .preferences import absolute, preferences

if TYPE_CHECKING:
    from crfnet_core import ResponseEstimate


@dataclass(frozen=True)
class Request:
    """What to estimate and what to make of it; see `PlateChoices` and `CRF_AddonPreferences`.

    Parameters
    ----------
    plate : Plate
        The plate.
    estimate : ResponseEstimate or None
        Its response, if it is known already.
    apply, anchor, gray, exposure, depth, overwrite, force
        The choices of `PlateChoices`.
    folder : Path or None
        Where files go.
    model : Path or None
        The model's folder; None for the packaged one.
    threads, lut_length : int
        The preferences.
    base_config : str
        The config that this Blender runs on.
    is_config_demanded : bool
        Whether the environment names the config, so that Blender looks for it nowhere else.
    """

    plate: Plate
    estimate: ResponseEstimate | None
    apply: str
    anchor: str
    gray: float
    exposure: float
    depth: str
    overwrite: bool
    force: bool
    folder: Path | None
    model: Path | None
    threads: int
    lut_length: int
    base_config: str
    is_config_demanded: bool


def request_for(datablock: Datablock, *, is_estimated: bool, choices: Mapping[str, Any]) -> Request:
    """Return the request for a plate.

    Parameters
    ----------
    datablock : Image or MovieClip
        The plate, with its settings.
    is_estimated : bool
        Whether to take the stored estimate.
    choices : mapping
        Settings that come before the plate's own.

    Raises
    ------
    AddonError
        If the plate cannot be used.
    """
    settings, general = datablock.camera_response_settings, preferences()
    chosen = {name: choices.get(name, getattr(settings, name)) for name in CHOICES}
    plate = plate_of(datablock)
    return Request(
        plate=plate,
        estimate=restored(datablock) if is_estimated else None,
        folder=_folder(chosen["apply"], absolute(chosen.pop("folder")), plate),
        model=absolute(general.model),
        threads=general.threads,
        lut_length=general.lut_length,
        base_config=color_management.running_config(),
        is_config_demanded=bool(color_management.environment_config()),
        **chosen,
    )


def _folder(mode: str, chosen: Path | None, plate: Plate) -> Path | None:
    """Return where files go: the folder chosen for the plate, else Blender's, the preferences' or the plate's own."""
    if chosen or mode == "NODES":
        return chosen
    return color_management.user_folder() if mode == "COLORSPACE" else absolute(preferences().folder) or plate.folder
