"""Many photographs as linear EXR: through one LUT, through a stored camera's response, or each through its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.types import Progress

from ..defaults import PLATES
from ..errors import PlateError
from ..luts.response import read_response
from ..luts.rgb_lut import AnyLut
from ..movies.library import is_movie
from ..output_files import output_folder
from ..plates.frames import FrameSequence
from ..plates.linear import linearize_plates
from .batch import Batch, Task, plan_tasks
from .estimates import estimate_files, response_lut
from .loading import load_camera_response, load_network, load_prior
from .records import PhotographRecord, RecordFile
from .run import run_tasks


@dataclass(frozen=True, kw_only=True)
class LinearBatch(Batch):
    """Photographs that become linear EXR files.

    Parameters
    ----------
    lut : Path or None
        The file of the response; None for that of the stored camera in `options`, or to estimate it.
    """

    lut: Path | None

    @property
    def records(self) -> RecordFile:
        """The file of records."""
        return RecordFile(self.out / PLATES)

    @property
    def choices(self) -> dict[str, Any]:
        """The options that make two results differ."""
        return {"lut": self.lut, **super().choices}

    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the linear EXR of one photograph."""
        return (self.out / folder / f"{stem}.exr",)

    def shared_response(self) -> str | None:
        """Return which response the file holds now, if there is one, else that of the stored camera."""
        return read_response(self.lut).lut.identity if self.lut else super().shared_response()

    def done(self, task: Task) -> PhotographRecord:
        """Write the linear EXR of one photograph; one of the same light that is there already is left alone."""
        if is_movie(task.photo):
            raise PlateError("movie_in_batch", path=task.photo)
        photograph, targets = FrameSequence((task.photo,)), task.targets
        lut, estimate = self.response() or self._estimated(photograph)
        with output_folder(targets[0].parent):
            written = linearize_plates(photograph, targets, lut, self.plates, workers=1)
        return task.record(written.light, estimate, linear=targets)

    def response(self) -> tuple[AnyLut, ResponseEstimate | None] | None:
        """Return the response that all photographs have; None if each has its own.

        It is read anew each time, in 15 ms: the workers of a cluster outlive a run, and files change between runs.
        """
        if self.lut:
            return read_response(self.lut).lut, None
        stored = load_camera_response(self.options)
        return (response_lut(stored), stored) if stored else None

    def _estimated(self, photograph: FrameSequence) -> tuple[AnyLut, ResponseEstimate]:
        """Return the response estimated from a photograph."""
        estimate = estimate_files([photograph], self.options).estimate
        return response_lut(estimate), estimate


def linearize_each(
    batch: LinearBatch,
    photographs: Mapping[Path, Path],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Write the linear EXR of every photograph that is not done yet; return the records of all, in order.

    The record of a photograph stands in `PLATES` as soon as its file is whole. The same call after an interruption goes
    on; photographs that failed are tried again.

    Parameters
    ----------
    batch : LinearBatch
        What they have in common.
    photographs : mapping of Path to Path
        As `find_photographs` returns them.
    workers, scheduler, progress
        See `run_tasks`.

    Raises
    ------
    CRFNetError
        If the folder holds plates of other options, the response cannot be read, or a process dies; not if a
        photograph is bad.
    """
    if not batch.response():  # what is bad here is refused before anything is written
        load_prior(batch.options), load_network(batch.options)
    tasks = plan_tasks(batch, photographs)
    return run_tasks(batch, tasks, workers=workers, scheduler=scheduler, progress=progress)
