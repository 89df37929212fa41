"""The folder that `crfnet calibrate` writes: LUTs, a config, a sheet and a JSON document; responses to compare with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import PyOpenColorIO as OCIO

from crfnet_core.calibration import Calibration, Comparison
from crfnet_core.errors import CurveError
from crfnet_core.files import atomic_write_text, json_text, read_json
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.staging import staged_files

from ..configs.files import write_config
from ..configs.plate_color_space import PlateColorSpace
from ..configs.portable import portable_config
from ..errors import PlateError
from ..luts.files import write_lut
from ..luts.lut1d import inverse_response_lut
from ..luts.response import read_response, response_of_lut
from ..options import OutputOptions
from ..output_files import OutputFiles, check_outputs, output_folder
from ..report import calibration_document, calibration_provenance
from .delivery import EarlierRun


@dataclass(frozen=True, eq=False)
class CalibrationPlan:
    """What will be written of a calibration, checked before any work is done; see `plan_calibration`.

    Parameters
    ----------
    files : OutputFiles
        The files, all in one folder, which need not exist yet; no linear plates are among them.
    config : PyOpenColorIO.Config
        The config of the folder, with the camera's colour space.
    lut_length : int
        Entries of the LUTs.
    overwrite : bool
        Whether existing files may be replaced.
    earlier : EarlierRun
        What an earlier run has left in the folder.
    """

    files: OutputFiles
    config: OCIO.Config
    lut_length: int
    overwrite: bool = False
    earlier: EarlierRun = field(default_factory=EarlierRun)


def plan_calibration(
    folder: Path, frames: Sequence[Path], outputs: OutputOptions, *, name: str | None = None, overwrite: bool = False
) -> CalibrationPlan:
    """Return which files are written of a stack, after checking that they can be; create nothing.

    Parameters
    ----------
    folder : Path
        The folder to write to.
    frames : sequence of Path
        The frames; at least one.
    outputs : OutputOptions
        Which files there are beside the LUTs, and how long the LUTs are.
    name : str, optional
        How the files and the colour space are called; by default as the first frame.
    overwrite : bool
        Whether existing files may be replaced.

    Raises
    ------
    PlateError
        If the name cannot be that of a file, or a file cannot be written or would replace another, or a frame: see
        `check_outputs`.
    ConfigError
        If the colour space cannot be in a config.
    """
    if name is not None and (not name.strip(" .") or Path(name).name != name):
        raise PlateError("not_a_file_name", name=repr(name))
    stem = frames[0] if name is None else Path(f"{name}.stack")
    files = OutputFiles.named(folder, [stem], replace(outputs, has_linear=False, has_forward=False))
    check_outputs(folder, [files], photos=frames, overwrite=overwrite)
    description = f"The inverse response of a camera, as crfnet measured it from {len(frames)} exposures"
    space = replace(PlateColorSpace.from_outputs(files, frames[0]), description=description, file_patterns=())
    earlier = EarlierRun.in_folder(files, [stem], is_measured=True)
    return CalibrationPlan(files, portable_config([space]), outputs.lut_length, overwrite, earlier)


def write_calibration(
    plan: CalibrationPlan, calibration: Calibration, comparison: Comparison | None = None
) -> dict[str, Any]:
    """Write every file of a plan and return the document that its JSON file holds.

    Parameters
    ----------
    plan : CalibrationPlan
        See `plan_calibration`.
    calibration : Calibration
        The measured response.
    comparison : Comparison, optional
        How far another response is from it; kept in the document.

    Raises
    ------
    CRFNetError
        If a file cannot be written, or the LUT length is out of range. The folder is then as it was.
    """
    lut = inverse_response_lut(calibration.curve, length=plan.lut_length, comments=calibration_provenance(calibration))
    folder = plan.files.report.parent
    document = calibration_document(calibration, plan.files, comparison)
    with output_folder(folder), staged_files(folder, overwrite=plan.overwrite) as staged:
        files = plan.files.in_folder(staged)
        for path in files.luts:
            write_lut(path, lut)
        if files.sheet:
            _write_sheet(files.sheet, calibration)
        atomic_write_text(files.report, json_text(document), error=PlateError)
        write_config(files.config, plan.config, check={files.color_space: lut})
    return document


def response_to_compare(path: Path) -> ResponseCurve:
    """Return the response in the JSON document of an estimate or a calibration, or in a LUT file.

    Raises
    ------
    PlateError
        If the document cannot be read or holds no response.
    CRFNetError
        If a LUT file holds none: see `crfnet.luts.response.read_response`.
    """
    if path.suffix.lower() != ".json":
        return response_of_lut(read_response(path).lut)
    try:
        samples = read_json(path)["response"]["brightness"]
        return ResponseCurve.restored(samples)
    except OSError as problem:
        raise PlateError("not_opened", path=path, reason=problem.strerror) from problem
    except (KeyError, OverflowError, TypeError, ValueError, CurveError) as problem:
        raise PlateError("no_response_in_file", path=path) from problem


def _write_sheet(path: Path, calibration: Calibration) -> None:
    """Draw the sheet; matplotlib, an optional dependency that loads slowly, is imported only now."""
    from ..report.calibration_sheet import draw_calibration

    draw_calibration(path, calibration)
