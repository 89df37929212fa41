"""Which files an estimate writes, and whether they may be written: checked before any work is done."""

import itertools
import os
import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from crfnet_core.files import check_target, cut_to_bytes
from crfnet_core.staging import remove_abandoned, staged_files

from .defaults import CONFIG_NAME
from .errors import PlateError
from .luts.files import WRITERS
from .options import OutputOptions

#: Most bytes of a stem (file systems take 255 for a name, of which suffixes and temporary names need some), and of a
#: hint behind it: see `distinct_names`.
LONGEST_STEM, LONGEST_HINT = 200, 32

#: How the name of a sheet ends, after the stem.
SHEET_ENDING = "_sheet.png"


@dataclass(frozen=True)
class OutputFiles:
    """The files of one estimate, all in one folder and named after its first photograph."""

    luts: tuple[Path, ...]  # the inverse response in each format of `WRITERS`
    config: Path  # the OpenColorIO config; several estimates may share it
    linear: tuple[Path, ...]  # one linear EXR per photograph; none if they are not written
    sheet: Path | None  # the picture of the estimate; None if it is not drawn
    report: Path  # the JSON document
    color_space: str  # the name of the photograph's color space in the config
    forward: tuple[Path, ...] = ()  # the response itself in each format; none if it is not written

    @classmethod
    def named(cls, folder: Path, photos: Sequence[Path], outputs: OutputOptions | None = None) -> Self:
        """Return the files that the options (by default the usual ones) ask for of photographs with one response."""
        stem, outputs = plain_stem(photos[0]), outputs or OutputOptions()
        return cls(
            luts=tuple(folder / f"{stem}{suffix}" for suffix in WRITERS),
            config=folder / CONFIG_NAME,
            linear=tuple(folder / f"{plain_stem(photo)}_linear.exr" for photo in photos if outputs.has_linear),
            sheet=folder / f"{stem}{SHEET_ENDING}" if outputs.has_sheet else None,
            report=folder / f"{stem}.json",
            color_space=f"CRF {stem}",
            forward=tuple(folder / f"{stem}_forward{suffix}" for suffix in WRITERS if outputs.has_forward),
        )

    @property
    def lut(self) -> Path:
        """The LUT that the config names: the first format."""
        return self.luts[0]

    @property
    def unshared(self) -> tuple[Path, ...]:
        """Every file except the config, which other estimates may share."""
        sheet = () if self.sheet is None else (self.sheet,)
        return (*self.luts, *self.forward, *self.linear, *sheet, self.report)


def plain_stem(photo: Path) -> str:
    """Return a file's name without its suffix, with `_` for what configs, patterns or other systems interpret.

    It is cut to `LONGEST_STEM` bytes, so that every file named after it can be written.
    """
    return _plain(cut_to_bytes(photo.stem, LONGEST_STEM))


def _plain(name: str) -> str:
    """Return a name with `_` for what configs, patterns or other systems interpret, or cut off at the end."""
    return re.sub(r"[$%#*?\\:]|\s+$", "_", name)


def distinct_names(name: str, hint: str = "") -> Iterator[str]:
    """Yield names for something that is to be called `name`, unless that is taken: the first is `name` itself.

    The others have `hint`, such as the folder, in parentheses, cut to `LONGEST_HINT` bytes, and then numbers from 2.
    """
    yield name
    hint = cut_to_bytes(_plain(hint), LONGEST_HINT)
    if hint:
        yield f"{name} ({hint})"
    for number in itertools.count(2):
        yield f"{name} ({hint} {number})" if hint else f"{name} ({number})"


def folded(name: str) -> str:
    """Return a name as macOS and Windows compare names: without upper case, its accents in one form of Unicode."""
    return unicodedata.normalize("NFC", name).casefold()


def check_targets(
    folder: Path,
    targets: Sequence[Path],
    *,
    photos: Iterable[Path] = (),
    configs: Sequence[Path] = (),
    overwrite: bool = False,
) -> None:
    """Check that files in `folder`, which need not exist yet, can be written; create nothing.

    `configs` are files, too, which several estimates may share. Raise PlateError if the folder cannot be made or
    written to, a file exists and may not be replaced, or one of `photos` would be replaced.
    """
    check_folder(folder)
    for config in configs:
        check_config_folder(config.parent)
    originals = {os.path.realpath(photo) for photo in photos}
    every = [*targets, *configs]
    for path in every:
        if os.path.realpath(path) in originals:
            raise PlateError("replaces_photograph", path=path)
        if path.is_dir():
            raise PlateError("folder_in_place", path=path)
    if not overwrite and (existing := [path for path in every if os.path.lexists(path)]):
        if len(existing) > 1:
            raise PlateError("files_exist", path=folder, name=existing[0].name, more=len(existing) - 1)
        raise PlateError("file_exists", path=existing[0])


def check_folder(folder: Path) -> None:
    """Check that `folder` can be written to, or made, and complete what killed runs left; or raise PlateError."""
    existing = next(path for path in (folder.absolute(), *folder.absolute().parents) if os.path.lexists(path))
    if not existing.is_dir():
        raise PlateError("not_a_folder", path=existing)
    if not os.access(existing, os.W_OK | os.X_OK):
        raise PlateError("not_writable", path=existing)
    remove_abandoned(folder.absolute())


def check_config_folder(folder: Path) -> None:
    """Raise PlateError as `check_folder` does, and for a folder in which OpenColorIO would find no LUTs."""
    check_folder(folder)
    path = str(folder.absolute())
    if "$" in path or path.count("%") > 1:
        raise PlateError("variables_in_path", path=path)


@contextmanager
def output_folder(folder: Path) -> Iterator[None]:
    """Make `folder` for a block; if it fails, those folders that were made and are empty are removed again."""
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    try:
        yield
    except BaseException:
        for path in made:
            with suppress(OSError):
                path.rmdir()
        raise


@contextmanager
def all_or_none(targets: Sequence[Path], *, overwrite: bool = False) -> Iterator[Path]:
    """Yield the folder that a block writes files to; they take their names together or not at all."""
    folder = targets[0].parent
    check_folder(folder)
    try:
        with output_folder(folder):
            for target in targets:
                check_target(target, overwrite=overwrite)
            with staged_files(folder, overwrite=overwrite) as temporary:
                yield temporary
    except OSError as problem:  # such as on Windows, which does not say before what is not allowed
        raise PlateError("folder_not_written", path=folder, reason=problem.strerror or problem) from problem
