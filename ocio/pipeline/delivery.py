"""Plan the files of an estimate, and write them: LUTs, a config, linear plates, a sheet and a JSON document.

The command and the add-on write with `deliver`: all files of a plan appear together, or the folder is as it was.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from crfnet_core.colorimetry import REC709
from crfnet_core.files import atomic_write_text, check_target, json_text
from crfnet_core.staging import staged_files
from crfnet_core.types import Progress

from ..configs.files import loaded_or_empty, write_config
from ..configs.plate_color_space import PlateColorSpace
from ..configs.plates import plates_in_config
from ..configs.portable import portable_config
from ..errors import PlateError
from ..luts.files import write_lut
from ..luts.forward import forward_lut
from ..options import OutputOptions, PlateOptions
from ..output_files import OutputFiles, check_config_folder, check_folder, check_outputs, output_folder
from ..plates.frame_files import FrameSource
from ..plates.light import PlateLight
from ..plates.linear import linearize_plates
from ..plates.linear_space import LinearSpace
from ..plates.primaries import PlatePrimaries, common_primaries
from ..report import estimate_document
from .estimates import FileEstimate, response_lut
from .photographs import check_distinct

#: Writes linear frames: the arguments of `linearize_plates`.
Linearize = Callable[..., object]


@dataclass(frozen=True)
class EarlierRun:
    """The files and plates of an earlier run in a folder that a new run does not replace.

    Parameters
    ----------
    stale_files : tuple of Path
        Files of other options that stay there: see `stale_files`.
    lost_color_spaces : tuple of str
        Color spaces of other plates in the config that is replaced.
    """

    stale_files: tuple[Path, ...] = ()
    lost_color_spaces: tuple[str, ...] = ()

    @classmethod
    def in_folder(cls, files: OutputFiles, photos: Sequence[Path], *, is_measured: bool = False) -> EarlierRun:
        """Return what is there before the files are written; the arguments are those of `stale_files`."""
        return cls(stale_files(files, photos, is_measured=is_measured), _other_spaces(files))

    @property
    def document(self) -> dict[str, list[str]]:
        """The names for JSON; an empty list is absent."""
        names = {"left": [path.name for path in self.stale_files], "dropped": list(self.lost_color_spaces)}
        return {name: entries for name, entries in names.items() if entries}


@dataclass(frozen=True, eq=False)
class OutputPlan:
    """The files to be written into one folder, checked before any work is done.

    Parameters
    ----------
    files : OutputFiles
        Their names; the folder need not exist yet.
    plates : PlateOptions
        How the linear plates are written; `overwrite` holds for every file.
    lut_length : int
        Entries of the LUTs; 0 if none are written.
    space : PlateColorSpace or None
        The color space in the folder's config, before its exposure and primaries are known; None without a config.
    earlier : EarlierRun
        The remains of an earlier run in the folder.
    """

    files: OutputFiles
    plates: PlateOptions
    lut_length: int
    space: PlateColorSpace | None = None
    earlier: EarlierRun = field(default_factory=EarlierRun)

    @property
    def targets(self) -> tuple[Path, ...]:
        """The LUTs, the config and the linear plates."""
        luts = (*self.files.luts, *self.files.forward) if self.lut_length else ()
        return (*luts, *([self.files.config] if self.space else ()), *self.files.linear)


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
        If the color space cannot be in a config.
    """
    files = OutputFiles.named(folder, photos, outputs)
    check_distinct(zip(files.linear, photos, strict=False))  # without linear plates, no pairs
    check_outputs(folder, [files], photos=photos, overwrite=plates.overwrite)
    space = PlateColorSpace.from_outputs(files, photos[0])
    portable_config([space])
    return OutputPlan(files, plates, outputs.lut_length, space, EarlierRun.in_folder(files, photos))


def deliver_estimate(plan: OutputPlan, estimated: FileEstimate, light: PlateLight) -> dict[str, Any]:
    """Write every file of a plan, with the sheet and the JSON document; return the document.

    Parameters
    ----------
    plan : OutputPlan
        See `plan_outputs`.
    estimated : FileEstimate
        The estimate from the photographs of the plan; each is read again for its linear plate.
    light : PlateLight
        As `estimated_light` returns it.

    Raises
    ------
    CRFNetError
        If a file cannot be written, or a photograph has changed or gone.
    """
    files = plan.files
    document = estimate_document(estimated.estimate, [facts.report for facts in estimated.photographs], files, light)
    document |= {"known_cameras": list(map(asdict, estimated.offers))} if estimated.offers else {}
    document |= {"movies": list(estimated.movies)} if estimated.movies else {}

    def write_more(folder: Path) -> None:
        if files.sheet:
            _write_sheet(folder / files.sheet.name, estimated)
        atomic_write_text(folder / files.report.name, json_text(document), error=PlateError)

    more = [path for path in (files.sheet, files.report) if path]
    deliver(plan, light, [facts.plate for facts in estimated.firsts], more=more, write_more=write_more)
    return document


def deliver(
    plan: OutputPlan,
    light: PlateLight,
    sources: Sequence[FrameSource] = (),
    *,
    more: Sequence[Path] = (),
    write_more: Callable[[Path], None] | None = None,
    linearize: Linearize = linearize_plates,
    progress: Progress | None = None,
) -> tuple[Path, ...]:
    """Write the LUTs, the config and the linear plates of a plan; return the files.

    If one of them fails, or the progress callback raises, the folder is as it was.

    Parameters
    ----------
    plan : OutputPlan
        The files.
    light : PlateLight
        The response as a LUT, the exposure and the primaries.
    sources : sequence of FrameSource
        The plates of `plan.files.linear`: one file for each, or one sequence with all of them as its frames.
    more : sequence of Path
        Further files.
    write_more : callable, optional
        Writes these into the folder that it is called with.
    linearize : callable
        Writes linear frames, as `linearize_plates` does.
    progress : callable, optional
        Called with (done, total) after every linear frame, perhaps in another thread.

    Raises
    ------
    CRFNetError
        If a file exists and may not be replaced or cannot be written, or OpenColorIO refuses the config.
    """
    written = (*plan.targets, *more)
    if plan.space:
        check_config_folder(plan.files.config.parent)
    with all_or_none(written, overwrite=plan.plates.overwrite) as folder, ThreadPoolExecutor(1) as pool:
        files = plan.files.in_folder(folder)
        # OpenEXR compresses without Python, which draws the sheet meanwhile.
        linear = pool.submit(_write_linear, files.linear, sources, light, plan.plates, linearize, progress)
        _write_luts(files, plan, light)
        if write_more:
            write_more(folder)
        linear.result()
    return written


def _write_luts(files: OutputFiles, plan: OutputPlan, light: PlateLight) -> None:
    """Write the LUTs and the config that a plan has."""
    for path in files.luts if plan.lut_length else ():
        write_lut(path, light.lut)
    if files.forward:
        forward = forward_lut(light.lut)
        for path in files.forward:
            write_lut(path, forward)
    if plan.space:
        config = portable_config([with_light(plan.space, light.stops, light.plate, light.space)])
        write_config(files.config, config, check={files.color_space: light.lut.channels[0]})


def _write_linear(
    targets: Sequence[Path],
    sources: Sequence[FrameSource],
    light: PlateLight,
    plates: PlateOptions,
    linearize: Linearize,
    progress: Progress | None,
) -> None:
    """Write the linear plates: those of one sequence together, else each by itself."""
    if not targets:
        return
    if len(sources) == 1:
        linearize(sources[0], targets, light.lut, plates, progress=progress)
        return
    for source, target in zip(sources, targets, strict=True):
        linearize(source, (target,), light.lut, plates)


def _write_sheet(path: Path, estimated: FileEstimate) -> None:
    """Draw the sheet; matplotlib, an optional dependency that loads slowly, is imported only for it."""
    from ..report.sheet import draw_sheet

    first = estimated.photographs[0]
    draw_sheet(path, first.preview, estimated.estimate, stride=first.stride)


@contextmanager
def all_or_none(targets: Sequence[Path], *, overwrite: bool = False) -> Iterator[Path]:
    """Yield the folder that a block writes files to; if it succeeds, they take their names together.

    If it fails or is canceled, the folder of the targets is as it was, or gone if it was made for them.

    Parameters
    ----------
    targets : sequence of Path
        The files, all in one folder.
    overwrite : bool
        Whether existing files may be replaced.

    Raises
    ------
    CRFNetError
        If a file exists and may not be replaced, or the folder cannot be made or written to.
    """
    folder = targets[0].parent
    check_folder(folder)
    with ExitStack() as stack:
        try:
            stack.enter_context(output_folder(folder))
            for target in targets:
                check_target(target, overwrite=overwrite)
            temporary = stack.enter_context(staged_files(folder, overwrite=overwrite))
        except OSError as problem:  # such as on Windows, which does not say before what is not allowed
            raise PlateError("folder_not_written", path=folder, reason=problem.strerror or problem) from problem
        yield temporary


def stale_files(files: OutputFiles, photos: Sequence[Path], *, is_measured: bool = False) -> tuple[Path, ...]:
    """Return those files of an earlier run of the same name that this one does not write.

    `a_forward.cube` does not belong to `a` if there is `a_forward.json`: it belongs to the photograph `a_forward`.

    Parameters
    ----------
    files : OutputFiles
        The files to be written, before they are.
    photos : sequence of Path
        The photographs after which the files are named.
    is_measured : bool
        Whether they are those of a measurement, which has no linear EXR and no LUT from light to code values.
    """
    if not files.report.exists():
        return ()
    most = OutputOptions(has_linear=not is_measured, has_forward=not is_measured)
    every = OutputFiles.named(files.report.parent, photos, most).unshared
    known = {*files.unshared, *(photo.absolute() for photo in photos)}
    there = (path for path in every if path.exists() and not known & {path, path.absolute()})
    return tuple(path for path in there if not path.with_suffix(".json").exists())


def _other_spaces(files: OutputFiles) -> tuple[str, ...]:
    """Return the color spaces of other plates in the config that is there; none if it cannot be read."""
    with suppress(UnicodeError):  # a name, or the error's text, may not be UTF-8
        plates = plates_in_config(loaded_or_empty(files.config))
        return tuple(plate.name for plate in plates if plate.name != files.color_space)
    return ()


def estimated_light(estimated: FileEstimate, plates: PlateOptions, *, lut_length: int) -> PlateLight:
    """Return the meaning of the linear values of an estimate's photographs; the LUT's comments name its primaries, too.

    Raises
    ------
    CRFNetError
        If the LUT length is out of range, the photographs differ in their primaries, or these are unknown and have to
        be converted.
    """
    tags = {path: facts.tags for path, facts in zip(estimated.paths, estimated.firsts, strict=True)}
    plate = common_primaries(tags, plates.primaries)
    lut = response_lut(estimated.estimate, length=lut_length)
    comment = f"Primaries: {plate}; the LUT leaves them as they are"
    return PlateLight.of(estimated.firsts[0].tags, replace(lut, comments=(*lut.comments, comment)), plates)


def with_light(space: PlateColorSpace, stops: float, plate: PlatePrimaries, linear: LinearSpace) -> PlateColorSpace:
    """Return a plate's color space with its exposure, its primaries, and those of its linear files.

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
