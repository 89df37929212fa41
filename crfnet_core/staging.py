"""A set of files that appears whole or not at all: every output of this project is written here.

The files are written in a temporary folder next to their places, which only the user may enter. Their contents are on
the disk before their names are. The folder holds a locked file, so others can see whether its process still lives.
"""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

from crfnet_core.errors import CRFNetError
from crfnet_core.locks import lock

#: How the names of temporary folders begin.
_PREFIX = ".crfnet-"

#: In a temporary folder: the file that is locked, and the folder for the files that the new ones replace.
_LOCK, _EARLIER = ".lock", ".earlier"


@contextmanager
def staged_files(folder: Path, *, overwrite: bool = True, error: type[CRFNetError] = CRFNetError) -> Iterator[Path]:
    """Yield a temporary folder in `folder`; if the block succeeds, its files take their names in `folder` together.

    Check before whether files of these names may be replaced. If the block fails, or one of the names cannot be taken
    (a file that is locked, a full disk, an interruption), `folder` is as it was. What killed runs left there is
    completed and removed: see `remove_abandoned`.

    Parameters
    ----------
    folder : Path
        The folder of the files; it must exist.
    overwrite : bool
        Whether files of these names are replaced; if not, files that another process has written meanwhile stay.
    error : type of CRFNetError
        The error to raise.

    Raises
    ------
    CRFNetError
        As `error`, if a file cannot take its name. Errors of the block name the files as they will be called.
    """
    remove_abandoned(folder.absolute())
    temporary, locked = _new_folder(folder)
    try:
        yield temporary
        _publish(temporary, folder, overwrite=overwrite, error=error)
    except CRFNetError as problem:
        problem.facts = {name: _renamed(fact, temporary, folder) for name, fact in problem.facts.items()}
        raise
    finally:
        _put_back(temporary, folder)
        with suppress(OSError):
            locked.close()
        with suppress(OSError):
            shutil.rmtree(temporary, ignore_errors=True)


@lru_cache(maxsize=256)
def remove_abandoned(folder: Path) -> None:
    """Remove the temporary folders of killed runs; each process looks once.

    A set that has some of its names gets the others where they are free; so do earlier files that were moved away.
    """
    for temporary in folder.glob(f"{_PREFIX}*"):
        with suppress(OSError):
            with (temporary / _LOCK).open("ab") as file:
                lock(file, wait=False)  # fails while the process lives, and where the file system has no locks
                if not _is_there(file, temporary):
                    continue
                if (temporary / _EARLIER).exists():  # all of the set is on the disk
                    _name_the_rest(temporary, folder)
                _put_back(temporary, folder)
                is_empty = not _earlier_files(temporary)
                if is_empty:  # before the lock ends, so that nobody takes up a folder that is about to go
                    shutil.rmtree(temporary, ignore_errors=True)
            if is_empty and os.name == "nt":  # which removes no open file
                shutil.rmtree(temporary, ignore_errors=True)


def _new_folder(folder: Path) -> tuple[Path, IO[Any]]:
    """Return a new temporary folder and the locked file in it."""
    while True:
        temporary = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder))  # with mode 0700
        with suppress(FileNotFoundError):  # another process took the folder for an abandoned one, and removed it
            file = (temporary / _LOCK).open("wb")
            if _has_lock(file) and _is_there(file, temporary):
                return temporary, file
            file.close()


def _has_lock(file: IO[Any]) -> bool:
    """Lock a new file, and return whether its folder is ours: False if another process is about to remove it."""
    try:
        lock(file, wait=False)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:  # a file system without locks: nobody will take the folder for abandoned
        return True
    return True


def _is_there(file: IO[Any], temporary: Path) -> bool:
    """Return whether an open file is still the lock of a temporary folder: another process may have removed both."""
    with suppress(OSError):
        return os.path.samestat(os.fstat(file.fileno()), (temporary / _LOCK).stat())
    return False


def _renamed(fact: object, temporary: Path, folder: Path) -> object:
    """Return a fact that names files in `folder` in the place of those in the temporary one."""
    if isinstance(fact, CRFNetError):
        fact.facts = {name: _renamed(inner, temporary, folder) for name, inner in fact.facts.items()}
    elif isinstance(fact, Path | str):
        return type(fact)(str(fact).replace(str(temporary), str(folder)))
    return fact


def _publish(temporary: Path, folder: Path, *, overwrite: bool, error: type[CRFNetError]) -> None:
    """Move the files of one folder into another, or none of them; earlier files of these names move into `_EARLIER`."""
    files = _staged(temporary)
    there = [path.name for path in files if os.path.lexists(folder / path.name)]
    if there and not overwrite:
        raise error("written_meanwhile", path=folder / there[0])
    earlier, target = temporary / _EARLIER, folder
    try:
        for path in files:
            target = folder / path.name
            _flush(path)
        _flush_folder(temporary)
        earlier.mkdir()
        for path in files:
            target = folder / path.name
            if files[1:] and path.name in there:  # a single file is replaced in one step
                target.replace(earlier / path.name)
            path.replace(target)
        _flush_folder(folder)
    except BaseException as problem:
        for path in files:
            _take_back(path, folder / path.name, earlier / path.name, was_there=path.name in there)
        if not isinstance(problem, OSError):
            raise
        raise error("not_written", path=target, reason=problem.strerror or problem) from problem


def _name_the_rest(temporary: Path, folder: Path) -> None:
    """Move the files of one folder into another where their names are free."""
    for path in _staged(temporary):
        if not os.path.lexists(folder / path.name):
            path.replace(folder / path.name)


def _staged(temporary: Path) -> list[Path]:
    """Return the files of a set that are in its temporary folder."""
    return sorted(path for path in temporary.iterdir() if path.name not in (_LOCK, _EARLIER))


def _flush(path: Path) -> None:
    """See that the content of a file is on the disk."""
    descriptor = os.open(path, os.O_RDWR)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _flush_folder(folder: Path) -> None:
    """See that the names in a folder are on the disk; some network file systems cannot, and Windows does by itself."""
    if os.name == "nt":
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as problem:
        if problem.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def _take_back(path: Path, target: Path, earlier: Path, *, was_there: bool) -> None:
    """Put the earlier file back into its place, or remove the new one if it was moved there and there was none."""
    with suppress(OSError):
        if os.path.lexists(earlier):
            earlier.replace(target)
        elif not was_there and not os.path.lexists(path):
            target.unlink(missing_ok=True)


def _put_back(temporary: Path, folder: Path) -> None:
    """Move the earlier files in a temporary folder back where their names are free, and remove the others."""
    for path in _earlier_files(temporary):
        with suppress(OSError):
            if os.path.lexists(folder / path.name):
                path.unlink()
            else:
                path.replace(folder / path.name)


def _earlier_files(temporary: Path) -> list[Path]:
    """Return the earlier files in a temporary folder."""
    return list((temporary / _EARLIER).glob("*"))
