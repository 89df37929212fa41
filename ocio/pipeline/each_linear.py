"""Many photographs as linear EXR: through one LUT, through a stored camera's response, or each through its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.types import Progress

from ..defaults import PLATES
from ..errors import PlateError
from ..interchange.files import read_response
from ..luts.rgb_lut import AnyLut
from ..movies.library import is_movie
from ..options import EstimateOptions, PlateOptions
from ..output_files import output_folder, plain_stem
from ..plates.frames import FrameSequence
from ..plates.linear import linearize_plates
from .batch import Task, check_tasks, network_and_prior, run_tasks
from .estimates import estimate_frames, response_lut
from .loading import load_camera_response
from .manifest import PhotographRecord
from .photographs import without_outputs


@dataclass(frozen=True, kw_only=True)
class LinearTask(Task):
    """One photograph that becomes a linear EXR.

    Parameters
    ----------
    target : Path
        The linear EXR.
    lut : Path or None
        The file of the response; None for that of the stored camera in `options`, or to estimate it.
    """

    target: Path
    lut: Path | None

    @property
    def targets(self) -> tuple[Path, ...]:
        """The linear EXR."""
        return (self.target,)

    @property
    def settings(self) -> dict[str, Any]:
        """The file of the response, too."""
        return {"lut": self.lut, **super().settings}

    def response_identity(self) -> str | None:
        """Return which response the file holds now, if there is one."""
        return read_response(self.lut).lut.identity if self.lut else super().response_identity()


def plan_each_linear(
    out: Path, photographs: Mapping[Path, Path], options: EstimateOptions, plates: PlateOptions, lut: Path | None
) -> tuple[LinearTask, ...]:
    """Return what is to be done for each photograph, after checking that no two write the same file; create nothing.

    Parameters
    ----------
    out : Path
        The folder to write to; it need not exist yet.
    photographs : mapping of Path to Path
        As `crfnet.pipeline.photographs.find_photographs` returns them. Those in `out` itself are left out, if a folder
        around it was searched.
    options, plates, lut
        See `LinearTask`.

    Raises
    ------
    PlateError
        If two photographs would write the same file, one of them would be replaced, or the folder cannot be used.
    """
    tasks = tuple(
        LinearTask(
            photo=photo,
            folder=folder,
            options=options,
            plates=plates,
            target=out / folder / f"{plain_stem(photo)}.exr",
            lut=lut,
        )
        for photo, folder in without_outputs(photographs, out).items()
    )
    check_tasks(out, tasks)
    return tasks


def linearize_each(
    out: Path,
    tasks: Sequence[LinearTask],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Write the linear EXR of every photograph that is not done yet; return the records of all, in order.

    The record of a photograph stands in the manifest (`PLATES`) as soon as its file does. The same call after an
    interruption goes on; photographs that failed are tried again.

    Parameters
    ----------
    out : Path
        The folder of the manifest.
    tasks : sequence of LinearTask
        As `plan_each_linear` returns them; at least one.
    workers, scheduler, progress
        See `crfnet.pipeline.batch.run_tasks`.

    Raises
    ------
    CRFNetError
        If the folder holds plates of other settings, the response cannot be read, or a process dies; not if a
        photograph is bad.
    """
    first = tasks[0]
    if not _given_response(first.lut, first.options):  # what is bad here is refused before anything is written
        network_and_prior(first.options)
    with output_folder(out):
        manifest = run_tasks(
            out / PLATES, tasks, linearize_one, workers=workers, scheduler=scheduler, progress=progress
        )
    return manifest.of(task.photo for task in tasks)


def linearize_one(task: LinearTask) -> PhotographRecord:
    """Write the linear EXR of one photograph; one of the same light that is there already is left alone.

    Raises
    ------
    CRFNetError, OSError, MemoryError
        What goes wrong.
    """
    if is_movie(task.photo):
        raise PlateError(f"{task.photo}: is a movie; linearize it by itself, without --each")
    photograph = FrameSequence((task.photo,))
    lut, estimate = _given_response(task.lut, task.options) or _estimated_response(photograph, task.options)
    with output_folder(task.target.parent):
        done = linearize_plates(photograph, (task.target,), lut, task.plates, workers=1)
    linear = (task.folder / task.target.name).as_posix()
    return PhotographRecord.of(task.photo, task.folder, done.light, estimate, linear=linear)


def _given_response(lut: Path | None, options: EstimateOptions) -> tuple[AnyLut, ResponseEstimate | None] | None:
    """Return the response that all photographs have; None if each has its own.

    It is read anew each time, in 15 ms: the workers of a cluster outlive a run, and files change between runs.
    """
    if lut:
        return read_response(lut).lut, None
    stored = load_camera_response(options)
    return (response_lut(stored), stored) if stored else None


def _estimated_response(photograph: FrameSequence, options: EstimateOptions) -> tuple[AnyLut, ResponseEstimate]:
    """Return the response estimated from a photograph."""
    network, prior = network_and_prior(options)
    estimate = estimate_frames(photograph, network, prior, options)
    return response_lut(estimate), estimate
