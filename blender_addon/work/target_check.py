# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that the files of a job can be written, before a response is estimated for them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from crfnet.output_files import check_folder
from crfnet.plates.frames import FrameSequence
from crfnet.plates.linear import linear_targets

from .errors import AddonError
from .job import WITHOUT_FILES, ApplyMode, Job
from .writers import baked_name, output_files


def check_targets(job: Job, sequence: Callable[[], FrameSequence]) -> None:
    """Check that the files of a job can be written; create nothing.

    Parameters
    ----------
    job : Job
        In any mode.
    sequence : callable
        Returns the frames of the plate; called only for a bake.

    Raises
    ------
    AddonError
        If the job has no folder, or a file exists and may not be replaced.
    CRFNetError
        If the folder cannot be written to.
    """
    if job.output.mode in WITHOUT_FILES:
        return
    if job.output.mode is ApplyMode.BAKE and job.plate.frame_count:
        raise AddonError(
            f"{job.plate.name}: movies are not baked; choose Nodes and render, or open its frames as an image sequence"
        )
    if job.output.folder is None:
        raise AddonError(
            f"{job.plate.name}: has no folder of its own; choose one under Folder, or save the .blend file"
        )
    check_folder(job.output.folder)
    if not job.output.overwrite:
        _check_absent(_targets(job, job.output.folder, sequence))


def _targets(job: Job, folder: Path, sequence: Callable[[], FrameSequence]) -> tuple[Path, ...]:
    """Return the files that a bake or an export writes."""
    if job.output.mode is ApplyMode.BAKE:
        return linear_targets(folder / baked_name(job.plate), sequence())
    files = output_files(job.plate, folder)
    return (*files.luts, files.config)


def _check_absent(targets: tuple[Path, ...]) -> None:
    """Raise an AddonError if a file exists."""
    existing = [path for path in targets if path.exists()]
    if existing:
        more = f" (and {len(existing) - 1} more)" if existing[1:] else ""
        folder = existing[0].parent
        raise AddonError(
            f"{existing[0].name} exists already in {folder}{more}; tick Overwrite or choose another Folder"
        )
