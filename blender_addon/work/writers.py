# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of each way to apply a response, named as the `crfnet` command would name them."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import OpenImageIO as oiio

from crfnet.configs.derived import write_derived_config
from crfnet.configs.looks import Look
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.sources import find_config
from crfnet.luts.lut1d import Lut1D
from crfnet.options import OutputOptions, PlateOptions
from crfnet.output_files import OutputFiles, plain_stem
from crfnet.output_files import check_targets as check_files
from crfnet.pipeline import OutputPlan, deliver
from crfnet.plates.frame_pattern import FramePattern
from crfnet.plates.frames import FrameSequence
from crfnet.plates.light import PlateLight
from crfnet.plates.linear import linear_targets
from crfnet.plates.primaries import PlatePrimaries, linear_space
from crfnet_core.colorimetry import REC709, Primaries
from crfnet_core.types import Progress

from .encoding_check import is_said_encoded
from .errors import AddonError
from .frame_files import PlateFrames, frame_reader
from .job import WITHOUT_FILES, ApplyMode, Job, Plate, file_state


@dataclass(frozen=True)
class Written:
    """Linear EXR files in the order of their frames, or LUT files and a config."""

    files: tuple[Path, ...]
    config: Path | None = None  # of an export


def write(
    job: Job,
    lut: Lut1D,
    stops: float,
    sequence: Callable[[], FrameSequence],
    progress: Progress | None = None,
    *,
    primaries: Primaries = REC709,
) -> Written:
    """Write the files of a job in the mode BAKE or EXPORT, with the inverse response and an exposure in stops.

    `primaries` are for the color space of an export, while a bake goes by the tags of each frame. Raise CRFNetError or
    AddonError if a file cannot be written; new files are removed again then, also if `progress` raises.
    """
    if job.output.mode is ApplyMode.BAKE:
        return _bake(job, lut, stops, sequence(), progress)
    return _export(job, lut, stops, primaries)


def check_targets(job: Job, sequence: Callable[[], FrameSequence]) -> None:
    """Raise AddonError or CRFNetError if the files of a job cannot be written; create nothing."""
    if job.output.mode in WITHOUT_FILES:
        return
    if job.output.mode is ApplyMode.BAKE and job.plate.frame_count:
        raise AddonError(
            f"{job.plate.name}: movies are not baked; choose Nodes and render, or open the movie's frames as an image"
            " sequence"
        )
    folder, files = _folder(job), output_files(job.plate, _folder(job))
    targets = (*files.luts, files.config)
    if job.output.mode is ApplyMode.BAKE:
        targets = linear_targets(folder / baked_name(job.plate), sequence())
    check_files(folder, [path for path in targets if not _is_own(job, path)], overwrite=job.output.overwrite)


def _is_own(job: Job, path: Path) -> bool:
    """Return whether the plate wrote a file, and nobody since."""
    return job.output.own_files.get(str(path)) == file_state(path)


def _may_replace(job: Job, targets: Sequence[Path]) -> bool:
    """Return whether files may be replaced: on demand, or because all that exist are the plate's own."""
    existing = [path for path in targets if os.path.lexists(path)]
    return job.output.overwrite or (bool(existing) and all(_is_own(job, path) for path in existing))


def _bake(job: Job, lut: Lut1D, stops: float, sequence: FrameSequence, progress: Progress | None) -> Written:
    """Write the linear plate, or all its frames."""
    folder = _folder(job)
    oiio.attribute("debug", 0)  # else the builds of some distributions print what OpenEXR does not store, for each file
    targets = linear_targets(folder / baked_name(job.plate), sequence)
    is_encoded, overwrite = is_said_encoded(job), _may_replace(job, targets)
    options = PlateOptions(depth=job.output.depth, exposure=stops, overwrite=overwrite, is_encoded=is_encoded)
    plan = OutputPlan(replace(output_files(job.plate, folder), luts=(), linear=targets), options)
    primaries = PlatePrimaries(REC709, "as the plate is tagged")
    light = PlateLight(lut, stops, primaries, linear_space(primaries))
    frames = PlateFrames(sequence.paths, sequence.numbers, sequence.missing, alpha_mode=job.plate.alpha_mode)
    with frame_reader(job.plate) as read:
        deliver(plan, light, [read(frames)], progress=progress)
    return Written(targets)


def _export(job: Job, lut: Lut1D, stops: float, primaries: Primaries) -> Written:
    """Write the LUT in three formats, and the config that Blender runs on with the plate's color space added."""
    folder = _folder(job)
    files = output_files(job.plate, folder)
    hint = job.plate.folder.name if job.plate.folder else ""
    look = Look(color_space(job.plate, files, stops, primaries), lut, hint)
    others = {path.name: lut for path in files.luts}
    overwrite = _may_replace(job, (*files.luts, files.config))
    derived = write_derived_config(find_config(job.config), folder, [look], others=others, overwrite=overwrite)
    return Written(derived.files, derived.path)


def output_files(plate: Plate, folder: Path) -> OutputFiles:
    """Return the files that the `crfnet` command would write for a plate into a folder."""
    return OutputFiles.named(folder, [_photo(plate)], OutputOptions(has_sheet=False, has_linear=False))


def color_space(plate: Plate, files: OutputFiles, stops: float, primaries: Primaries = REC709) -> PlateColorSpace:
    """Return the plate's color space, with a file rule for all its files."""
    rule = FramePattern(plate.file.parent, *plate.numbered).rule if plate.numbered else ""
    space = PlateColorSpace.from_outputs(files, _photo(plate), exposure=stops, file_pattern=rule)
    return replace(space, primaries=primaries)


def baked_name(plate: Plate) -> str:
    """Return the file name of the linear plate; of a sequence, with a placeholder as wide as the plate's."""
    stem = plain_stem(Path(plate.name + ".exr"))
    return f"{stem}_linear.exr" if plate.numbered is None else f"{stem}_linear.%0{plate.numbered[1]}d.exr"


def _photo(plate: Plate) -> Path:
    """Return the file name of the plate without frame number, after which its files are named."""
    return Path(plate.name + plate.file.suffix)


def _folder(job: Job) -> Path:
    """Return the folder for files; an AddonError if the job has none."""
    if job.output.folder is None:
        raise AddonError(
            f"{job.plate.name}: has no folder of its own; choose one under Folder, or save the .blend file"
        )
    return job.output.folder
