"""A set of files that appears whole or not at all: every output of this project is written here.

The files are written in a temporary folder next to their places, which only the user may enter. Their contents are on
the disk before their names are. The folder holds a locked file, so others can see whether its process still lives.
"""

import errno
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from typing import IO, Any

from crfnet_core.errors import CRFNetError
from crfnet_core.locks import lock

_PREFIX = ".crfnet-"  # how the names of temporary folders begin, and of what is in them besides the set

#: In a temporary folder: the file that is locked; and, as soon as the set is on the disk, the folder for the files that
#: it replaces, whose name ends with the number of files in the set.
_LOCK, _EARLIER = f"{_PREFIX}lock", f"{_PREFIX}earlier-"

#: The temporary folders that are open in this process: a file in one of them gets its name with the set.
OPEN_SETS: set[Path] = set()


@contextmanager
def staged_files(folder: Path, *, overwrite: bool = True, error: type[CRFNetError] = CRFNetError) -> Iterator[Path]:
    """Yield a temporary folder in `folder`; if the block succeeds, its files take their names in `folder` together.

    The folder must exist. If the block fails, or a name cannot be taken, it is as it was, and what killed runs left in
    it is gone. `overwrite` replaces files; without it, files that another process has written meanwhile stay. Raise
    `error` if a name cannot be taken; errors of the block name the files as they will be called.
    """
    remove_abandoned(folder.absolute())
    temporary, locked = _new_folder(folder)
    OPEN_SETS.add(temporary)
    try:
        yield temporary
        if not _is_there(locked, temporary):  # in a folder that others may write to, they can put another in its place
            raise error("not_written", path=folder, reason="another process has removed a temporary folder in it")
        _publish(temporary, folder, overwrite=overwrite, error=error)
    except CRFNetError as problem:
        problem.facts = {name: _renamed(fact, temporary, folder) for name, fact in problem.facts.items()}
        raise
    finally:
        OPEN_SETS.remove(temporary)
        is_there = _is_there(locked, temporary)
        if is_there:
            _remove(temporary, folder)
        with suppress(OSError):
            locked.close()
        if is_there and os.name == "nt":  # which removes no open file
            _remove(temporary, folder)


@lru_cache(maxsize=256)
def remove_abandoned(folder: Path) -> None:
    """Remove the temporary folders of killed runs; each process looks once.

    A set that has some of its names gets the others where they are free; so do earlier files that were moved away.
    """
    for temporary in folder.glob(f"{_PREFIX}*"):
        with suppress(OSError, ValueError):
            if not is_own_folder(temporary):
                continue
            if not (temporary / _LOCK).exists():
                temporary.rmdir()  # of a run killed before it locked a file; with content, it is somebody else's
                continue
            with (temporary / _LOCK).open("rb+") as file:
                lock(file, wait=False)  # fails while the process lives, and where the file system has no locks
                if not _is_there(file, temporary):
                    continue
                _name_the_rest(temporary, folder)
                _remove(temporary, folder)  # before the lock ends, so that nobody takes up a folder that is about to go
            if os.name == "nt":  # which removes no open file
                _remove(temporary, folder)


def is_own_folder(path: Path) -> bool:
    """Return whether a path is a folder of this user, and not a link, or one that somebody else has put there."""
    state = path.lstat()
    return stat.S_ISDIR(state.st_mode) and (os.name == "nt" or state.st_uid == os.geteuid())


def _new_folder(folder: Path) -> tuple[Path, IO[Any]]:
    """Return a new temporary folder and the locked file in it."""
    while True:
        temporary = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder))  # with mode 0700
        try:
            file = (temporary / _LOCK).open("wb")
        except FileNotFoundError:  # another process took the folder for an abandoned one, and removed it
            continue
        except OSError:
            temporary.rmdir()
            raise
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
    if reserved := {path.name for path in temporary.glob(f"{_PREFIX}*")} - {_LOCK}:
        raise error("name_reserved", path=folder / min(reserved), prefix=_PREFIX)
    there = [path.name for path in files if os.path.lexists(folder / path.name)]
    if there and not overwrite:
        raise error("written_meanwhile", path=folder / there[0])
    earlier, target = temporary / f"{_EARLIER}{len(files)}", folder
    try:
        for path in files:
            target = folder / path.name
            _flush(path)
        earlier.mkdir()
        _flush(temporary)
        for path in files:
            target = folder / path.name
            if files[1:] and path.name in there:  # a single file is replaced in one step
                target.replace(earlier / path.name)
            _move(path, target, overwrite=overwrite)
        _flush(folder)
    except BaseException as problem:
        for path in files:  # the new ones go; `_remove` puts the earlier ones back
            if _has_name(path, folder) and (path.name not in there or os.path.lexists(earlier / path.name)):
                with suppress(OSError):
                    (folder / path.name).unlink()
        if not isinstance(problem, OSError):
            raise
        if isinstance(problem, FileExistsError) and not overwrite:
            raise error("written_meanwhile", path=target) from problem
        raise error("not_written", path=target, reason=problem.strerror or problem) from problem


def _move(path: Path, target: Path, *, overwrite: bool) -> None:
    """Give a file its name; without `overwrite` raise FileExistsError if another process has the name by now."""
    if not overwrite:
        try:
            os.link(path, target)  # unlike a rename, it never replaces a file
        except FileExistsError:
            raise
        except OSError:  # a file system without hard links
            pass
        else:
            path.unlink()
            return
    path.replace(target)


def _has_name(path: Path, folder: Path) -> bool:
    """Return whether a file of the set has its name in `folder`."""
    target = folder / path.name
    return not os.path.lexists(path) or (os.path.lexists(target) and path.samefile(target))


def _name_the_rest(temporary: Path, folder: Path) -> None:
    """Give the files of a set of which some have their names the others, where they are free."""
    files = [path for path in _staged(temporary) if not _has_name(path, folder)]
    if any(len(files) < int(earlier.name.removeprefix(_EARLIER)) for earlier in _earlier(temporary)):
        for path in files:
            if not os.path.lexists(folder / path.name):
                path.replace(folder / path.name)


def _earlier(temporary: Path) -> list[Path]:
    """Return the folders of replaced files; a link may have come with a folder that somebody has unpacked."""
    return [path for path in temporary.glob(f"{_EARLIER}*") if is_own_folder(path)]


def _staged(temporary: Path) -> list[Path]:
    """Return the files of a set that are in its temporary folder."""
    return sorted(path for path in temporary.iterdir() if not path.name.startswith(_PREFIX))


def _flush(path: Path) -> None:
    """See that the content of a file, or the names in a folder, are on the disk.

    Some network file systems cannot flush a folder, and Windows does it by itself.
    """
    is_folder = path.is_dir()
    if is_folder and os.name == "nt":
        return
    descriptor = os.open(path, os.O_RDONLY if is_folder else os.O_RDWR)
    try:
        os.fsync(descriptor)
    except OSError as problem:
        if not is_folder or problem.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(descriptor)


def _remove(temporary: Path, folder: Path) -> None:
    """Remove a temporary folder after its earlier files have gone back where their names are free, or it stays.

    The folders of earlier files, which make a set one to complete, go first, and the lock goes last: a folder without
    it is not known to be ours.
    """
    with suppress(OSError):  # of a run that removes it, too, or of an earlier file that cannot go back
        for earlier in _earlier(temporary):
            for path in earlier.iterdir():
                with suppress(OSError):
                    if os.path.lexists(folder / path.name):
                        path.unlink()
                    else:
                        path.replace(folder / path.name)
            earlier.rmdir()
        for path in _staged(temporary):
            path.unlink()
        shutil.rmtree(temporary)
