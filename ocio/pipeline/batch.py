"""Many photographs, one task each: recorded as they end, continued when interrupted, not stopped by a bad file."""

from __future__ import annotations

import hashlib
import itertools
import os
import time
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.files import cut_to_bytes
from crfnet_core.types import Progress, cores, show_progress

from ..errors import PlateError, error_of_file
from ..options import EstimateOptions, PlateOptions
from ..output_files import LONGEST_STEM, check_targets, output_folder, plain_stem
from ..plates.light import PlateLight
from ..report import result_line
from .estimates import response_lut
from .loading import load_camera_response
from .photographs import unreadable_reason, without_outputs
from .records import PhotographRecord, RecordFile
from .workers import worker_pool

#: Bytes that a number behind a stem may need.
NUMBER_BYTES = 8

#: How often, and after how many seconds each, the record of files that another run has just written is looked for.
RECORD_TRIALS, RECORD_SECONDS = 10, 0.1


@dataclass(frozen=True, kw_only=True)
class Batch(ABC):
    """What many photographs have in common.

    Parameters
    ----------
    out : Path
        The folder for everything.
    options : EstimateOptions
        How responses are estimated.
    plates : PlateOptions
        How linear plates are written; `overwrite` holds for every file.
    """

    out: Path
    options: EstimateOptions
    plates: PlateOptions

    @property
    @abstractmethod
    def records(self) -> RecordFile:
        """The file of records."""

    @abstractmethod
    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the files of one photograph alone."""

    @abstractmethod
    def done(self, task: Task) -> PhotographRecord:
        """Write the files of one photograph and return its record.

        Raises
        ------
        Exception
            Whatever goes wrong.
        """

    def shared_response(self) -> str | None:
        """Return which response all photographs have now: the stored camera's; None if each has its own."""
        stored = load_camera_response(self.options)
        return response_lut(stored).identity if stored else None

    @property
    def choices(self) -> dict[str, Any]:
        """The options that make two results differ."""
        chosen = {**asdict(self.options), **asdict(self.plates)}
        return {name: value for name, value in chosen.items() if name not in ("threads", "overwrite")}

    def digest(self) -> str:
        """Return a digest of the options and of the shared response."""
        text = repr(sorted((self.choices | {"response": self.shared_response()}).items()))
        return hashlib.sha256(text.encode(errors="backslashreplace")).hexdigest()[:16]


@dataclass(frozen=True)
class Task:
    """One photograph of a batch, and all that its worker gets.

    Parameters
    ----------
    batch : Batch
        The batch.
    photo : Path
        The photograph.
    folder : Path
        The folder of its files, relative to the batch's.
    stem : str
        The name of its files, without suffix; no other photograph of the folder has it.
    options : str
        The batch's digest.
    """

    batch: Batch
    photo: Path
    folder: Path
    stem: str
    options: str

    @property
    def targets(self) -> tuple[Path, ...]:
        """The files of this photograph alone."""
        return self.batch.targets(self.folder, self.stem)

    def record(
        self,
        light: PlateLight,
        estimate: ResponseEstimate | None,
        *,
        lut: Path | None = None,
        linear: Sequence[Path] = (),
    ) -> PhotographRecord:
        """Return the record of this photograph, whose files are whole, and of its estimate if there is one."""
        record = PhotographRecord(
            photograph=str(self.photo),
            options=self.options,
            folder=self.folder.as_posix(),
            lut="".join(path.relative_to(self.batch.out).as_posix() for path in (lut,) if path),
            linear="".join(path.relative_to(self.batch.out).as_posix() for path in linear),
            exposure=light.stops,
            primaries=asdict(light.plate.primaries) if light.plate.primaries else None,
            primaries_source=light.plate.source,
            summary=f"{self.photo.name}: linear",
        )
        if estimate is None:
            return record
        kind = estimate.likely_kind
        return replace(
            record,
            weights=tuple(estimate.weights.tolist()),
            family=kind.words if kind else "",
            verdict=estimate.verdict,
            uncertainty=estimate.uncertainty,
            shape_uncertainty_stops=estimate.shape_uncertainty,
            warnings=tuple(map(str, estimate.warnings)),
            summary=result_line(estimate, name=self.photo.name),
        )

    def is_done(self, record: PhotographRecord | None) -> bool:
        """Return whether a record says that this photograph needs no work, and its files are still there."""
        if record is None or record.error or (record.folder, record.stem) != (self.folder.as_posix(), self.stem):
            return False
        return record.options == self.options and all(path.exists() for path in self.targets)


def plan_tasks(batch: Batch, photographs: Mapping[Path, Path], *, shared: Sequence[Path] = ()) -> tuple[Task, ...]:
    """Return what is to be done for each photograph, after checking that it can be; create nothing.

    Two photographs of one name in one folder get files of different names: a.jpg and a.png those of `a` and `a_2`.
    A photograph keeps the name that an earlier run has given it.

    Parameters
    ----------
    batch : Batch
        What they have in common.
    photographs : mapping of Path to Path
        As `find_photographs` returns them. Those in the batch's folder are left out, if a folder around it was
        searched.
    shared : sequence of Path
        Files of several photographs, which must not replace a photograph.

    Raises
    ------
    CRFNetError
        If a photograph would be replaced, the folder cannot be used, the response cannot be read, or the records
        are damaged.
    """
    chosen, records = without_outputs(photographs, batch.out), batch.records.read()
    stems, digest = _distinct_stems(batch, chosen, records), batch.digest()
    tasks = tuple(Task(batch, photo, folder, stems[photo], digest) for photo, folder in chosen.items())
    for task in () if batch.plates.overwrite else tasks:
        record = records.get(str(task.photo))
        if record and not record.error and record.options != digest and any(map(os.path.lexists, task.targets)):
            raise PlateError("other_options", path=batch.records.path, photo=task.photo)
    targets = [path for task in tasks if not unreadable_reason(task.photo) for path in task.targets]
    check_targets(batch.out, targets, photos=list(chosen), shared=shared, overwrite=True)
    return tasks


def run_tasks(
    batch: Batch,
    tasks: Sequence[Task],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Do the tasks that are not done yet; return the records of all, in order.

    A record is appended as soon as the files of its photograph are whole. The same call after an interruption goes on;
    photographs that failed are tried again.

    Parameters
    ----------
    batch : Batch
        See `plan_tasks`.
    tasks : sequence of Task
        As `plan_tasks` returns them.
    workers : int, optional
        Processes; by default one a core.
    scheduler : str, optional
        The address of a Dask scheduler: see `worker_pool`.
    progress : callable, optional
        Called with (done, total) after every photograph; whatever it raises ends the run after those that have begun.

    Raises
    ------
    CRFNetError
        If a process dies, or no scheduler answers; not if a photograph is bad.
    """
    with output_folder(batch.out):
        file = batch.records
        records = {} if batch.plates.overwrite else file.read()
        todo = [task for task in tasks if not task.is_done(records.get(str(task.photo)))]
        done = len(tasks) - len(todo)
        show_progress(progress, done, len(tasks))
        for record in _ended(todo, workers or cores(), scheduler):
            file.append(record)
            records[record.photograph] = record
            done += 1
            show_progress(progress, done, len(tasks))
    return [records[str(task.photo)] for task in tasks]


def _distinct_stems(
    batch: Batch, photographs: Mapping[Path, Path], records: Mapping[str, PhotographRecord]
) -> dict[Path, str]:
    """Return a stem for each photograph whose files are nobody else's, on systems that take A for a, too."""
    owners: dict[str, str] = {}
    for record in records.values():
        owners |= dict.fromkeys(
            _keys(batch, Path(record.folder), record.stem) if record.stem else (), record.photograph
        )
    stems = {}
    for photo, folder in photographs.items():
        earlier = records.get(str(photo))
        stem = earlier.stem if earlier and earlier.folder == folder.as_posix() else ""
        for candidate in itertools.chain([stem] if stem else [], _stems(photo)):
            keys = _keys(batch, folder, candidate)
            if all(_same_file(owners.get(key, str(photo)), photo) for key in keys):
                owners |= dict.fromkeys(keys, str(photo))
                stems[photo] = candidate
                break
    return stems


def _keys(batch: Batch, folder: Path, stem: str) -> list[str]:
    """Return the names of a photograph's files, equal for those that some systems take for one."""
    return [str(path).casefold() for path in batch.targets(folder, stem)]


def _stems(photo: Path) -> Iterator[str]:
    """Yield names for the files of a photograph: its own, then with a number."""
    stem = plain_stem(photo)
    yield stem
    number = 2
    while True:
        yield f"{cut_to_bytes(stem, LONGEST_STEM - NUMBER_BYTES)}_{number}"
        number += 1


def _same_file(name: str, photo: Path) -> bool:
    """Return whether a name, perhaps by another way to its folder, is that of a photograph."""
    return os.path.normpath(Path(name).absolute()) == os.path.normpath(photo.absolute())


def _ended(tasks: Sequence[Task], workers: int, scheduler: str | None) -> Iterator[PhotographRecord]:
    """Yield the records of photographs as they end."""
    if not tasks:
        return
    workers = min(workers, len(tasks))
    if (workers > 1 or scheduler) and not tasks[0].batch.options.threads:
        single = replace(tasks[0].batch, options=replace(tasks[0].batch.options, threads=1))
        tasks = [replace(task, batch=single) for task in tasks]
    with worker_pool(workers, scheduler=scheduler) as pool:
        futures = [pool.submit(_recorded, task) for task in tasks]
        try:
            for future in as_completed(futures):
                yield future.result()
        except BrokenExecutor as problem:
            raise PlateError("process_died") from problem


def _recorded(task: Task) -> PhotographRecord:
    """Return the record of a task; what goes wrong stands in it."""
    try:
        if reason := unreadable_reason(task.photo):
            raise PlateError("unreadable", path=task.photo, reason=reason)
        return _done_once(task)
    except BaseException as problem:  # noqa: BLE001 - a bad photograph never stops the others, whatever it provokes
        error = str(error_of_file(problem, task.photo))
        return PhotographRecord(photograph=str(task.photo), options=task.options, error=error)


def _done_once(task: Task) -> PhotographRecord:
    """Do a task; if another run has just written its files, return the record that it is about to append."""
    try:
        return _record_of_existing(task) or task.batch.done(task)
    except CRFNetError:
        for _ in range(RECORD_TRIALS if _existing(task) else 0):
            record = task.batch.records.read().get(str(task.photo))
            if record and task.is_done(record):
                return record
            time.sleep(RECORD_SECONDS)
        raise


def _record_of_existing(task: Task) -> PhotographRecord | None:
    """Return the record of files that are there, as another run may have made it meanwhile; None without any record.

    Raises
    ------
    PlateError
        If they are those of another photograph, or of another program.
    """
    there = [] if task.batch.plates.overwrite else _existing(task)
    if not there:
        return None
    records = task.batch.records.read()
    record = records.get(str(task.photo))
    if task.is_done(record):
        return record
    place = (task.folder.as_posix(), task.stem)
    is_owned = any((other.folder, other.stem) == place for other in records.values() if other is not record)
    if is_owned or (record is None and len(there) < len(task.targets)):
        raise PlateError("file_exists", path=there[0])
    return None


def _existing(task: Task) -> list[Path]:
    """Return the files of a task that are there."""
    return [path for path in task.targets if os.path.lexists(path)]
