"""The folder that `crfnet estimate` writes: LUTs, a config, linear plates, sheets and JSON documents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import PyOpenColorIO as OCIO

from crfnet_core.errors import PlateError
from crfnet_core.files import atomic_write_text
from ocio.configs.files import write_config
from ocio.configs.portable import portable_config
from ocio.defaults import CONFIG_NAME, LUT_LENGTH
from ocio.luts.files import write_lut
from ocio.luts.lut1d import Lut1D
from ocio.options import PlateOptions
from ocio.output_files import OutputFiles, check_outputs, output_folder
from ocio.pipeline.estimates import PhotographEstimate, response_lut
from ocio.plates.frames import FrameSequence
from ocio.plates.linear import linearize_plates
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
    config : PyOpenColorIO.Config
        The config of the folder, with the colour spaces of all estimates.
    plates : PlateOptions
        How the linear plates are written; `overwrite` holds for every file.
    lut_length : int
        Entries of the LUTs.
    """

    folder: Path
    outputs: tuple[OutputFiles, ...]
    config: OCIO.Config
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
    spaces = [
        files.plate_color_space(group[0], exposure=plates.exposure)
        for group, files in zip(groups, outputs, strict=True)
    ]
    return OutputPlan(folder, outputs, portable_config(spaces), plates, lut_length)


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
        If a file cannot be written, a photograph has changed or gone, or the LUT length is out of range. The folder is
        then as it was: either all files are written, or none.
    """
    luts: dict[str, Lut1D] = {}
    documents = []
    with output_folder(plan.folder), staged_files(plan.folder) as staged:
        for files, estimated in zip(plan.outputs, estimates, strict=True):
            lut = response_lut(estimated.estimate, length=plan.lut_length)
            luts[files.color_space] = lut
            _write_estimate(files.in_folder(staged), estimated, lut, plan.plates)
            documents.append(estimate_document(estimated.estimate, estimated.facts, files))
            atomic_write_text(staged / files.report.name, json_text(documents[-1]), error=PlateError)
        write_config(staged / CONFIG_NAME, plan.config, check=luts)
    return documents


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
