"""A set of files that appears whole or not at all."""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from crfnet_core.errors import CRFNetError

from .errors import PlateError

#: Age in seconds from which a temporary folder or file counts as left behind by a killed run.
STALE_SECONDS = 600

#: How the names of temporary folders begin.
_PREFIX = ".crfnet-"

#: The folder in a temporary one for the files that its own replace.
_EARLIER = "earlier"


@contextmanager
def staged_files(folder: Path, *, overwrite: bool = True) -> Iterator[Path]:
    """Yield a temporary folder in `folder`; if the block succeeds, its files take their names in `folder` together.

    Check before whether files of these names may be replaced. If the block fails, or one of the names cannot be taken
    (a file that is locked, a full disk, an interruption), `folder` is as it was. Temporary folders that a killed run
    left there are removed once they are `STALE_SECONDS` old; earlier files in them go back where their names are free.

    Parameters
    ----------
    folder : Path
        The folder of the files; it must exist.
    overwrite : bool
        Whether files of these names are replaced; if not, those that another process has written meanwhile are kept.

    Raises
    ------
    PlateError
        If a file cannot take its name. Errors of the block name the files as they will be called.
    """
    _remove_stale(folder)
    temporary = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder))
    try:
        yield temporary
        _publish(temporary, folder, overwrite=overwrite)
    except CRFNetError as problem:
        raise _renamed(problem, temporary, folder) from problem
    finally:
        _remove(temporary, folder)


def _renamed(problem: CRFNetError, temporary: Path, folder: Path) -> CRFNetError:
    """Return an error that names files in `folder` in the place of those in the temporary one."""

    def rename(fact: object) -> object:
        return fact if isinstance(fact, int | float) else str(fact).replace(str(temporary), str(folder))

    return type(problem)(str(rename(problem.code)), **{name: rename(fact) for name, fact in problem.facts.items()})


def _publish(temporary: Path, folder: Path, *, overwrite: bool) -> None:
    """Move the files of one folder into another, or none of them; earlier files of these names move into `_EARLIER`."""
    files = sorted(path for path in temporary.iterdir())
    if not overwrite and (there := [path.name for path in files if os.path.lexists(folder / path.name)]):
        raise PlateError("written_meanwhile", path=folder / there[0])
    earlier = temporary / _EARLIER
    earlier.mkdir()
    target = folder
    try:
        for path in files:
            target = folder / path.name
            if os.path.lexists(target):
                target.rename(earlier / path.name)
            path.rename(target)
    except BaseException as problem:
        for path in files:
            _take_back(path, folder / path.name, earlier / path.name)
        if not isinstance(problem, OSError):
            raise
        raise PlateError("file_not_written", path=target, reason=problem.strerror or problem) from problem


def _take_back(path: Path, target: Path, earlier: Path) -> None:
    """Put the earlier file back into its place, or remove the new one if it was moved there and there was none."""
    with suppress(OSError):
        if os.path.lexists(earlier):
            earlier.replace(target)
        elif not os.path.lexists(path):
            target.unlink(missing_ok=True)


def _remove_stale(folder: Path) -> None:
    """Remove the temporary folders of killed runs; a recent one may belong to a running process."""
    for path in folder.glob(f"{_PREFIX}*"):
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > STALE_SECONDS:
                _remove(path, folder)


def _remove(temporary: Path, folder: Path) -> None:
    """Remove a temporary folder, unless an earlier file in it whose name is free cannot go back."""
    earlier = temporary / _EARLIER
    with suppress(OSError):
        for path in earlier.iterdir() if earlier.is_dir() else ():
            if not os.path.lexists(folder / path.name):
                path.rename(folder / path.name)
        shutil.rmtree(temporary, ignore_errors=True)
