# SPDX-License-Identifier: GPL-3.0-or-later
"""Gather the job of a plate from its settings, the preferences and Blender, before another thread takes over."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ocio.options import EstimateOptions

from ..scene import color_management, plates
from ..scene.stored_estimate import restored
from ..work.errors import AddonError
from ..work.job import Anchor, ApplyMode, Estimation, Exposure, Job, Output, Plate, RunningConfig
from .plate_settings import CHOICES
from .preferences import absolute, preferences


def gather_job(datablock: plates.Datablock, *, is_estimated: bool, arguments: Mapping[str, Any]) -> Job:
    """Return the job of a plate.

    Parameters
    ----------
    datablock : Image or MovieClip
        The plate, with its settings.
    is_estimated : bool
        Whether its stored estimate is applied; otherwise its response is estimated anew.
    arguments : mapping
        Settings that were given as arguments of the operator, which take precedence over those of the plate.

    Raises
    ------
    AddonError
        If no response can be estimated from the plate, its file is not found, or no file of the prior is chosen.
    """
    settings, plate = datablock.camera_response_settings, plates.plate_of(datablock)
    chosen = {name: arguments.get(name, getattr(settings, name)) for name in CHOICES}
    return Job(
        plate=plate,
        estimation=Estimation(
            options=EstimateOptions(
                model=absolute(preferences().model),
                threads=preferences().threads,
                prior=_prior(chosen, is_needed=not is_estimated),
                use_metadata=not chosen["ignore_metadata"],
            ),
            is_forced=chosen["force"],
            stored=restored(datablock) if is_estimated else None,
        ),
        exposure=Exposure(anchor=Anchor(chosen["anchor"]), gray=chosen["gray"], stops=chosen["exposure"]),
        output=_output(plate, chosen),
        config=RunningConfig(
            path=color_management.running_config(), is_demanded=bool(color_management.environment_config())
        ),
    )


def _prior(chosen: Mapping[str, Any], *, is_needed: bool) -> str | Path:
    """Return the name or the file of the prior; a stored estimate needs no file."""
    if chosen["prior"] != "file":
        return str(chosen["prior"])
    if is_needed and not chosen["prior_file"]:
        raise AddonError("Expect is set to File: choose a Prior File, or expect Camera")
    return absolute(chosen["prior_file"]) or "file"


def _output(plate: Plate, chosen: Mapping[str, Any]) -> Output:
    """Return what becomes of the response."""
    mode = ApplyMode(chosen["apply"])
    return Output(
        mode=mode,
        folder=absolute(chosen["folder"]) or _usual_folder(mode, plate),
        depth=chosen["depth"],
        lut_length=preferences().lut_length,
        overwrite=chosen["overwrite"],
    )


def _usual_folder(mode: ApplyMode, plate: Plate) -> Path | None:
    """Return the folder for files if none was chosen for the plate: Blender's, the preferences' or the plate's own."""
    if mode is ApplyMode.NODES:
        return None
    if mode is ApplyMode.COLORSPACE:
        return color_management.user_folder()
    return absolute(preferences().folder) or plate.folder
