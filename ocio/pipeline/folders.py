"""The folder that `crfnet estimate` writes: LUTs, a config, linear plates, a sheet and a JSON document."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from crfnet_core.colorimetry import REC709
from crfnet_core.files import atomic_write_text, json_text

from ..configs.files import loaded_or_empty, write_config
from ..configs.plate_color_space import PlateColorSpace
from ..configs.plates import plates_in_config
from ..configs.portable import portable_config
from ..errors import PlateError
from ..luts.files import write_lut
from ..luts.forward import forward_lut
from ..options import OutputOptions, PlateOptions
from ..output_files import OutputFiles, check_outputs, output_folder
from ..plates.light import PlateLight
from ..plates.linear import linearize_plates
from ..plates.linear_space import LinearSpace
from ..plates.primaries import PlatePrimaries, common_primaries
from ..report import estimate_document
from ..staging import staged_files
from .estimates import PhotographEstimate, response_lut
from .photographs import check_distinct


@dataclass(frozen=True)
class EarlierRun:
    """What an earlier run has left in the folder of an estimate or a measurement.

    Parameters
    ----------
    left : tuple of Path
        Files of other options that stay there, although they are not of this run: see `left_files`.
    dropped : tuple of str
        Colour spaces of other plates in the config that is replaced, which it will not have any more.
    """

    left: tuple[Path, ...] = ()
    dropped: tuple[str, ...] = ()

    @classmethod
    def in_folder(cls, files: OutputFiles, photos: Sequence[Path], *, is_measured: bool = False) -> EarlierRun:
        """Return what is there before the files are written; the arguments are those of `left_files`."""
        return cls(left_files(files, photos, is_measured=is_measured), _dropped_spaces(files))

    @property
    def document(self) -> dict[str, list[str]]:
        """The names for JSON; what there is none of is absent."""
        names = {"left": [path.name for path in self.left], "dropped": list(self.dropped)}
        return {name: entries for name, entries in names.items() if entries}


@dataclass(frozen=True, eq=False)
class OutputPlan:
    """What will be written into one folder, checked before any work is done; see `plan_outputs`.

    Parameters
    ----------
    files : OutputFiles
        The files, all in one folder, which need not exist yet.
    space : PlateColorSpace
        The colour space in the folder's config, before its exposure and primaries are known.
    plates : PlateOptions
        How the linear plates are written; `overwrite` holds for every file.
    lut_length : int
        Entries of the LUTs.
    earlier : EarlierRun
        What an earlier run has left in the folder.
    """

    files: OutputFiles
    space: PlateColorSpace
    plates: PlateOptions
    lut_length: int
    earlier: EarlierRun = field(default_factory=EarlierRun)


def plan_outputs(folder: Path, photos: Sequence[Path], plates: PlateOptions, outputs: OutputOptions) -> OutputPlan:
    """Return which files are written for photographs of one response, after checking that they can be; create nothing.

    Parameters
    ----------
    folder : Path
        The folder to write to.
    photos : sequence of Path
        The photographs; at least one.
    plates : PlateOptions
        How the linear plates are written; `overwrite` holds for every file.
    outputs : OutputOptions
        Which files there are beside the LUTs, and how long the LUTs are.

    Raises
    ------
    PlateError
        If a file cannot be written or would replace another, or a photograph (see `check_outputs`), or two photographs
        would have one linear plate.
    ConfigError
        If the colour space cannot be in a config.
    """
    files = OutputFiles.named(folder, photos, outputs)
    check_distinct(zip(files.linear, photos, strict=False), remedy="add --no-linear")  # without linear plates, no pairs
    check_outputs(folder, [files], photos=photos, overwrite=plates.overwrite)
    space = PlateColorSpace.from_outputs(files, photos[0])
    portable_config([space])
    return OutputPlan(files, space, plates, outputs.lut_length, EarlierRun.in_folder(files, photos))


def left_files(files: OutputFiles, photos: Sequence[Path], *, is_measured: bool = False) -> tuple[Path, ...]:
    """Return those files of an earlier run of the same name that this one does not write.

    `a_forward.cube` is none of `a` if there is `a_forward.json`: it belongs to the photograph `a_forward`.

    Parameters
    ----------
    files : OutputFiles
        What is written, before it is.
    photos : sequence of Path
        The photographs after which the files are named.
    is_measured : bool
        Whether they are those of a measurement, which has no linear EXR and no LUT from light to code values.
    """
    if not files.report.exists():
        return ()
    most = OutputOptions(has_linear=not is_measured, has_forward=not is_measured)
    every = OutputFiles.named(files.report.parent, photos, most).own
    kept = {*files.own, *(photo.absolute() for photo in photos)}
    there = (path for path in every if path.exists() and not kept & {path, path.absolute()})
    return tuple(path for path in there if not path.with_suffix(".json").exists())


def _dropped_spaces(files: OutputFiles) -> tuple[str, ...]:
    """Return the colour spaces of other plates in the config that is there; none if it cannot be read."""
    with suppress(UnicodeError):  # a name, or the error's text, may be no UTF-8
        plates = plates_in_config(loaded_or_empty(files.config))
        return tuple(plate.name for plate in plates if plate.name != files.color_space)
    return ()


def write_outputs(plan: OutputPlan, estimated: PhotographEstimate) -> dict[str, Any]:
    """Write every file of a plan and return the document that its JSON file holds.

    Parameters
    ----------
    plan : OutputPlan
        See `plan_outputs`.
    estimated : PhotographEstimate
        The estimate from the photographs of the plan.

    Raises
    ------
    CRFNetError
        If a file cannot be written, a photograph has changed or gone, the LUT length is out of range, photographs of
        one estimate differ in their primaries, or these are unknown and have to be converted. The folder is then as it
        was: either all files are written, or none.
    """
    light = estimated_light(estimated, plan.plates, lut_length=plan.lut_length)
    config = portable_config([with_light(plan.space, light.stops, light.plate, light.space)])
    folder = plan.files.report.parent
    with output_folder(folder), staged_files(folder, overwrite=plan.plates.overwrite) as staged:
        files = plan.files.in_folder(staged)
        document = write_estimate(files, estimated, light, plan.plates)
        write_config(files.config, config, check={files.color_space: light.lut.channels[0]})
    return document


def estimated_light(estimated: PhotographEstimate, plates: PlateOptions, *, lut_length: int) -> PlateLight:
    """Return what the linear values of an estimate's photographs mean; the LUT's comments say its primaries, too.

    Raises
    ------
    CRFNetError
        If the LUT length is out of range, the photographs differ in their primaries, or these are unknown and have to
        be converted.
    """
    tags = dict(zip(estimated.paths, estimated.tags, strict=True))
    plate = common_primaries(tags, plates.primaries)
    lut = response_lut(estimated.estimate, length=lut_length)
    comment = f"Primaries: {plate}; the LUT leaves them as they are"
    return PlateLight.of(estimated.tags[0], replace(lut, comments=(*lut.comments, comment)), plates)


def with_light(space: PlateColorSpace, stops: float, plate: PlatePrimaries, linear: LinearSpace) -> PlateColorSpace:
    """Return a plate's colour space with its exposure, its primaries, and those of its linear files.

    Unknown primaries of the plate are taken for Rec.709.
    """
    treated = "" if plate.primaries else ", treated as Rec.709"
    return replace(
        space,
        exposure=stops,
        primaries=plate.primaries or REC709,
        linear_primaries=linear.target,
        description=f"{space.description}; primaries {plate}{treated}",
    )


def write_estimate(
    files: OutputFiles, estimated: PhotographEstimate, light: PlateLight, plates: PlateOptions
) -> dict[str, Any]:
    """Write the files of one estimate, except the config, and return the document of its JSON file.

    Parameters
    ----------
    files : OutputFiles
        Their names; none of them exists, as in a folder of `crfnet.staging.staged_files`.
    estimated : PhotographEstimate
        The estimate.
    light : PlateLight
        As `estimated_light` returns it.
    plates : PlateOptions
        How the linear plates are written.

    Raises
    ------
    CRFNetError
        If a file cannot be written, or a photograph has changed or gone.
    """
    with ThreadPoolExecutor(1) as pool:  # OpenEXR compresses without Python, which draws the sheet meanwhile
        linear = pool.submit(_write_linear, files, estimated, light, plates) if files.linear else None
        for path in files.luts:
            write_lut(path, light.lut)
        if files.forward:
            forward = forward_lut(light.lut)
            for path in files.forward:
                write_lut(path, forward)
        if files.sheet:
            _write_sheet(files.sheet, estimated)
        if linear:
            linear.result()
    document = estimate_document(estimated.estimate, estimated.facts, files, light)
    document |= {"known_cameras": list(map(asdict, estimated.offers))} if estimated.offers else {}
    document |= {"movies": list(estimated.movies)} if estimated.movies else {}
    atomic_write_text(files.report, json_text(document), error=PlateError)
    return document


def _write_linear(files: OutputFiles, estimated: PhotographEstimate, light: PlateLight, plates: PlateOptions) -> None:
    """Write the linear plates; each photograph is read again: see `estimate_photographs`."""
    for plate, linear in zip(estimated.plates, files.linear, strict=True):
        linearize_plates(plate, (linear,), light.lut, plates)


def _write_sheet(path: Path, estimated: PhotographEstimate) -> None:
    """Draw the sheet; matplotlib, an optional dependency that loads slowly, is imported only for it."""
    from ..report.sheet import draw_sheet

    draw_sheet(path, estimated.preview, estimated.estimate, stride=estimated.stride)
