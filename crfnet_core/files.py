"""Write a file whole or not at all; a document as text."""

from __future__ import annotations

import json
import os
import re
import tempfile
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError

_UMASK_LOCK = threading.Lock()


def check_target(path: str | Path, *, overwrite: bool = False, error: type[CRFNetError] = CRFNetError) -> Path:
    """Return `path` as a Path after checking that a file may be written there.

    Parameters
    ----------
    path : str or Path
        The file to be written.
    overwrite : bool
        Whether an existing file may be replaced.
    error : type of CRFNetError
        The error to raise.

    Raises
    ------
    CRFNetError
        As `error`, if the folder is absent or read-only, or the file exists and may not be replaced.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise error(f"{path}: the folder {path.parent} does not exist; create it first")
    if not os.access(path.parent, os.W_OK):
        raise error(f"{path}: the folder {path.parent} is not writable; choose another")
    if path.is_dir():
        raise error(f"{path}: is a folder; give the name of a file")
    if os.path.lexists(path) and not overwrite:
        raise error(f"{path}: exists already; choose another name or ask to overwrite it")
    return path


@contextmanager
def atomic_write(
    path: str | Path, *, overwrite: bool = False, error: type[CRFNetError] = CRFNetError
) -> Iterator[Path]:
    """Yield a temporary file beside `path` that takes its name only if the block succeeds.

    Parameters
    ----------
    path : str or Path
        The file to be written.
    overwrite : bool
        Whether an existing file may be replaced.
    error : type of CRFNetError
        The error to raise.

    Yields
    ------
    Path
        An empty file in the same folder and with the same suffix, to be filled by the caller.

    Raises
    ------
    CRFNetError
        As `check_target`, or when the disk refuses the file.
    """
    path = check_target(path, overwrite=overwrite, error=error)
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}.", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OSError as problem:
        raise error(f"{path}: cannot be written ({problem.strerror or problem})") from problem
    finally:
        temporary.unlink(missing_ok=True)


def atomic_write_text(
    path: str | Path, text: str, *, overwrite: bool = False, error: type[CRFNetError] = CRFNetError
) -> None:
    """Write `text` as UTF-8, its line ends as they are; options and errors are those of `atomic_write`."""
    with atomic_write(path, overwrite=overwrite, error=error) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document as JSON text, with all characters as they are and each row of numbers on one line."""
    text = json.dumps(document, indent=1, ensure_ascii=False)
    return re.sub(r"\[\n[-+\d.eE,\s]+\]", lambda row: " ".join(row[0].split()), text) + "\n"


def _umask() -> int:
    """Return the process's file mode creation mask; it can only be read by setting it, so one thread at a time."""
    with _UMASK_LOCK:
        mask = os.umask(0)
        os.umask(mask)
    return mask
