# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of each way to apply a response; nothing here touches Blender's data."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from crfnet_core import CRFNetError
from crfnet_core.files import check_target
from ocio.configs.installed import Installed, install
from ocio.configs.plate_color_space import PlateColorSpace, write_config
from ocio.configs.portable import portable_config
from ocio.luts.files import write_lut
from ocio.luts.lut1d import Lut1D
from ocio.output_files import OutputFiles, check_folder, output_folder, plain_stem
from ocio.plates.frames import FramePattern, find_frames
from ocio.plates.linear import linearize_plates

from ..scene.plates import Plate
from ..ui.gather import Request
from .background import Progress
from .errors import AddonError, CancelledError


@dataclass(frozen=True)
class Baked:
    """Linear EXR files, in the order of their frames."""

    files: tuple[Path, ...]
    is_sequence: bool


@dataclass(frozen=True)
class Exported:
    """A folder with LUT files and a config."""

    folder: Path
    files: tuple[Path, ...]


def bake(request: Request, lut: Lut1D, exposure: float, progress: Progress) -> Baked:
    """Write the linear plate or frames; a cancelled run takes its files away again.

    Raises
    ------
    CRFNetError, AddonError
        If there is no folder, a file exists and may not be replaced, or a frame fails.
    """
    plate, folder = request.plate, _writable_folder(request)
    target = folder / _baked_name(plate)
    targets = _frames(target, plate)
    with output_folder(folder):
        for path in targets:
            check_target(path, overwrite=request.overwrite)
        before = {path for path in targets if path.exists()}
        try:
            linearize_plates(
                plate.file,
                target,
                lut,
                depth=request.depth,
                exposure=exposure,
                overwrite=request.overwrite,
                progress=progress,
            )
        except (CancelledError, CRFNetError):
            _remove(set(targets) - before)
            raise
    return Baked(tuple(targets), plate.is_sequence)


def export(request: Request, lut: Lut1D, exposure: float, _progress: Progress) -> Exported:
    """Write the LUT in three formats and a portable config.

    Raises
    ------
    CRFNetError, AddonError
        If there is no folder, or a file exists and may not be replaced.
    """
    folder = _writable_folder(request)
    names = output_names(request.plate, folder)
    files = (names.spi1d, names.cube, names.clf, names.config)
    with output_folder(folder):
        for path in files:
            check_target(path, overwrite=request.overwrite)
        before = {path for path in files if path.exists()}
        try:
            for path in files[:-1]:
                write_lut(path, lut, overwrite=True)
            space = color_space(request.plate, names, exposure)
            write_config(names.config, portable_config([space]), check={space.name: lut}, overwrite=True)
        except CRFNetError:
            _remove(set(files) - before)
            raise
    return Exported(folder, files)


def install_color_space(request: Request, lut: Lut1D, exposure: float, _progress: Progress) -> Installed:
    """Write the LUT and a config with the plate's colour space, for Blender's next start: see `install`."""
    folder = _writable_folder(request)
    space = color_space(request.plate, output_names(request.plate, folder), exposure)
    return install(folder, request.base_config, space, lut)


#: What writes the files of each mode; the nodes need none.
WRITERS: dict[str, Callable[[Request, Lut1D, float, Progress], Baked | Exported | Installed]] = {
    "BAKE": bake,
    "EXPORT": export,
    "COLORSPACE": install_color_space,
}


def output_names(plate: Plate, folder: Path) -> OutputFiles:
    """Return the names that the `crfnet` command would give a plate's files."""
    return OutputFiles.named(folder, [Path(plate.name + plate.file.suffix)], has_sheet=False)


def color_space(plate: Plate, names: OutputFiles, exposure: float) -> PlateColorSpace:
    """Return the plate's colour space, with a file rule for its files."""
    photo = Path(plate.name + plate.file.suffix)
    return replace(names.plate_color_space(photo, exposure), file_pattern=plate.pattern)


def _writable_folder(request: Request) -> Path:
    """Return the folder for files, which can be written to or made."""
    if request.folder is None:
        raise AddonError(f"{request.plate.name}: has no folder of its own; choose one under Folder")
    check_folder(request.folder)
    return request.folder


def _baked_name(plate: Plate) -> str:
    """Return the name of the linear plate, with a placeholder for the frame number where there is one."""
    stem = plain_stem(Path(plate.name + ".exr"))
    pattern = FramePattern.parse(plate.file) if plate.is_sequence else None
    return f"{stem}_linear.exr" if pattern is None else f"{stem}_linear.%0{pattern.width}d.exr"


def _frames(target: Path, plate: Plate) -> list[Path]:
    """Return the files that a target stands for."""
    pattern = FramePattern.parse(target) if plate.is_sequence else None
    return [target] if pattern is None else [pattern.path(number) for number in find_frames(plate.file).numbers]


def _remove(paths: Iterable[Path]) -> None:
    """Remove files that a failed run has written."""
    for path in paths:
        with suppress(OSError):
            path.unlink(missing_ok=True)
