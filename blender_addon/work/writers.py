# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of each way to apply a response, named as the `crfnet` command would name them."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from crfnet.configs.installed import Installed, install
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.luts.lut1d import Lut1D
from crfnet.options import OutputOptions, PlateOptions
from crfnet.output_files import OutputFiles, plain_stem
from crfnet.pipeline import OutputPlan, deliver
from crfnet.plates.frames import FrameSequence
from crfnet.plates.light import PlateLight
from crfnet.plates.linear import linear_targets, linearize_plates
from crfnet.plates.linear_space import linear_space
from crfnet.plates.primaries import PlatePrimaries
from crfnet_core.photograph.metadata.color_tags import REC709, Primaries
from crfnet_core.types import Progress, counted_from, show_progress

from .encoding_check import is_said_encoded
from .errors import AddonError
from .frame_files import FrameReader, PlateFrames, frame_reader
from .job import ApplyMode, Job, Plate

#: Decoded frames that are on the disk at a time; 4K frames of 8 bits take up to 25 MB each.
FRAMES_DECODED = 8


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
        Those that the plate is encoded in, for its color space; a bake goes by the tags of each frame.

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
    """Write the linear plate, or all its frames; a canceled or failed job leaves the folder as it was."""
    folder = _folder(job)
    targets = linear_targets(folder / baked_name(job.plate), sequence)
    options = PlateOptions(
        depth=job.output.depth, exposure=stops, overwrite=job.output.overwrite, is_encoded=is_said_encoded(job)
    )
    plan = OutputPlan(replace(output_files(job.plate, folder), linear=targets), options, lut_length=0)
    with frame_reader(job.plate) as read:
        linearize = partial(_linearize, job.plate, read)
        deliver(plan, _light(lut, stops), [sequence], linearize=linearize, progress=progress)
    return Baked(targets, job.plate.has_frames)


def _linearize(
    plate: Plate,
    read: FrameReader,
    sequence: FrameSequence,
    targets: Sequence[Path],
    lut: Lut1D,
    options: PlateOptions,
    *,
    progress: Progress | None = None,
) -> None:
    """Write frames as linear EXR, their alpha taken as by Blender; a few decoded ones are on the disk at a time."""
    step = len(targets) if plate.decoder is None else FRAMES_DECODED
    for start in range(0, len(targets), step):
        part, counted = slice(start, start + step), counted_from(progress, start, len(targets))
        files = read(FrameSequence(sequence.paths[part], sequence.numbers[part], sequence.missing), counted)
        frames = PlateFrames(files.paths, files.numbers, files.missing, alpha_mode=plate.alpha_mode)
        linearize_plates(frames, targets[part], lut, options, progress=counted if plate.decoder is None else None)
    show_progress(progress, len(targets), len(targets))


def export(job: Job, lut: Lut1D, stops: float, primaries: Primaries = REC709) -> Exported:
    """Write the LUT in three formats, and a portable config with the plate's color space."""
    folder = _folder(job)
    files, plates = output_files(job.plate, folder), PlateOptions(overwrite=job.output.overwrite)
    space = files.plate_color_space(_photo(job.plate), file_pattern=job.plate.pattern)
    plan = OutputPlan(files, plates, len(lut.values), space)
    return Exported(folder, deliver(plan, _light(lut, stops, primaries)))


def _light(lut: Lut1D, stops: float, primaries: Primaries = REC709) -> PlateLight:
    """Return the meaning of the linear values."""
    plate = PlatePrimaries(primaries, "as the plate is tagged")
    return PlateLight(lut, stops, plate, linear_space(plate))


def install_color_space(job: Job, lut: Lut1D, stops: float, primaries: Primaries = REC709) -> Installed:
    """Write the LUT, and a config with the plate's color space that Blender reads when it starts next."""
    folder = _folder(job)
    space = color_space(job.plate, output_files(job.plate, folder), stops, primaries)
    hint = job.plate.folder.name if job.plate.folder else ""
    return install(folder, job.config.path, space, lut, plate=identity(job.plate), hint=hint)


def identity(plate: Plate) -> str:
    """Return what a plate is known by in the config: its full path; without a file of its own, what it contains."""
    if plate.content is None:
        return str(plate.file.resolve())
    content = plate.content if isinstance(plate.content, bytes) else plate.content.tobytes()
    return f"sha256 {hashlib.sha256(content).hexdigest()}"


def output_files(plate: Plate, folder: Path) -> OutputFiles:
    """Return the files that the `crfnet` command would write for a plate into a folder."""
    return OutputFiles.named(folder, [_photo(plate)], OutputOptions(has_sheet=False, has_linear=False))


def color_space(plate: Plate, files: OutputFiles, stops: float, primaries: Primaries = REC709) -> PlateColorSpace:
    """Return the plate's color space, with a file rule for all its files, which an installed config leaves out."""
    space = files.plate_color_space(_photo(plate), exposure=stops, file_pattern=plate.pattern)
    return replace(space, primaries=primaries)


def baked_name(plate: Plate) -> str:
    """Return the file name of the linear plate; of a sequence, with a placeholder as wide as that of the plate.

    The frames of a movie get the four digits that Blender gives to frames.
    """
    stem = plain_stem(Path(plate.name + ".exr"))
    if not plate.has_frames:
        return f"{stem}_linear.exr"
    digits = 4 if plate.numbered is None else plate.numbered[1]
    return f"{stem}_linear.%0{digits}d.exr"


def _photo(plate: Plate) -> Path:
    """Return the file name of the plate without frame number, after which its files are named."""
    return Path(plate.name + plate.file.suffix)


def _folder(job: Job) -> Path:
    """Return the folder for files; an AddonError if the job has none."""
    if job.output.folder is None:
        raise AddonError(f"{job.plate.name}: has no folder of its own; choose one under Folder")
    return job.output.folder
