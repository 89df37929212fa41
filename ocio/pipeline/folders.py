"""The folder that `crfnet estimate` writes: LUTs, a config, linear plates, sheets and JSON documents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from crfnet_core.errors import PlateError
from crfnet_core.files import atomic_write_text
from crfnet_core.metadata.color_tags import REC709
from ocio.configs.files import write_config
from ocio.configs.plate_color_space import PlateColorSpace
from ocio.configs.portable import portable_config
from ocio.defaults import CONFIG_NAME, LUT_LENGTH
from ocio.luts.files import write_lut
from ocio.luts.lut1d import Lut1D
from ocio.options import PlateOptions
from ocio.output_files import OutputFiles, check_outputs, output_folder
from ocio.pipeline.estimates import PhotographEstimate, response_lut
from ocio.plates.frames import FrameSequence
from ocio.plates.light import PlateLight
from ocio.plates.linear import linearize_plates
from ocio.plates.primaries import common_primaries
from ocio.report import estimate_document, json_text
from ocio.staging import staged_files


@dataclass(frozen=True, eq=False)
class OutputPlan:
    """What will be written into one folder, checked before any work is done; see `plan_outputs`.

    Parameters
    ----------
    folder : Path
        The folder; it need not exist yet.
    outputs : tuple of OutputFiles
        The files of each estimate, in the order of the estimates.
    spaces : tuple of PlateColorSpace
        The colour space of each estimate in the folder's config, before its exposure and primaries are known.
    plates : PlateOptions
        How the linear plates are written; `overwrite` holds for every file.
    lut_length : int
        Entries of the LUTs.
    """

    folder: Path
    outputs: tuple[OutputFiles, ...]
    spaces: tuple[PlateColorSpace, ...]
    plates: PlateOptions
    lut_length: int


def plan_outputs(
    folder: Path,
    groups: Sequence[Sequence[Path]],
    plates: PlateOptions,
    *,
    lut_length: int = LUT_LENGTH,
    has_sheet: bool = True,
) -> OutputPlan:
    """Return which files are written for photographs, after checking that they can be; create nothing.

    Parameters
    ----------
    folder : Path
        The folder to write to.
    groups : sequence of sequences of Path
        Photographs that have a response in common, for each estimate.
    plates : PlateOptions
        How the linear plates are written; `overwrite` holds for every file.
    lut_length : int
        Entries of the LUTs.
    has_sheet : bool
        Whether sheets are drawn, which needs matplotlib.

    Raises
    ------
    PlateError
        If a file cannot be written or would replace another, or a photograph: see `check_outputs`.
    ConfigError
        If the colour spaces cannot be in one config.
    """
    outputs = tuple(OutputFiles.named(folder, photos, has_sheet=has_sheet) for photos in groups)
    photos = [photo for group in groups for photo in group]
    check_outputs(folder, outputs, photos=photos, overwrite=plates.overwrite)
    spaces = tuple(files.plate_color_space(group[0]) for group, files in zip(groups, outputs, strict=True))
    portable_config(spaces)
    return OutputPlan(folder, outputs, spaces, plates, lut_length)


def write_estimates(plan: OutputPlan, estimates: Sequence[PhotographEstimate]) -> list[dict[str, Any]]:
    """Write every file of a plan and return the documents that its JSON files hold.

    Parameters
    ----------
    plan : OutputPlan
        See `plan_outputs`.
    estimates : sequence of PhotographEstimate
        One for each group of the plan.

    Raises
    ------
    CRFNetError
        If a file cannot be written, a photograph has changed or gone, the LUT length is out of range, photographs of
        one estimate differ in their primaries, or these are unknown and have to be converted. The folder is then as it
        was: either all files are written, or none.
    """
    lights = [_light(estimated, plan) for estimated in estimates]
    spaces = [_with_light(space, light) for space, light in zip(plan.spaces, lights, strict=True)]
    documents = []
    with output_folder(plan.folder), staged_files(plan.folder) as staged:
        for files, estimated, light in zip(plan.outputs, estimates, lights, strict=True):
            _write_estimate(files.in_folder(staged), estimated, light.lut, plan.plates)
            documents.append(estimate_document(estimated.estimate, estimated.facts, files, light))
            atomic_write_text(staged / files.report.name, json_text(documents[-1]), error=PlateError)
        luts = {space.name: light.lut for space, light in zip(spaces, lights, strict=True)}
        write_config(staged / CONFIG_NAME, portable_config(spaces), check=luts)
    return documents


def _light(estimated: PhotographEstimate, plan: OutputPlan) -> PlateLight:
    """Return what the linear values of an estimate's photographs mean, which have to have primaries in common."""
    tags = dict(zip(estimated.paths, estimated.tags, strict=True))
    common_primaries(tags, plan.plates.primaries)
    lut = response_lut(estimated.estimate, length=plan.lut_length)
    return PlateLight.of(estimated.tags[0], lut, plan.plates)


def _with_light(space: PlateColorSpace, light: PlateLight) -> PlateColorSpace:
    """Return a plate's colour space with its exposure and its primaries; unknown ones are taken for Rec.709."""
    treated = "" if light.plate.primaries else ", treated as Rec.709"
    return replace(
        space,
        exposure=light.stops,
        primaries=light.plate.primaries or REC709,
        description=f"{space.description}; primaries {light.plate}{treated}",
    )


def _write_estimate(files: OutputFiles, estimated: PhotographEstimate, lut: Lut1D, plates: PlateOptions) -> None:
    """Write the files of one estimate, except the document and the config."""
    for path in files.luts:
        write_lut(path, lut)
    # Each photograph is read again: see `estimate_photographs`.
    for photo, linear in zip(estimated.paths, files.linear, strict=True):
        linearize_plates(FrameSequence((photo,)), (linear,), lut, plates)
    if files.sheet:
        _write_sheet(files.sheet, estimated)


def _write_sheet(path: Path, estimated: PhotographEstimate) -> None:
    """Draw the sheet; matplotlib, an optional dependency that loads slowly, is imported only now."""
    from ocio.sheet import draw_sheet

    draw_sheet(path, estimated.preview, estimated.estimate, stride=estimated.stride)
