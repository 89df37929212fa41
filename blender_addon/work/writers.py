# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of each way to apply a response, named as the `crfnet` command would name them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from crfnet.configs.installed import Installed, install
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.luts.lut1d import Lut1D
from crfnet.options import OutputOptions, PlateOptions
from crfnet.output_files import OutputFiles, plain_stem
from crfnet.pipeline import all_or_none, export_luts
from crfnet.plates.frames import FrameSequence
from crfnet.plates.linear import linear_targets, linearize_plates
from crfnet_core.colorimetry import REC709, Primaries
from crfnet_core.types import Progress

from .encoding_check import is_said_encoded
from .errors import AddonError
from .frame_files import PlateFrames, frame_reader
from .job import ApplyMode, Job, Plate


@dataclass(frozen=True)
class Baked:
    """Linear EXR files.

    Parameters
    ----------
    files : tuple of Path
        The files, in the order of their frames.
    is_sequence : bool
        Whether they are the frames of a sequence.
    """

    files: tuple[Path, ...]
    is_sequence: bool


@dataclass(frozen=True)
class Exported:
    """LUT files and a config, and the folder that they are in."""

    folder: Path
    files: tuple[Path, ...]


Written = Baked | Exported | Installed


def write(
    job: Job,
    lut: Lut1D,
    stops: float,
    sequence: Callable[[], FrameSequence],
    progress: Progress | None = None,
    *,
    primaries: Primaries = REC709,
) -> Written:
    """Write the files of a job.

    Parameters
    ----------
    job : Job
        In any mode but NODES, which need no file.
    lut : Lut1D
        The inverse response.
    stops : float
        Stops added after the inverse response.
    sequence : callable
        Returns the frames of the plate; called only if they are written.
    progress : callable or None
        Called with (done, total) after every frame; what it raises ends the job.
    primaries : Primaries
        Those that the plate is encoded in, for its colour space; a bake goes by the tags of each frame.

    Raises
    ------
    CRFNetError, AddonError
        If there is no folder, a file exists and may not be replaced, or a file cannot be written. New files are
        removed again.
    """
    if job.output.mode is ApplyMode.BAKE:
        return bake(job, lut, stops, sequence(), progress)
    if job.output.mode is ApplyMode.EXPORT:
        return export(job, lut, stops, primaries)
    return install_color_space(job, lut, stops, primaries)


def bake(job: Job, lut: Lut1D, stops: float, sequence: FrameSequence, progress: Progress | None = None) -> Baked:
    """Write the linear plate, or all its frames; a cancelled or failed job leaves the folder as it was."""
    targets = linear_targets(_folder(job) / baked_name(job.plate), sequence)
    options = PlateOptions(
        depth=job.output.depth, exposure=stops, overwrite=job.output.overwrite, is_encoded=is_said_encoded(job)
    )
    with frame_reader(job.plate) as read, all_or_none(targets, overwrite=options.overwrite) as staged:
        _linearize(job.plate.alpha_mode, lut, options, read(sequence), staged, progress)
    return Baked(targets, job.plate.is_sequence)


def _linearize(
    alpha_mode: str,
    lut: Lut1D,
    options: PlateOptions,
    sequence: FrameSequence,
    targets: Sequence[Path],
    progress: Progress | None = None,
) -> None:
    """Write frames as linear EXR, their alpha taken as by Blender; see `Plate.alpha_mode`."""
    frames = PlateFrames(sequence.paths, sequence.numbers, sequence.missing, alpha_mode=alpha_mode)
    linearize_plates(frames, targets, lut, options, progress=progress)


def export(job: Job, lut: Lut1D, stops: float, primaries: Primaries = REC709) -> Exported:
    """Write the LUT in three formats, and a portable config with the plate's colour space."""
    folder = _folder(job)
    files = output_files(job.plate, folder)
    space = color_space(job.plate, files, stops, primaries)
    return Exported(folder, export_luts(files, space, lut, overwrite=job.output.overwrite))


def install_color_space(job: Job, lut: Lut1D, stops: float, primaries: Primaries = REC709) -> Installed:
    """Write the LUT, and a config with the plate's colour space that Blender reads when it starts next."""
    folder = _folder(job)
    space = color_space(job.plate, output_files(job.plate, folder), stops, primaries)
    hint = job.plate.folder.name if job.plate.folder else ""
    return install(folder, job.config.path, space, lut, plate=identity(job.plate), hint=hint)


def identity(plate: Plate) -> str:
    """Return what a plate is known by in the config: its full path; without a file of its own, what it contains."""
    if plate.content is None or plate.frame_count:
        return str(plate.file.resolve())
    content = plate.content if isinstance(plate.content, bytes) else plate.content.tobytes()
    return f"sha256 {hashlib.sha256(content).hexdigest()}"


def output_files(plate: Plate, folder: Path) -> OutputFiles:
    """Return the files that the `crfnet` command would write for a plate into a folder."""
    return OutputFiles.named(folder, [_photo(plate)], OutputOptions(has_sheet=False))


def color_space(plate: Plate, files: OutputFiles, stops: float, primaries: Primaries = REC709) -> PlateColorSpace:
    """Return the plate's colour space, with a file rule for all its files, which an installed config leaves out."""
    space = files.plate_color_space(_photo(plate), exposure=stops, file_pattern=plate.pattern)
    return replace(space, primaries=primaries)


def baked_name(plate: Plate) -> str:
    """Return the file name of the linear plate; of a sequence, with a placeholder as wide as that of the plate."""
    stem = plain_stem(Path(plate.name + ".exr"))
    return f"{stem}_linear.exr" if plate.numbered is None else f"{stem}_linear.%0{plate.numbered[1]}d.exr"


def _photo(plate: Plate) -> Path:
    """Return the file name of the plate without frame number, after which its files are named."""
    return Path(plate.name + plate.file.suffix)


def _folder(job: Job) -> Path:
    """Return the folder for files; an AddonError if the job has none."""
    if job.output.folder is None:
        raise AddonError(f"{job.plate.name}: has no folder of its own; choose one under Folder")
    return job.output.folder
