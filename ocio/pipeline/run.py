"""Do the tasks of a batch: in processes, recorded as they end, not stopped by a bad file."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, as_completed
from dataclasses import fields, replace
from pathlib import Path
from typing import Annotated, Any

from crfnet_core.errors import CRFNetError, check_kinds
from crfnet_core.types import Progress, checked_option, cores, show_progress

from ..errors import PlateError
from ..output_files import output_folder
from .batch import Batch, Task, plan_tasks
from .photographs import content_digest, file_state, unreadable_reason
from .records import PhotographRecord
from .workers import worker_pool

#: How often, and after how many seconds each, the record of files that another run has just written is looked for.
RECORD_TRIALS, RECORD_SECONDS = 10, 0.1

#: Processes that may be asked for.
MOST_WORKERS = 1024


def run_batch(
    batch: Batch,
    photographs: Mapping[Path, Path],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> list[PhotographRecord]:
    """Write the files of every photograph that is not done yet; return the records of all, in order.

    The files of a photograph appear together, and its record as soon as they do. The same call after an interruption
    goes on; photographs that failed are tried again. At the end, folders of estimates get a config with the color
    spaces of their photographs.

    Parameters
    ----------
    batch : Batch
        What they have in common.
    photographs : mapping of Path to Path
        As `find_photographs` returns them.
    workers : int, optional
        Processes of this machine; by default one a core.
    scheduler : str, optional
        The address of a Dask scheduler, in place of processes of this machine.
    progress : callable, optional
        Called with (done, total) after every photograph. What it raises ends the run after those that have begun.

    Raises
    ------
    CRFNetError
        If the folder holds results of other options or cannot be used, the response, the prior or the network cannot be
        read, a process dies, or no scheduler answers; not if a photograph is bad.
    """
    check_kinds(batch=(batch, Batch), photographs=(photographs, Mapping), progress=(progress, Callable | None))
    workers = checked_option("workers", workers, Annotated[int, (1, MOST_WORKERS)] | None)
    scheduler = checked_option("scheduler", scheduler, str | None)
    photographs = {checked_option("photographs", photo, Path): _place(place) for photo, place in photographs.items()}
    batch.check()
    records = batch.records.read()
    tasks = plan_tasks(batch, photographs, records)
    with output_folder(batch.out):
        batch.records.mend()
        known = [] if batch.plates.overwrite else [_known(task, records.get(task.place)) for task in tasks]
        ended = {record.place: record for record in known if record}
        todo = {task.place: task for task in tasks if task.place not in ended}
        show_progress(progress, len(ended), len(tasks))
        for record in _ended([*todo.values()], workers or cores(), scheduler):
            batch.records.append(record, files=todo[record.place].existing if record.error else ())
            ended[record.place] = record
            show_progress(progress, len(ended), len(tasks))
    return batch.finished([ended[task.place] for task in tasks])


def _place(place: Path) -> Path:
    """Return the folder of a photograph's files in the output's; raise CRFNetError if it leads out of it."""
    place = checked_option("photographs", place, Path)
    if place.is_absolute() or ".." in place.parts:
        raise CRFNetError("bad_option", name="photographs", problem=f"{place} leads out of the output folder")
    return place


def _known(task: Task, record: PhotographRecord | None) -> PhotographRecord | None:
    """Return the record of a photograph that is done, or has changed since; None if there is work."""
    if record and task.is_done(record):
        return replace(record, left_alone=True)
    if record and task.is_outdated(record):  # its record stays, so that the next run says the same
        return task.failure(PlateError("photograph_changed", path=task.photo))
    return None


def _ended(tasks: Sequence[Task], workers: int, scheduler: str | None) -> Iterator[PhotographRecord]:
    """Yield the records of photographs as they end."""
    if not tasks:
        return
    workers = min(workers, len(tasks))
    if (workers > 1 or scheduler) and not tasks[0].batch.options.threads:
        options = replace(tasks[0].batch.options, threads=1)
        tasks = [replace(task, batch=replace(task.batch, options=options)) for task in tasks]
    with worker_pool(workers, scheduler=scheduler) as pool:
        futures = {pool.submit(_recorded, _absolute(task) if scheduler else task): task for task in tasks}
        try:
            for future in as_completed(futures):
                problem, task = future.exception(), futures[future]
                if isinstance(problem, BrokenExecutor):
                    raise problem
                yield task.failure(problem) if problem else replace(future.result(), photograph=task.name)
        except (BrokenExecutor, CancelledError) as problem:  # the latter of a cluster whose scheduler has gone
            raise PlateError("process_died") from problem


def _absolute(task: Task) -> Task:
    """Return a task for workers that run in other folders."""
    options = _with_absolute_paths(task.batch.options)
    batch = _with_absolute_paths(replace(task.batch, options=options))
    return replace(task, photo=task.photo.absolute(), batch=batch)


def _with_absolute_paths(item: Any) -> Any:
    """Return a dataclass with absolute paths of what is there, but for folders in the output's."""
    facts = {each.name: getattr(item, each.name) for each in fields(item) if each.name != "folder"}
    paths = {name: Path(fact) for name, fact in facts.items() if isinstance(fact, Path) or str(fact).endswith(".json")}
    return replace(item, **{name: path.absolute() for name, path in paths.items() if path.exists()})


def _recorded(task: Task) -> PhotographRecord:
    """Return the record of a task; what goes wrong stands in it."""
    try:
        if reason := unreadable_reason(task.photo):
            raise PlateError("unreadable", path=task.photo, reason=reason)
        return _done_once(task)
    except BaseException as problem:  # noqa: BLE001 - a bad photograph never stops the others, whatever it provokes
        return task.failure(problem)


def _done_once(task: Task) -> PhotographRecord:
    """Do a task; if another run has just written its files, return the record that it is about to append."""
    try:
        state, content = file_state(task.photo), content_digest(task.photo)
        return _record_of_existing(task) or replace(task.batch.done(task), state=state, sha256=content)
    except CRFNetError:
        for _ in range(RECORD_TRIALS if task.existing else 0):
            record = task.batch.records.read().get(task.place)
            if record and task.is_done(record):
                return record
            time.sleep(RECORD_SECONDS)
        raise


def _record_of_existing(task: Task) -> PhotographRecord | None:
    """Return the record of files that are there, as another run may have made it meanwhile; None without any record.

    Raise PlateError if they belong to another photograph or program.
    """
    there = [] if task.batch.plates.overwrite else task.existing
    if not there:
        return None
    records = task.batch.records.read()
    record = records.get(task.place)
    if task.is_done(record):
        return record
    if record and not record.error and record.options != task.options:
        raise PlateError("other_options", path=task.batch.records.path, photo=task.photo)
    names = (task.folder.as_posix(), task.stem)
    is_owned = any((other.folder, other.stem) == names for other in records.values() if other is not record)
    if is_owned or (record is None and len(there) < len(task.targets)):
        raise PlateError("file_exists", path=there[0])
    return None
