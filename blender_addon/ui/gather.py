# SPDX-License-Identifier: GPL-3.0-or-later
"""Gather the job of a plate from its settings, the preferences and Blender, before another thread takes over."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import bpy

from crfnet.options import EstimateOptions, stated_device
from crfnet_core.colorimetry import Primaries
from crfnet_core.estimate.options import AnalysisOptions

from ..scene import color_management, plates, stored_estimate
from ..scene.nodes import plate_group
from ..work.errors import AddonError
from ..work.job import WITHOUT_FILES, Anchor, ApplyMode, Estimation, Exposure, Job, Output, Plate
from .plate_settings import CHOICES
from .preferences import absolute, preferences


def gather_job(
    datablock: plates.Datablock, arguments: Mapping[str, Any], *, is_estimated: bool, despite_verdict: bool = False
) -> Job:
    """Return the job of a plate: to apply its stored estimate (`is_estimated`), or to estimate its response anew.

    `arguments` of the operator take precedence over the settings of the plate. Raise AddonError or ConfigError if no
    response can be estimated from the plate, its file is not found, or the config lacks a color space for the nodes.
    """
    settings = datablock.camera_response_settings
    chosen = {name: arguments.get(name, getattr(settings, name)) for name in CHOICES}
    plate = plates.plate_of(datablock)
    if chosen["apply"] == ApplyMode.NODES:
        if not plates.is_shown(datablock):
            raise AddonError(
                f"{datablock.name}: Blender cannot show this format; choose Bake, which writes an EXR file, or save the"
                " photograph as JPEG or PNG"
            )
        plate_group.check_config()
    return Job(
        plate=plate,
        estimation=Estimation(
            options=EstimateOptions(
                model=absolute(preferences().model),
                prior=chosen["prior"],
                camera=chosen["camera"].strip() or None,
                analysis=AnalysisOptions(
                    use_metadata=not chosen["ignore_metadata"],
                    device=stated_device(None if chosen["device"] == "file" else chosen["device"]),
                ),
            ),
            is_forced=chosen["force"],
            stored=stored_estimate.restored(datablock) if is_estimated else None,
            primaries=_known_primaries(datablock, plate) if is_estimated else None,
            origin=stored_estimate.origin(datablock) if is_estimated else "",
        ),
        exposure=Exposure(anchor=Anchor(chosen["anchor"]), gray=chosen["gray"], stops=chosen["exposure"]),
        output=Output(
            mode=ApplyMode(chosen["apply"]),
            folder=absolute(chosen["folder"]) or _usual_folder(chosen["apply"], plate),
            depth=chosen["depth"],
            overwrite=chosen["overwrite"],
            own_files=stored_estimate.own_files(datablock),
            is_composed=chosen["compose"],
            despite_verdict=despite_verdict,
        ),
        config=color_management.running_config(),
    )


def _known_primaries(datablock: plates.Datablock, plate: Plate) -> Primaries | None:
    """Return the stored primaries of a plate; None if its file has changed since the estimate and has to be read."""
    is_same = not stored_estimate.is_file_changed(datablock, plate.file_state)
    return stored_estimate.primaries(datablock) if is_same and not stored_estimate.origin(datablock) else None


def _usual_folder(mode: str, plate: Plate) -> Path | None:
    """Return the folder for files if none was chosen: of the preferences, the plate or the .blend file."""
    if mode in WITHOUT_FILES:
        return None
    return absolute(preferences().folder) or plate.folder or absolute("//" if bpy.data.filepath else "")
