"""Do the tasks of a batch: in processes, recorded as they end, not stopped by a bad file."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, as_completed
from dataclasses import replace
from pathlib import Path

from crfnet_core.errors import CRFNetError, one_line
from crfnet_core.types import Progress, cores, show_progress

from ..errors import PlateError
from ..output_files import output_folder
from .batch import Batch, Task
from .photographs import unreadable_reason
from .records import PhotographRecord
from .workers import worker_pool

#: How often, and after how many seconds each, the record of files that another run has just written is looked for.
RECORD_TRIALS, RECORD_SECONDS = 10, 0.1


def run_tasks(
    batch: Batch,
    tasks: Sequence[Task],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Do the tasks that are not done yet, in processes (by default one a core) or by a Dask scheduler.

    Return the records of all, in order. A record is appended as soon as the files of its photograph are whole. What the
    progress callback raises ends the run after the photographs that have begun.

    Raises
    ------
    PlateError
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
    except Exception as problem:  # noqa: BLE001 - a bad photograph never stops the others, whatever it provokes
        return PhotographRecord(photograph=str(task.photo), options=task.options, error=_words(problem, task.photo))


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


def _words(problem: Exception, photo: Path) -> str:
    """Return why a photograph failed, on one line, with its name."""
    if isinstance(problem, MemoryError):
        return one_line(f"{photo}: not enough memory")
    text = one_line(problem)
    if isinstance(problem, CRFNetError | OSError):
        return text
    return one_line(f"{photo}: {type(problem).__name__} ({text})")
