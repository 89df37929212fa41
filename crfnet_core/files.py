"""Read a file of bounded size; write a file whole or not at all; write a document as text."""

import errno
import hashlib
import json
import math
import os
import re
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError
from crfnet_core.staging import OPEN_SETS, staged_files

MAX_JSON_SIZE = 16 * 2**20  # size in bytes of the largest JSON file that is read
LONGEST_NAME = 255  # bytes that file systems take for a file's name


def read_bytes(path: Path, *, most: int) -> bytes:
    """Return the content of a regular file of at most `most` bytes.

    Pipes and devices, which may have no end, are not opened. Raise OSError if the file cannot be read, is not a regular
    file, or is larger.
    """
    if not stat.S_ISREG(path.stat().st_mode):
        raise OSError(errno.EINVAL, "it is not a regular file", str(path))
    with path.open("rb") as file:
        content = file.read(most + 1)
    if len(content) > most:
        raise OSError(errno.EFBIG, f"it has more than {most // 2**20} MiB", str(path))
    return content


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def read_json(path: Path) -> Any:
    """Return the content of a JSON file of at most `MAX_JSON_SIZE` bytes; raise as `read_bytes` and `parse_json`."""
    return parse_json(read_bytes(path, most=MAX_JSON_SIZE))


def parse_json(text: bytes) -> Any:
    """Return the content of a JSON text; its numbers are finite, but integers may be too large for a float.

    Raise ValueError if it is not JSON, holds NaN or an infinity, or is nested too deeply.
    """
    try:
        return json.loads(text, parse_constant=_finite, parse_float=_finite)
    except RecursionError:
        raise ValueError("is nested too deeply") from None


def check_target(path: str | Path, *, overwrite: bool = False, error: type[CRFNetError] = CRFNetError) -> Path:
    """Return `path` as a Path after checking that a file may be written there.

    Raise `error` if the folder is absent or read-only, or the file exists and `overwrite` is False.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise error("folder_absent", path=path, folder=path.parent)
    if not os.access(path.parent, os.W_OK):
        raise error("folder_read_only", path=path, folder=path.parent)
    if path.is_dir():
        raise error("is_folder", path=path)
    if os.path.lexists(path) and not overwrite:
        raise error("exists", path=path)
    return path


@contextmanager
def atomic_write(
    path: str | Path, *, overwrite: bool = False, error: type[CRFNetError] = CRFNetError
) -> Iterator[Path]:
    """Yield an empty temporary file of the same name that takes its place only if the block succeeds.

    It lies in a new folder of `staged_files`; if `path` lies in an open one, it is written there, and gets its name
    with the others. Raise `error` as `check_target` does, or when the disk refuses the file.
    """
    try:
        path = check_target(path, overwrite=overwrite, error=error)
        staged = staged_files(path.parent, overwrite=overwrite, error=error)
        with nullcontext(path.parent) if path.parent in OPEN_SETS else staged as folder:
            temporary = folder / path.name
            try:
                temporary.touch()
                yield temporary
            except BaseException:  # of a set that may go on without it
                temporary.unlink(missing_ok=True)
                raise
    except OSError as problem:
        raise error("not_written", path=path, reason=problem.strerror or problem) from problem


def atomic_write_text(
    path: str | Path, text: str, *, overwrite: bool = False, error: type[CRFNetError] = CRFNetError
) -> None:
    """Write `text` as UTF-8, its line ends as they are; options and errors as for `atomic_write`."""
    with atomic_write(path, overwrite=overwrite, error=error) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def escaped_name(path: str | Path) -> str:
    """Return a path as text that every program reads; bytes that are not UTF-8 become escapes of six characters."""
    return str(path).encode(errors="backslashreplace").decode()


def check_utf8(path: Path, error: type[CRFNetError]) -> None:
    """Raise `error` unless a path in full, with the current folder, is UTF-8, as OpenColorIO needs it."""
    if (name := escaped_name(path.absolute())) != str(path.absolute()):
        raise error("name_not_utf8", path=name)


def cut_to_bytes(name: str, most: int) -> str:
    """Return a file's name cut to at most `most` bytes, between two characters; other bytes are left out."""
    return name.encode(errors="ignore")[: max(most, 0)].decode(errors="ignore")


def json_text(document: Mapping[str, Any], *, ensure_ascii: bool = False) -> str:
    """Return a document as JSON text, each row of numbers on one line; `ensure_ascii` escapes other characters."""
    text = json.dumps(document, indent=1, ensure_ascii=ensure_ascii)
    return re.sub(r"\[\n[-+\d.eE,\s]+\]", lambda row: " ".join(row[0].split()), text) + "\n"


def _finite(text: str) -> float:
    """Return the number in a text; refuse NaN and infinities, which Python takes for numbers and JSON does not."""
    if not math.isfinite(number := float(text)):
        raise ValueError(f"{text} is not a number of JSON")
    return number
