"""The photographs of a batch: found in folders, each once."""

import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from crfnet_core.files import file_sha256, read_json
from crfnet_core.photograph.image_io import PHOTOGRAPH_SUFFIXES
from crfnet_core.types import checked_option

from ..errors import PlateError
from ..messages import NOT_TEXT
from ..output_files import SHEET_ENDING

#: Whether a path leads to a folder; False if that cannot be seen, where `Path.is_dir` raises an error.
is_folder = os.path.isdir


def find_photographs(names: Sequence[Path], out: Path) -> dict[Path, Path]:
    """Return photographs, and where their files go, relative to the output folder `out`.

    Folders among `names` are searched with all their subfolders, which the output has, too; left out are hidden names,
    the output folder, and sheets. A subfolder that cannot be read stands among the photographs, so that it gets a
    record. Raise PlateError if a folder holds no photograph or cannot be read.
    """
    photographs: dict[Path, Path] = {}
    for name in named_paths(names):
        if not is_folder(name):
            photographs[name] = Path()
            continue
        paths = _photographs_below(name, os.path.realpath(out))
        if not paths:
            raise PlateError("empty_folder", path=name, suffixes=", ".join(PHOTOGRAPH_SUFFIXES))
        photographs |= {path: path.parent.relative_to(name) for path in paths}
    return {photo: photographs[photo] for photo in unique(photographs)}


def named_paths(names: Sequence[Path] | Path) -> tuple[Path, ...]:
    """Return names as paths, also one by itself; raise CRFNetError for other kinds."""
    several = [names] if isinstance(names, str | os.PathLike) else names
    return tuple(checked_option("names", several, tuple[Path, ...]))


def unique(photographs: Iterable[Path]) -> list[Path]:
    """Return photographs without repetitions, perhaps by another way to their folder."""
    first: dict[Path, Path] = {}
    for photo in photographs:
        first.setdefault(real_place(photo), photo)
    return list(first.values())


def real_place(photo: Path) -> Path:
    """Return the absolute path of a photograph, whose folder may be reached by links; a link to a file stays one."""
    return Path(os.path.realpath(photo.parent), photo.name)


def file_state(photo: Path) -> str:
    """Return the size and the time of change of a photograph, which spare reading it; empty if it is not found."""
    with suppress(OSError):
        state = photo.stat()
        return f"{state.st_size} {state.st_mtime_ns}"
    return ""


def content_digest(photo: Path) -> str:
    """Return the SHA-256 of a photograph; an empty text if it cannot be read, which its reader explains."""
    with suppress(OSError):
        return file_sha256(photo) if photo.is_file() else ""
    return ""


def unreadable_reason(photo: Path) -> str:
    """Return why a photograph, or a folder in its place, is refused before it is opened; an empty text if it is not."""
    try:
        str(photo).encode()
        if not os.path.lexists(photo):
            return "does not exist; check the name"
        if photo.is_dir():
            os.scandir(photo).close()
        elif photo.exists() and not photo.is_file():
            return "is a pipe or a device; give a file"
    except UnicodeEncodeError:
        return f"the name {NOT_TEXT}"
    except OSError as problem:
        return f"cannot be read ({problem.strerror}); check its permissions"
    return ""


def _photographs_below(folder: Path, out: str) -> list[Path]:
    """Return the photographs in a folder and its subfolders, sorted, and then the subfolders that cannot be read."""
    photographs: list[Path] = []
    failures: list[OSError] = []
    for name, subfolders, files in os.walk(folder, onerror=failures.append):
        subfolders[:] = [sub for sub in subfolders if sub[0] != "." and os.path.realpath(Path(name, sub)) != out]
        paths = [Path(name, file) for file in files if not file.startswith(".")]
        photographs += [path for path in paths if path.suffix.lower() in PHOTOGRAPH_SUFFIXES and not _is_sheet(path)]
    unread = sorted(Path(failure.filename) for failure in failures)
    if folder in unread:
        raise PlateError("unreadable", path=folder, reason=unreadable_reason(folder))
    return [*sorted(photographs), *unread]


def _is_sheet(path: Path) -> bool:
    """Return whether a picture is the sheet of an estimate or a calibration, by the JSON document beside it."""
    if not path.name.endswith(SHEET_ENDING):
        return False
    try:
        document = read_json(path.with_name(path.name.removesuffix(SHEET_ENDING) + ".json"))
        return bool(document["files"]["sheet"] == path.name)
    except (OSError, ValueError, KeyError, TypeError):
        return False
