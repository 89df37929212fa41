"""Many photographs, one response each: written as they end, continued when interrupted, not stopped by a bad file."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError, PlateError, one_line
from crfnet_core.image_io import PHOTOGRAPH_SUFFIXES
from crfnet_core.network import ResponseNetwork
from crfnet_core.posterior import Prior
from crfnet_core.types import Progress, show_progress
from ocio.configs.files import write_config
from ocio.configs.portable import portable_config
from ocio.luts.files import read_lut
from ocio.options import EstimateOptions, OutputOptions, PlateOptions
from ocio.output_files import OutputFiles, check_outputs, output_folder
from ocio.pipeline.estimates import estimate_photographs
from ocio.pipeline.folders import estimated_light, with_light, write_estimate
from ocio.pipeline.loading import load_camera, load_network, load_prior
from ocio.pipeline.manifest import MANIFEST, Manifest, PhotographRecord
from ocio.pipeline.workers import cores, worker_pool
from ocio.plates.linear_space import linear_space
from ocio.staging import staged_files

#: Most photographs of a folder that still get a config: nobody chooses from a longer menu, and OpenColorIO's time to
#: build it grows with the square.
MAX_COLOR_SPACES = 1000


@dataclass(frozen=True)
class Task:
    """One photograph, and all that its estimate needs: what a worker gets.

    Parameters
    ----------
    photo : Path
        The photograph.
    files : OutputFiles
        What is written.
    folder : Path
        Their folder, relative to the manifest.
    options : EstimateOptions
        How the response is estimated.
    plates : PlateOptions
        How the linear plate is written; `overwrite` holds for every file.
    outputs : OutputOptions
        Which files are written.
    """

    photo: Path
    files: OutputFiles
    folder: Path
    options: EstimateOptions
    plates: PlateOptions
    outputs: OutputOptions


def find_photographs(names: Sequence[Path]) -> dict[Path, Path]:
    """Return photographs, and where their files go, relative to the output folder.

    Parameters
    ----------
    names : sequence of Path
        Files, and folders that are searched with all their subfolders for `PHOTOGRAPH_SUFFIXES`. What belongs to a
        photograph in a subfolder goes into a subfolder of the same name.

    Raises
    ------
    PlateError
        If a folder holds no photograph.
    """
    photographs: dict[Path, Path] = {}
    for name in names:
        if not name.is_dir():
            photographs[name] = Path()
            continue
        found = sorted(path for path in name.rglob("*") if path.suffix.lower() in PHOTOGRAPH_SUFFIXES)
        if not found:
            raise PlateError(
                f"{name}: the folder holds no photograph ({', '.join(PHOTOGRAPH_SUFFIXES)}); check the name"
            )
        photographs |= {path: path.parent.relative_to(name) for path in found}
    return photographs


def plan_each(
    out: Path,
    photographs: Mapping[Path, Path],
    options: EstimateOptions,
    plates: PlateOptions,
    outputs: OutputOptions,
) -> tuple[Task, ...]:
    """Return what is to be done for each photograph, after checking that no two write the same files; create nothing.

    Parameters
    ----------
    out : Path
        The folder to write to; it need not exist yet.
    photographs : mapping of Path to Path
        As `find_photographs` returns them.
    options, plates, outputs
        See `Task`.

    Raises
    ------
    PlateError
        If two photographs would write the same file, one of them would be replaced, or the folder cannot be used.
    """
    tasks = tuple(
        Task(
            photo=photo,
            files=OutputFiles.planned(out / folder, (photo,), outputs),
            folder=folder,
            options=options,
            plates=plates,
            outputs=outputs,
        )
        for photo, folder in photographs.items()
    )
    check_outputs(out, [task.files for task in tasks], photos=photographs, overwrite=True)
    return tasks


def estimate_each(
    out: Path,
    tasks: Sequence[Task],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Estimate and write every photograph that is not done yet; return the records of all, in order.

    The files of a photograph appear together, and its record stands in the manifest (`MANIFEST`) as soon as they do.
    The same call after an interruption goes on; photographs that failed are tried again. At the end each folder gets
    a config with the colour spaces of its photographs, if there are no more than `MAX_COLOR_SPACES`.

    Parameters
    ----------
    out : Path
        The folder of the manifest.
    tasks : sequence of Task
        As `plan_each` returns them; at least one.
    workers : int, optional
        Processes; by default one a core.
    scheduler : str, optional
        The address of a Dask scheduler: see `worker_pool`.
    progress : callable, optional
        Called with (done, total) after every photograph; whatever it raises ends the run after those that have begun.

    Raises
    ------
    CRFNetError
        If the folder holds estimates of other settings or a process dies; not if a photograph is bad.
    """
    first = tasks[0]
    if not (out / MANIFEST).exists() and not first.plates.overwrite:
        _check_absent([task.files.config for task in tasks])
    _network_and_prior(first.options)  # a bad model, prior or camera is refused before anything is written
    load_camera(first.options)
    with output_folder(out):
        manifest = Manifest(out / MANIFEST, _settings(first), overwrite=first.plates.overwrite)
        todo = [task for task in tasks if not _is_done(task, manifest)]
        before = len(tasks) - len(todo)
        show_progress(progress, before, len(tasks))
        for done, record in enumerate(_records(todo, workers or cores(), scheduler), before + 1):
            manifest.add(record)
            show_progress(progress, done, len(tasks))
        names = [str(task.photo) for task in tasks]
        manifest.rewrite(dict.fromkeys([*names, *manifest.records]))
        _write_configs(out, manifest, first.plates.output_space)
    return [manifest.records[name] for name in names]


def estimate_one(task: Task) -> PhotographRecord:
    """Estimate one photograph and write its files; what goes wrong stands in the record."""
    target = task.files.report.parent
    try:
        # A whole set without a record is that of a run that was killed in between.
        if not task.plates.overwrite and not all(path.exists() for path in task.files.own):
            _check_absent(task.files.own)
        network, prior = _network_and_prior(task.options)
        estimated = estimate_photographs((task.photo,), network, prior, task.options)
        light = estimated_light(estimated, task.plates, lut_length=task.outputs.lut_length)
        with output_folder(target), staged_files(target) as staged:
            write_estimate(task.files.in_folder(staged), estimated, light, task.plates)
    except (CRFNetError, OSError, MemoryError) as problem:
        return PhotographRecord(photograph=str(task.photo), error=one_line(problem) or "not enough memory")
    return PhotographRecord.of(task.photo, task.folder, estimated.estimate, light)


def _records(tasks: Sequence[Task], workers: int, scheduler: str | None) -> Iterator[PhotographRecord]:
    """Yield the records of photographs as they are done."""
    if not tasks:
        return
    workers = min(workers, len(tasks))
    if (workers > 1 or scheduler) and not tasks[0].options.threads:
        single = replace(tasks[0].options, threads=1)
        tasks = [replace(task, options=single) for task in tasks]
    with worker_pool(workers, scheduler=scheduler) as pool:
        futures = [pool.submit(estimate_one, task) for task in tasks]
        try:
            for future in as_completed(futures):
                yield future.result()
        except BrokenExecutor as problem:
            raise CRFNetError("a process died, perhaps for lack of memory; run the same command again") from problem


@lru_cache(maxsize=1)
def _network_and_prior(options: EstimateOptions) -> tuple[ResponseNetwork, Prior]:
    """Return the network and the prior, loaded once in a process."""
    return load_network(options), load_prior(options)


def _settings(task: Task) -> dict[str, Any]:
    """Return what the estimates of a manifest have in common, ready for JSON."""
    chosen = {**asdict(task.options), **asdict(task.plates), **asdict(task.outputs)}
    settings = {name: chosen[name] for name in chosen if name not in ("threads", "overwrite")}
    return {name: str(value) if isinstance(value, Path) else value for name, value in settings.items()}


def _is_done(task: Task, manifest: Manifest) -> bool:
    """Return whether the manifest has an estimate of a photograph whose files are still there."""
    record = manifest.records.get(str(task.photo))
    return record is not None and not record.error and all(path.exists() for path in task.files.own)


def _check_absent(paths: Iterable[Path]) -> None:
    """Refuse to replace files."""
    for path in paths:
        if os.path.lexists(path):
            raise PlateError(f"{path}: exists already; add --overwrite or move it away")


def _write_configs(out: Path, manifest: Manifest, output_space: str) -> None:
    """Write a config into each folder, with the colour spaces of all its photographs that have an estimate."""
    folders: dict[Path, list[PhotographRecord]] = {}
    for record in manifest.records.values():
        if not record.error:
            folders.setdefault(out / record.folder, []).append(record)
    for folder, records in folders.items():
        photos = [Path(record.photograph) for record in records]
        files = [OutputFiles.named(folder, [photo]) for photo in photos]
        if len(files) > MAX_COLOR_SPACES:
            files[0].config.unlink(missing_ok=True)
            continue
        spaces = [
            with_light(
                own.plate_color_space(photo), record.exposure, record.plate, linear_space(record.plate, output_space)
            )
            for own, photo, record in zip(files, photos, records, strict=True)
        ]
        check = {files[0].color_space: read_lut(files[0].spi1d).channels[0]}  # they all are made alike
        write_config(files[0].config, portable_config(spaces), check=check, overwrite=True)
