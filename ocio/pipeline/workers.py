"""Where many photographs are worked on: processes of this machine, or a Dask cluster."""

import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import connection, get_context, parent_process

from ..errors import PlateError

#: Seconds to wait for the answer of a scheduler.
SCHEDULER_TIMEOUT = 10


@contextmanager
def worker_pool(workers: int, *, scheduler: str | None = None) -> Iterator[Executor]:
    """Yield an executor; at the end of the block, what has not begun is dropped and what has begun is finished.

    `workers` are processes of this machine; one works in this process. `scheduler` is the address of a Dask scheduler,
    such as "tcp://10.0.0.1:8786". Raise PlateError if Dask is not installed, or no scheduler answers.
    """
    if scheduler is not None:
        with _dask_pool(scheduler) as cluster:
            yield cluster
        return
    pool: Executor = ThreadPoolExecutor(1)
    if workers > 1:  # processes that start afresh, because onnxruntime's threads do not survive a fork
        with suppress(OSError, NotImplementedError):  # of a system without shared memory (/dev/shm): one by one
            pool = ProcessPoolExecutor(workers, get_context("spawn"), initializer=_follow_the_parent)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _follow_the_parent() -> None:
    """Ignore Control-C, which a terminal sends to every process: the parent decides what ends; and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_parent, daemon=True).start()


def _end_with_the_parent() -> None:
    """Wait for the end of the parent, which may be killed, and end this process."""
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(1)


@contextmanager
def _dask_pool(address: str) -> Iterator[Executor]:
    """Yield the executor of a Dask cluster; Dask's own settings hold the certificates of an encrypted one."""
    import asyncio  # only here, since it takes 20 ms

    try:
        from distributed import Client
    except ImportError as problem:
        raise PlateError("no_dask") from problem
    try:
        asyncio.run(asyncio.wait_for(_answer(address), SCHEDULER_TIMEOUT))
        client = Client(address, timeout=SCHEDULER_TIMEOUT)
    except (OSError, ValueError, TypeError, RuntimeError) as problem:  # TypeError: no certificates for tls://
        raise PlateError("no_scheduler", address=address, reason=str(problem) or "no answer") from problem
    with client, client.get_executor(pure=False) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False)
            client.close()
            raise


async def _answer(address: str) -> None:
    """Ask a scheduler who it is: `Client` would wait for ever for a server that never says anything."""
    from distributed import rpc
    from distributed.security import Security

    async with rpc(address, connection_args=Security().get_connection_args("client")) as scheduler:
        await scheduler.identity()
