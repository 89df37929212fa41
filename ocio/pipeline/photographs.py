"""The photographs of a batch: found in folders, each once."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from crfnet_core.files import read_json
from crfnet_core.photograph.image_io import PHOTOGRAPH_SUFFIXES

from ..errors import PlateError
from ..output_files import SHEET_ENDING


def find_photographs(names: Sequence[Path]) -> dict[Path, Path]:
    """Return photographs, and where their files go, relative to the output folder.

    Parameters
    ----------
    names : sequence of Path
        Files, and folders that are searched with all their subfolders for `PHOTOGRAPH_SUFFIXES`, except names that
        begin with a dot and the sheets of earlier runs. What belongs to a photograph in a subfolder goes into a
        subfolder of the same name. A subfolder that cannot be read stands among the photographs:
        `run_tasks` records why.

    Raises
    ------
    PlateError
        If a folder holds no photograph or cannot be read.
    """
    photographs: dict[Path, Path] = {}
    for name in names:
        if not is_folder(name):
            photographs[name] = Path()
            continue
        paths = _photographs_below(name)
        if not paths:
            raise PlateError("empty_folder", path=name, suffixes=", ".join(PHOTOGRAPH_SUFFIXES))
        photographs |= {path: path.parent.relative_to(name) for path in paths}
    return {photo: photographs[photo] for photo in unique(photographs)}


def unique(photographs: Iterable[Path]) -> list[Path]:
    """Return photographs without those that are given again, perhaps by another way to their folder."""
    first: dict[str, Path] = {}
    for photo in photographs:
        first.setdefault(os.path.normpath(photo.absolute()), photo)
    return list(first.values())


def without_outputs(photographs: Mapping[Path, Path], out: Path) -> dict[Path, Path]:
    """Return the photographs of `find_photographs` except those that a search has found in the output folder.

    Those of a search that began in the output folder or below it stay: the photographs lie there.

    Raises
    ------
    PlateError
        If there are no others.
    """
    output = os.path.realpath(out)

    @lru_cache(maxsize=1000)
    def is_within(folder: Path) -> bool:
        return Path(os.path.realpath(folder)).is_relative_to(output)

    def is_output(photo: Path, folder: Path) -> bool:
        return is_within(photo.parent) and not is_within(photo.parents[len(folder.parts)])

    others = {photo: folder for photo, folder in photographs.items() if not is_output(photo, folder)}
    if not others:
        raise PlateError("all_in_output", path=out)
    return others


def check_distinct(targets: Iterable[tuple[Path, Path]]) -> None:
    """Check that no two photographs are written to one file, on systems that take `A` and `a` for one name, too.

    Parameters
    ----------
    targets : iterable of (Path, Path)
        Files to be written, each with its photograph.

    Raises
    ------
    PlateError
        With the names of the first two photographs.
    """
    sources: dict[str, tuple[Path, Path]] = {}
    for target, photo in targets:
        first, other = sources.setdefault(str(target).casefold(), (target, photo))
        if first == target and other != photo:
            raise PlateError("one_name", first=other, second=photo, name=target.name)
        if first != target:
            raise PlateError("one_name_elsewhere", first=other, second=photo, name=first.name, other=target.name)


def unreadable_reason(photo: Path) -> str:
    """Return why a photograph, or a folder in its place, is refused before it is opened; an empty text if it is not."""
    try:
        str(photo).encode()
        if photo.is_dir():
            os.scandir(photo).close()
    except UnicodeEncodeError:
        return "the name is not valid Unicode; rename it"
    except OSError as problem:
        return f"cannot be read ({problem.strerror}); check its permissions"
    return ""


def is_folder(path: Path) -> bool:
    """Return whether a path leads to a folder; False if that cannot be seen."""
    try:
        return path.is_dir()
    except OSError:
        return False


def _photographs_below(folder: Path) -> list[Path]:
    """Return the photographs in a folder and its subfolders, sorted, and then the subfolders that cannot be read."""
    photographs: list[Path] = []
    failures: list[OSError] = []
    for name, subfolders, files in os.walk(folder, onerror=failures.append):
        subfolders[:] = [subfolder for subfolder in subfolders if not subfolder.startswith(".")]
        paths = [Path(name, file) for file in files if not file.startswith(".")]
        photographs += [path for path in paths if path.suffix.lower() in PHOTOGRAPH_SUFFIXES and not _is_sheet(path)]
    unread = sorted(Path(failure.filename) for failure in failures)
    if folder in unread:
        raise PlateError("unreadable", path=folder, reason=unreadable_reason(folder))
    return [*sorted(photographs), *unread]


def _is_sheet(path: Path) -> bool:
    """Return whether a picture is the sheet of an estimate or a calibration, as the JSON document beside it says."""
    if not path.name.endswith(SHEET_ENDING):
        return False
    try:
        document = read_json(path.with_name(path.name.removesuffix(SHEET_ENDING) + ".json"))
        return bool(document["files"]["sheet"] == path.name)
    except (OSError, ValueError, KeyError, TypeError):
        return False
