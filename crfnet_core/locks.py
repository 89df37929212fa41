"""Locks of open files between processes; the system lifts them when the file is closed, or a process dies."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from typing import IO, Any

_LOCKED_BYTE = 1 << 30  # Windows locks bytes, which nobody else can then read: this one lies far behind the end


def lock(file: IO[Any], *, wait: bool = True) -> None:
    """Lock a file; if `wait` is False, raise an OSError if another process has the lock, or there are no locks."""
    if sys.platform == "win32":
        import msvcrt

        file.seek(_LOCKED_BYTE)
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        with suppress(OSError) if wait else nullcontext():  # of a file system without locks
            fcntl.flock(file, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def locked_folder(folder: Path) -> Iterator[None]:
    """Let no other process into such a block of a folder meanwhile; Windows and some file systems lock no folders."""
    number = -1
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)  # fails on Windows
        import fcntl

        fcntl.flock(number, fcntl.LOCK_EX)
    try:
        yield
    finally:
        with suppress(OSError):  # nothing was written by it
            os.close(number)
