"""Jobs in several threads, of which only as many as run are taken from their source: memory stays bounded."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import TypeVar

Name = TypeVar("Name")


def finished(
    jobs: Iterable[tuple[Name, Callable[[], None]]], workers: int, *, waiting: int = 2
) -> Generator[tuple[Name, Future[None]]]:
    """Yield named jobs as they finish, in threads.

    Jobs are taken in this thread, one at a time, while fewer than `workers` run and `waiting` wait, so that no thread
    waits for the next one. Close the iterator to end early: jobs that have begun are finished, the others dropped.
    """
    pool = ThreadPoolExecutor(workers, thread_name_prefix="plate")
    running: dict[Future[None], Name] = {}
    try:
        for name, job in jobs:
            running[pool.submit(job)] = name
            if len(running) >= workers + waiting:
                yield from _ended(running)
        while running:
            yield from _ended(running)
    finally:
        pool.shutdown(cancel_futures=True)


def _ended(running: dict[Future[None], Name]) -> Iterator[tuple[Name, Future[None]]]:
    """Wait until a job ends; yield it, and others that have ended, in the order of their beginning."""
    done = wait(running, return_when=FIRST_COMPLETED).done
    for future in [future for future in running if future in done]:
        yield running.pop(future), future
