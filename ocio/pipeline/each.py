"""Many photographs, one response each, with the files of each."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
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
from ..options import EstimateOptions, OutputOptions, PlateOptions
from ..output_files import OutputFiles, output_folder
from ..plates.linear_space import linear_space
from ..staging import staged_files
from .batch import Task, check_tasks, network_and_prior, run_tasks
from .estimates import estimate_photographs
from .folders import estimated_light, left_files, with_light, write_estimate
from .loading import load_camera
from .manifest import Manifest, PhotographRecord
from .photographs import without_outputs

#: Most photographs of a folder that still get a config: nobody chooses from a longer menu, and OpenColorIO's time to
#: build it grows with the square.
MAX_COLOR_SPACES = 1000


@dataclass(frozen=True, kw_only=True)
class EstimateTask(Task):
    """One photograph whose response is estimated.

    Parameters
    ----------
    files : OutputFiles
        What is written.
    outputs : OutputOptions
        Which files these are.
    """

    files: OutputFiles
    outputs: OutputOptions

    @property
    def left(self) -> tuple[Path, ...]:
        """Files of an earlier run with other options that stay there, although they are not of this one."""
        return left_files(self.files, (self.photo,))

    @property
    def targets(self) -> tuple[Path, ...]:
        """Every file except the config."""
        return self.files.own

    @property
    def settings(self) -> dict[str, Any]:
        """Those of the files, too."""
        return {**super().settings, **asdict(self.outputs)}


def plan_each(
    out: Path,
    photographs: Mapping[Path, Path],
    options: EstimateOptions,
    plates: PlateOptions,
    outputs: OutputOptions,
) -> tuple[EstimateTask, ...]:
    """Return what is to be done for each photograph, after checking that no two write the same files; create nothing.

    Parameters
    ----------
    out : Path
        The folder to write to; it need not exist yet.
    photographs : mapping of Path to Path
        As `find_photographs` returns them. Those in `out` itself are left out, if a folder around it was searched.
    options, plates, outputs
        See `EstimateTask`.

    Raises
    ------
    PlateError
        If two photographs would write the same file, one of them would be replaced, or the folder cannot be used.
    """
    tasks = tuple(
        EstimateTask(
            photo=photo,
            files=OutputFiles.named(out / folder, (photo,), outputs),
            folder=folder,
            options=options,
            plates=plates,
            outputs=outputs,
        )
        for photo, folder in without_outputs(photographs, out).items()
    )
    check_tasks(out, tasks, shared=list(dict.fromkeys(task.files.config for task in tasks)))
    return tasks


def estimate_each(
    out: Path,
    tasks: Sequence[EstimateTask],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Estimate and write every photograph that is not done yet; return the records of all, in order.

    The files of a photograph appear together, and its record stands in the manifest (`ESTIMATES`) as soon as they do.
    The same call after an interruption goes on; photographs that failed are tried again. At the end each folder gets
    a config with the colour spaces of its photographs, if there are no more than `MAX_COLOR_SPACES`.

    Parameters
    ----------
    out : Path
        The folder of the manifest.
    tasks : sequence of EstimateTask
        As `plan_each` returns them; at least one.
    workers, scheduler, progress
        See `crfnet.pipeline.batch.run_tasks`.

    Raises
    ------
    CRFNetError
        If the folder holds estimates of other settings or a process dies; not if a photograph is bad.
    """
    first = tasks[0]
    if not (out / ESTIMATES).exists() and not first.plates.overwrite:
        _check_absent([task.files.config for task in tasks])
    network_and_prior(first.options)  # a bad model, prior or camera is refused before anything is written
    load_camera(first.options)
    with output_folder(out):
        path = out / ESTIMATES
        manifest = run_tasks(path, tasks, estimate_one, workers=workers, scheduler=scheduler, progress=progress)
        _write_configs(out, manifest, first.plates.output_space)
    return manifest.of(task.photo for task in tasks)


def estimate_one(task: EstimateTask) -> PhotographRecord:
    """Estimate one photograph and write its files.

    Raises
    ------
    CRFNetError, OSError, MemoryError
        What goes wrong.
    """
    # A whole set without a record is that of a run that was killed in between.
    if not task.plates.overwrite and not all(path.exists() for path in task.targets):
        _check_absent(task.targets)
    network, prior = network_and_prior(task.options)
    estimated = estimate_photographs((task.photo,), network, prior, task.options)
    light = estimated_light(estimated, task.plates, lut_length=task.outputs.lut_length)
    folder = task.files.report.parent
    with output_folder(folder), staged_files(folder) as staged:
        write_estimate(task.files.in_folder(staged), estimated, light, task.plates)
    return PhotographRecord.of(task.photo, task.folder, light, estimated.estimate)


def _check_absent(paths: Iterable[Path]) -> None:
    """Refuse to replace files."""
    for path in paths:
        if os.path.lexists(path):
            raise PlateError(f"{path}: exists already; add --overwrite or move it away")


def _write_configs(out: Path, manifest: Manifest, output_space: str) -> None:
    """Write a config into each folder, with the colour spaces of all its photographs whose LUT is there.

    A photograph whose LUT is damaged counts as failed.
    """
    damaged: list[PhotographRecord] = []
    folders: dict[Path, dict[Path, tuple[OutputFiles, PhotographRecord]]] = {}
    for record in manifest.records.values():
        folder = out / record.folder
        own = OutputFiles.named(folder, [Path(record.photograph)])
        if not record.error and own.lut.exists():
            folders.setdefault(folder, {}).setdefault(own.lut, (own, record))
    for written in folders.values():
        files = [own for own, _ in written.values()]
        if len(files) > MAX_COLOR_SPACES:
            files[0].config.unlink(missing_ok=True)
            continue
        spaces, check = [], {}
        for own, record in written.values():
            try:
                check[own.color_space] = read_lut(own.lut).channels[0]
                spaces.append(_color_space(own, record, output_space))
            except LutError as problem:  # damaged since: the next run estimates it again
                damaged.append(replace(record, error=str(problem)))
        write_config(files[0].config, portable_config(spaces), check=check, overwrite=True)
    if damaged:
        manifest.records |= {record.photograph: record for record in damaged}
        manifest.rewrite(manifest.records)


def _color_space(files: OutputFiles, record: PhotographRecord, output_space: str) -> PlateColorSpace:
    """Return the colour space of a photograph in the config of its folder."""
    space = PlateColorSpace.from_outputs(files, Path(record.photograph))
    return with_light(space, record.exposure, record.plate, linear_space(record.plate, output_space))
