"""Many photographs, one task each: recorded as they end, continued when interrupted, not stopped by a bad file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from crfnet_core.errors import CRFNetError, PhotoError, one_line
from crfnet_core.network import ResponseNetwork
from crfnet_core.posterior import Prior
from crfnet_core.types import Progress, cores, show_progress

from ..errors import PlateError
from ..options import EstimateOptions, PlateOptions
from ..output_files import check_targets, plain_stem
from .estimates import response_lut
from .loading import load_camera_response, load_network, load_prior
from .manifest import RESPONSE, Manifest, PhotographRecord
from .photographs import check_distinct, fault, is_folder
from .workers import worker_pool


@dataclass(frozen=True, kw_only=True)
class Task(ABC):
    """One photograph, and all that its worker gets.

    Parameters
    ----------
    photo : Path
        The photograph.
    folder : Path
        The folder of its files, relative to the manifest.
    options : EstimateOptions
        How responses are estimated.
    plates : PlateOptions
        How the linear plate is written; `overwrite` holds for every file.
    """

    photo: Path
    folder: Path
    options: EstimateOptions
    plates: PlateOptions

    @property
    @abstractmethod
    def targets(self) -> tuple[Path, ...]:
        """The files of this photograph alone."""

    @property
    def settings(self) -> dict[str, Any]:
        """The options that all tasks of a manifest have in common."""
        chosen = {**asdict(self.options), **asdict(self.plates)}
        return {name: chosen[name] for name in chosen if name not in ("threads", "overwrite")}

    def response_identity(self) -> str | None:
        """Return which response all tasks of a manifest have now: the stored camera's; None if each has its own."""
        stored = load_camera_response(self.options)
        return response_lut(stored).identity if stored else None


AnyTask = TypeVar("AnyTask", bound=Task)


def check_tasks(out: Path, tasks: Sequence[Task], *, shared: Sequence[Path] = ()) -> None:
    """Check that the files of all tasks can be written, and no two photographs to the same; create nothing.

    Parameters
    ----------
    out : Path
        The folder to write to; it need not exist yet.
    tasks : sequence of Task
        At least one. Those that `run_tasks` will refuse write nothing.
    shared : sequence of Path
        The configs, of several photographs.

    Raises
    ------
    PlateError
        See `check_distinct` and `crfnet.output_files.check_targets`; existing files may be replaced.
    """
    pairs = [(target, task.photo) for task in tasks if not fault(task.photo) for target in task.targets]
    check_distinct(pairs, remedy="give them to two runs, each with its own --out")
    photos = [task.photo for task in tasks]
    check_targets(out, [target for target, _ in pairs], photos=photos, shared=shared, overwrite=True)


def run_tasks(
    path: Path,
    tasks: Sequence[AnyTask],
    work: Callable[[AnyTask], PhotographRecord],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> Manifest:
    """Do the tasks that are not done yet; return the manifest with the records of all, in order.

    Parameters
    ----------
    path : Path
        The manifest, to which a record is added as soon as a task ends; its folder must exist.
    tasks : sequence of Task
        At least one.
    work : callable
        A function of a module, since other processes call it.
    workers : int, optional
        Processes; by default one a core.
    scheduler : str, optional
        The address of a Dask scheduler: see `worker_pool`.
    progress : callable, optional
        Called with (done, total) after every photograph; whatever it raises ends the run after those that have begun.

    Raises
    ------
    CRFNetError
        If the manifest is of other settings or has files of these names for other photographs, or a process dies; not
        if a photograph is bad.
    """
    chosen = {name: str(value) if isinstance(value, Path) else value for name, value in tasks[0].settings.items()}
    manifest = Manifest(path, chosen | {RESPONSE: tasks[0].response_identity()}, overwrite=tasks[0].plates.overwrite)
    _check_owners(tasks, manifest)
    todo = [task for task in tasks if not _is_done(task, manifest)]
    before = len(tasks) - len(todo)
    show_progress(progress, before, len(tasks))
    for done, record in enumerate(_records(todo, work, workers or cores(), scheduler), before + 1):
        manifest.add(record)
        show_progress(progress, done, len(tasks))
    earlier = [name for name, record in manifest.records.items() if not (record.error and is_folder(Path(name)))]
    manifest.rewrite(dict.fromkeys([*(str(task.photo) for task in tasks), *earlier]))
    return manifest


def network_and_prior(options: EstimateOptions) -> tuple[ResponseNetwork, Prior]:
    """Return the network, loaded once in a process, and the prior, whose file may change while a worker lives."""
    return _network(options), load_prior(options)


def _check_owners(tasks: Sequence[Task], manifest: Manifest) -> None:
    """Refuse to take the files of another photograph, which an earlier run has written, for those of a task."""
    written = [(record.folder, Path(name)) for name, record in manifest.records.items() if not record.error]
    owners = {(folder, plain_stem(photo).casefold()): photo for folder, photo in written}
    for task in tasks:
        owner = owners.get((task.folder.as_posix(), plain_stem(task.photo).casefold()), task.photo)
        is_other = owner.absolute() != task.photo.absolute() and not fault(task.photo)
        if is_other and any(path.exists() for path in task.targets):
            raise PlateError(
                f"{task.targets[0]}: belongs to {owner}; choose another folder for {task.photo}, or add --overwrite"
            )


@lru_cache(maxsize=1)
def _network(options: EstimateOptions) -> ResponseNetwork:
    """Return the network."""
    return load_network(options)


def _records(
    tasks: Sequence[AnyTask], work: Callable[[AnyTask], PhotographRecord], workers: int, scheduler: str | None
) -> Iterator[PhotographRecord]:
    """Yield the records of photographs as they are done."""
    if not tasks:
        return
    workers = min(workers, len(tasks))
    if (workers > 1 or scheduler) and not tasks[0].options.threads:
        single = replace(tasks[0].options, threads=1)
        tasks = [replace(task, options=single) for task in tasks]
    with worker_pool(workers, scheduler=scheduler) as pool:
        futures = [pool.submit(_recorded, work, task) for task in tasks]
        try:
            for future in as_completed(futures):
                yield future.result()
        except BrokenExecutor as problem:
            raise CRFNetError("a process died, perhaps for lack of memory; run the same command again") from problem


def _recorded(work: Callable[[AnyTask], PhotographRecord], task: AnyTask) -> PhotographRecord:
    """Return the record of a task; what goes wrong stands in it."""
    try:
        if problem := fault(task.photo):
            raise PhotoError(f"{task.photo}: {problem}")
        return work(task)
    except (CRFNetError, OSError, MemoryError) as failure:
        return PhotographRecord(photograph=str(task.photo), error=one_line(failure) or "not enough memory")


def _is_done(task: Task, manifest: Manifest) -> bool:
    """Return whether the manifest has a photograph without an error whose files are still there."""
    record = manifest.records.get(str(task.photo))
    return record is not None and not record.error and all(path.exists() for path in task.targets)
