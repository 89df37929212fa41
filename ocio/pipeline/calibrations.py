"""The folder that `crfnet calibrate` writes: LUTs, a config, a sheet and a JSON document; responses to compare with."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from crfnet_core.errors import CurveError
from crfnet_core.files import atomic_write_text, json_text, read_json
from crfnet_core.photograph.image_io import RAW_SUFFIXES
from crfnet_core.response.curve import ResponseCurve

from ..configs.plate_color_space import PlateColorSpace
from ..errors import PlateError
from ..luts.lut1d import inverse_response_lut
from ..luts.response import read_response, response_of_lut
from ..options import OutputOptions, PlateOptions
from ..output_files import OutputFiles
from ..report.calibration import Measured, calibration_document, calibration_provenance
from .delivery import OutputPlan, plan_files, staged_plan, write_luts


def plan_calibration(
    folder: Path, frames: Sequence[Path], outputs: OutputOptions, *, name: str | None = None, overwrite: bool = False
) -> OutputPlan:
    """Return which files are written of a stack, after checking that they can be; create nothing.

    `name` is the name of the files and of the color space, by default the first frame's. Raise PlateError if it
    cannot be the name of a file, or as `plan_files`; ConfigError if the color space cannot be in a config.
    """
    if name is not None and (not name.strip(" .") or Path(name).name != name):
        raise PlateError("not_a_file_name", name=repr(name))
    stem = frames[0] if name is None else Path(f"{name}.stack")
    files = OutputFiles.named(folder, [stem], replace(outputs, has_linear=False, has_forward=False))
    source = "raw files and their JPEGs" if is_pairs(frames) else f"{len(frames)} exposures"
    description = f"The inverse response of a camera, as crfnet measured it from {source}"
    space = replace(PlateColorSpace.from_outputs(files, frames[0]), description=description, file_patterns=())
    return plan_files(files, frames, PlateOptions(overwrite=overwrite), space)


def is_pairs(paths: Sequence[Path]) -> bool:
    """Return whether files are raw files with their JPEGs, or a folder of such, and not an exposure stack."""
    return any(path.suffix.lower() in RAW_SUFFIXES or path.is_dir() for path in paths)


def write_calibration(
    plan: OutputPlan, calibration: Measured, comparison: Mapping[str, float] | None = None
) -> tuple[dict[str, Any], list[str]]:
    """Write every file of a plan; return the document in its JSON file, with the comparison if there is one.

    Return, too, the color spaces of other plates that were in the config, which holds this camera alone.

    Raise CRFNetError if a file cannot be written; the folder is then as it was.
    """
    files, lut = plan.files, inverse_response_lut(calibration.curve, comments=calibration_provenance(calibration))
    document = calibration_document(calibration, files, comparison)
    with staged_plan(plan, [*files.unshared, files.config]) as (folder, lost):
        write_luts(folder, files, lut, plan.space)
        if files.sheet:
            from ..report.calibration_sheet import draw_calibration  # loads matplotlib: optional, and slow

            draw_calibration(folder / files.sheet.name, calibration)
        atomic_write_text(folder / files.report.name, json_text(document), error=PlateError)
    return document, lost


def response_to_compare(path: Path) -> ResponseCurve:
    """Return the response in the JSON document of an estimate or a calibration, or in a LUT file.

    Raise CRFNetError if the file cannot be read or holds no response.
    """
    if path.suffix.lower() != ".json":
        return response_of_lut(read_response(path).lut)
    try:
        return ResponseCurve.restored(read_json(path)["response"]["brightness"])
    except OSError as problem:
        raise PlateError("not_opened", path=path, reason=problem.strerror) from problem
    except (KeyError, OverflowError, TypeError, ValueError, CurveError) as problem:
        raise PlateError("no_response_in_file", path=path) from problem
