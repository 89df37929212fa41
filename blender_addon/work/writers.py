# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of each way to apply a response, named as the `crfnet` command would name them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from crfnet.configs.derived import write_derived_config
from crfnet.configs.looks import Look
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.sources import find_config
from crfnet.luts.lut1d import Lut1D
from crfnet.options import OutputOptions, PlateOptions
from crfnet.output_files import OutputFiles, plain_stem
from crfnet.pipeline import OutputPlan, deliver
from crfnet.plates.frames import FrameSequence
from crfnet.plates.light import PlateLight
from crfnet.plates.linear import linear_targets, linearize_plates
from crfnet.plates.primaries import PlatePrimaries, linear_space
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
    """LUT files and a config, the folder that they are in, and the config."""

    folder: Path
    files: tuple[Path, ...]
    config: Path


Written = Baked | Exported


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
        In the mode BAKE or EXPORT; the others need no file.
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
    return export(job, lut, stops, primaries)


def bake(job: Job, lut: Lut1D, stops: float, sequence: FrameSequence, progress: Progress | None = None) -> Baked:
    """Write the linear plate, or all its frames; a canceled or failed job leaves the folder as it was."""
    folder = _folder(job)
    targets = linear_targets(folder / baked_name(job.plate), sequence)
    options = PlateOptions(
        depth=job.output.depth, exposure=stops, overwrite=job.output.overwrite, is_encoded=is_said_encoded(job)
    )
    plan = OutputPlan(replace(output_files(job.plate, folder), linear=targets), options, lut_length=0)
    with frame_reader(job.plate) as read:
        linearize = partial(_linearize, job.plate.alpha_mode)
        deliver(plan, _light(lut, stops), [read(sequence)], linearize=linearize, progress=progress)
    return Baked(targets, job.plate.is_sequence)


def _linearize(
    alpha_mode: str,
    sequence: FrameSequence,
    targets: Sequence[Path],
    lut: Lut1D,
    options: PlateOptions,
    *,
    progress: Progress | None = None,
) -> None:
    """Write frames as linear EXR, their alpha taken as by Blender; see `Plate.alpha_mode`."""
    frames = PlateFrames(sequence.paths, sequence.numbers, sequence.missing, alpha_mode=alpha_mode)
    linearize_plates(frames, targets, lut, options, progress=progress)


def _light(lut: Lut1D, stops: float, primaries: Primaries = REC709) -> PlateLight:
    """Return the meaning of the linear values."""
    plate = PlatePrimaries(primaries, "as the plate is tagged")
    return PlateLight(lut, stops, plate, linear_space(plate))


def export(job: Job, lut: Lut1D, stops: float, primaries: Primaries = REC709) -> Exported:
    """Write the LUT in three formats, and the config that Blender runs on with the plate's color space added."""
    folder = _folder(job)
    files = output_files(job.plate, folder)
    hint = job.plate.folder.name if job.plate.folder else ""
    look = Look(color_space(job.plate, files, stops, primaries), lut, hint)
    others = {path.name: lut for path in files.luts if path != files.lut}
    derived = write_derived_config(
        find_config(job.config), folder, [look], others=others, overwrite=job.output.overwrite
    )
    return Exported(folder, derived.files, derived.path)


def output_files(plate: Plate, folder: Path) -> OutputFiles:
    """Return the files that the `crfnet` command would write for a plate into a folder."""
    return OutputFiles.named(folder, [_photo(plate)], OutputOptions(has_sheet=False, has_linear=False))


def color_space(plate: Plate, files: OutputFiles, stops: float, primaries: Primaries = REC709) -> PlateColorSpace:
    """Return the plate's color space, with a file rule for all its files."""
    space = PlateColorSpace.from_outputs(files, _photo(plate), exposure=stops, file_pattern=plate.pattern)
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
