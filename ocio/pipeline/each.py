"""Many photographs, one response each, with the files of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from crfnet_core.types import Progress

from ..configs.files import write_config
from ..configs.plate_color_space import PlateColorSpace
from ..configs.portable import portable_config
from ..defaults import ESTIMATES
from ..errors import LutError, PlateError
from ..luts.files import read_lut
from ..movies.source import file_source
from ..options import OutputOptions
from ..output_files import OutputFiles
from ..plates.primaries import linear_space
from .batch import Batch, Task, plan_tasks
from .delivery import deliver_estimate, estimated_light, with_light
from .estimates import estimate_files
from .loading import load_camera, load_network, load_prior
from .plan import OutputPlan, stale_files
from .records import PhotographRecord, RecordFile
from .run import run_tasks

#: Most photographs of a folder that still get a config: nobody chooses from a longer menu, and OpenColorIO's time to
#: build it grows with the square.
MAX_COLOR_SPACES = 1000


@dataclass(frozen=True, kw_only=True)
class EstimateBatch(Batch):
    """Photographs whose responses are estimated.

    Parameters
    ----------
    outputs : OutputOptions
        Which files are written of each.
    """

    outputs: OutputOptions

    @property
    def records(self) -> RecordFile:
        """The file of records."""
        return RecordFile(self.out / ESTIMATES)

    @property
    def choices(self) -> dict[str, Any]:
        """The options that make two results differ."""
        return {**super().choices, **asdict(self.outputs)}

    def files(self, folder: Path, stem: str) -> OutputFiles:
        """Return the files of one photograph."""
        return OutputFiles.named(self.out / folder, [Path(f"{stem}.jpg")], self.outputs)

    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the files of one photograph, except the config."""
        return self.files(folder, stem).unshared

    def done(self, task: Task) -> PhotographRecord:
        """Estimate one photograph and write its files."""
        is_complete = all(path.exists() for path in task.targets)  # as a killed run leaves it before its record
        estimated = estimate_files([file_source(task.photo)], self.options)
        light = estimated_light(estimated, self.plates, lut_length=self.outputs.lut_length)
        files = self.files(task.folder, task.stem)
        plates = replace(self.plates, overwrite=self.plates.overwrite or is_complete)
        deliver_estimate(OutputPlan(files, plates, self.outputs.lut_length), estimated, light)
        return task.record(light, estimated.estimate, lut=files.lut, linear=files.linear)


@dataclass(frozen=True)
class EachReport:
    """What became of many photographs.

    Parameters
    ----------
    records : tuple of PhotographRecord
        The record of each, in order.
    first : OutputFiles or None
        The files of the first that has any.
    stale_files : tuple of Path
        Files of an earlier run with other options that stay there, relative to the output folder.
    """

    records: tuple[PhotographRecord, ...]
    first: OutputFiles | None
    stale_files: tuple[Path, ...]


def estimate_each(
    batch: EstimateBatch,
    photographs: Mapping[Path, Path],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> EachReport:
    """Estimate and write every photograph that is not done yet.

    The files of a photograph appear together, and its record (in `ESTIMATES`) as soon as they do. The same call after
    an interruption goes on; photographs that failed are tried again. At the end each folder gets a config with the
    color spaces of its photographs, if there are no more than `MAX_COLOR_SPACES`.

    Parameters
    ----------
    batch : EstimateBatch
        What they have in common.
    photographs : mapping of Path to Path
        As `find_photographs` returns them.
    workers, scheduler, progress
        See `run_tasks`.

    Raises
    ------
    CRFNetError
        If the folder holds estimates of other options, cannot be used, or a process dies; not if a photograph is bad.
    """
    load_camera(batch.options), load_prior(batch.options), load_network(batch.options)  # what is bad is refused first
    folders = dict.fromkeys(photographs.values())
    configs = [batch.files(folder, "any").config for folder in folders]
    tasks = plan_tasks(batch, photographs, shared=configs)
    if not batch.records.path.exists() and not batch.plates.overwrite:
        for config in filter(Path.exists, configs):
            raise PlateError("file_exists", path=config)
    stale = [path.relative_to(batch.out) for task in tasks for path in _stale_files(batch, task)]
    records = run_tasks(batch, tasks, workers=workers, scheduler=scheduler, progress=progress)
    with batch.records.locked():  # two runs at once: the last that ends knows the records of both
        damaged = _write_configs(batch, tasks)
    for record in damaged.values():
        batch.records.append(record)
    records = [damaged.get(record.photograph, record) for record in records]
    written = (task for task, record in zip(tasks, records, strict=True) if not record.error)
    first = next((batch.files(task.folder, task.stem) for task in written), None)
    return EachReport(tuple(records), first, tuple(stale))


def _stale_files(batch: EstimateBatch, task: Task) -> Sequence[Path]:
    """Return the files of an earlier run with other options that stay beside those of a photograph."""
    return stale_files(batch.files(task.folder, task.stem), [task.photo])


def _write_configs(batch: EstimateBatch, tasks: Sequence[Task]) -> dict[str, PhotographRecord]:
    """Write a config into each folder, with the color spaces of all its photographs whose LUT is there.

    Return the photographs whose LUT is damaged: the next run estimates them again.
    """
    damaged: dict[str, PhotographRecord] = {}
    folders: dict[str, list[PhotographRecord]] = {}
    order = {str(task.photo): number for number, task in enumerate(tasks)}  # whatever ended first
    every = batch.records.read().values()
    for record in sorted(every, key=lambda each: (order.get(each.photograph, len(order)), each.photograph)):
        if not record.error and (batch.out / record.lut).exists():
            folders.setdefault(record.folder, []).append(record)
    for folder, records in folders.items():
        config = batch.files(Path(folder), records[0].stem).config
        if len(records) > MAX_COLOR_SPACES:
            config.unlink(missing_ok=True)
            continue
        spaces, check = [], {}
        for record in records:
            space = _color_space(batch, record)
            try:
                check[space.name] = read_lut(batch.out / record.lut).channels[0]
                spaces.append(space)
            except LutError as problem:
                damaged[record.photograph] = replace(record, error=str(problem))
        write_config(config, portable_config(spaces), check=check, overwrite=True)
    return damaged


def _color_space(batch: EstimateBatch, record: PhotographRecord) -> PlateColorSpace:
    """Return the color space of a photograph in the config of its folder."""
    files = batch.files(Path(record.folder), record.stem)
    space = PlateColorSpace.from_outputs(files, Path(record.photograph))
    return with_light(space, record.exposure, record.plate, linear_space(record.plate, batch.plates.output_space))
