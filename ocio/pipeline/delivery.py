"""The files of an estimate: LUTs, a config, linear plates, a sheet and a JSON document; planned, and then written.

The command and the add-on write with `deliver`: all files of a plan appear together, or the folder is as it was.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from crfnet_core.colorimetry import REC709
from crfnet_core.files import atomic_write_text, json_text
from crfnet_core.locks import locked_folder
from crfnet_core.types import Progress

from ..configs.files import write_config
from ..configs.plate_color_space import PlateColorSpace, lost_plates
from ..configs.portable import portable_config
from ..errors import PlateError
from ..luts.files import write_lut
from ..luts.forward import forward_lut
from ..luts.rgb_lut import AnyLut
from ..options import OutputOptions, PlateOptions
from ..output_files import OutputFiles, all_or_none, check_config_folder, check_targets, folded
from ..plates.frame_files import FrameSource
from ..plates.light import PlateLight
from ..plates.linear import linearize_plates
from ..plates.primaries import LinearSpace, PlatePrimaries, common_primaries
from ..report.documents import estimate_document
from .estimates import FileEstimate, response_lut


@dataclass(frozen=True, eq=False)
class OutputPlan:
    """The files to be written into one folder, which need not exist yet."""

    files: OutputFiles
    plates: PlateOptions  # how linear plates are written; `overwrite` holds for every file
    space: PlateColorSpace | None = None  # without its exposure and primaries; None without a config
    sequence: str = ""  # the names of all frames, if the photographs are some of a sequence, as in a file rule

    @property
    def targets(self) -> tuple[Path, ...]:
        """The LUTs, the config and the linear plates."""
        config = [self.files.config] if self.space else []
        return (*self.files.luts, *self.files.forward, *config, *self.files.linear)


def plan_outputs(
    folder: Path, photos: Sequence[Path], plates: PlateOptions, outputs: OutputOptions, *, sequence: str = ""
) -> OutputPlan:
    """Return which files are written for photographs of one response, after checking that they can be; create nothing.

    `sequence` is the pattern of their sequence: see `sequence_of`. Raise as `plan_files`, and a PlateError if two
    photographs would have one linear plate.
    """
    files = OutputFiles.named(folder, photos, outputs)
    owners: dict[str, Path] = {}
    for target, photo in zip(files.linear, photos, strict=False):  # without linear plates, no pairs
        if (other := owners.setdefault(folded(target.name), photo)) != photo:
            raise PlateError("one_name", first=other, second=photo, name=target.name)
    space = PlateColorSpace.from_outputs(files, photos[0], file_pattern=sequence)
    return replace(plan_files(files, photos, plates, space), sequence=sequence)


def plan_files(files: OutputFiles, photos: Sequence[Path], plates: PlateOptions, space: PlateColorSpace) -> OutputPlan:
    """Return the plan of files with a config, after checking as `check_targets` that they can be written.

    Create nothing. Raise ConfigError if the color space cannot be in a config.
    """
    targets, configs = files.unshared, [files.config]
    check_targets(files.report.parent, targets, photos=photos, configs=configs, overwrite=plates.overwrite)
    portable_config([space])
    return OutputPlan(files, plates, space)


def deliver_estimate(plan: OutputPlan, estimated: FileEstimate, light: PlateLight) -> tuple[dict[str, Any], list[str]]:
    """Write every file of a plan, with the sheet and the JSON document; return the document, and what `deliver` does.

    `light` is from `estimated_light`. Each photograph is read again for its linear plate. Raise CRFNetError if a file
    cannot be written, or a photograph has changed or gone.
    """
    files = plan.files
    document = estimate_document(estimated.estimate, [facts.entry for facts in estimated.photographs], files, light)
    document |= {"known_cameras": list(map(asdict, estimated.offers))} if estimated.offers else {}
    document |= {"movies": list(estimated.movies)} if estimated.movies else {}
    document |= {"sequence": plan.sequence} if plan.sequence else {}
    more: dict[Path, Callable[[Path], None]] = {
        files.report: lambda path: atomic_write_text(path, json_text(document), error=PlateError)
    }
    if files.sheet:
        more[files.sheet] = lambda path: _write_sheet(path, estimated)
    return document, deliver(plan, light, [facts.plate for facts in estimated.firsts], more=more)


def deliver(
    plan: OutputPlan,
    light: PlateLight,
    sources: Sequence[FrameSource] = (),
    *,
    more: Mapping[Path, Callable[[Path], None]] | None = None,
    progress: Progress | None = None,
) -> list[str]:
    """Write the files of a plan, and `more` by their writers; return the color spaces that its config no longer has.

    `sources` are the plates of `plan.files.linear`: one file for each, or one sequence of them, whose frames `progress`
    counts, perhaps in another thread. Raise CRFNetError if a file cannot be written or OpenColorIO refuses the config;
    then, and if the callback raises, the folder is as it was.
    """
    more = more or {}
    if plan.space:
        check_config_folder(plan.files.config.parent)
    with staged_plan(plan, (*plan.targets, *more)) as (folder, lost), ThreadPoolExecutor(1) as pool:
        # OpenEXR compresses without Python, which draws the sheet meanwhile.
        linear = pool.submit(_write_linear, folder, plan, sources, light, progress)
        space = plan.space and with_light(plan.space, light.stops, light.plate, light.space)
        write_luts(folder, plan.files, light.lut, space)
        for path, write in more.items():
            write(folder / path.name)
        linear.result()
    return lost


@contextmanager
def staged_plan(plan: OutputPlan, targets: Sequence[Path]) -> Iterator[tuple[Path, list[str]]]:
    """Yield the folder to which a block writes the files of a plan: see `all_or_none`; and an empty list.

    Once the files have their names, it holds the color spaces of other plates that the config no longer has.
    """
    lost = list[str]()
    with ExitStack() as until_named, all_or_none(targets, overwrite=plan.plates.overwrite) as folder:
        yield folder, lost
        until_named.enter_context(locked_folder(folder.parent))
        lost += lost_plates(plan.files.config, [plan.files.color_space]) if plan.space else []


def write_luts(folder: Path, files: OutputFiles, lut: AnyLut, space: PlateColorSpace | None) -> None:
    """Write the LUTs in all formats, and a config with a color space if there is one."""
    for path in files.luts:
        write_lut(folder / path.name, lut)
    if files.forward:
        forward = forward_lut(lut)
        for path in files.forward:
            write_lut(folder / path.name, forward)
    if space:
        check = {files.color_space: lut.channels[0]}
        write_config(folder / files.config.name, portable_config([space]), check=check)


def _write_linear(
    folder: Path, plan: OutputPlan, sources: Sequence[FrameSource], light: PlateLight, progress: Progress | None
) -> None:
    """Write the linear plates: one sequence together, else each by itself."""
    targets = [folder / path.name for path in plan.files.linear]
    if not targets:
        return
    if len(sources) == 1:
        linearize_plates(sources[0], targets, light.lut, plan.plates, progress=progress)
        return
    for source, target in zip(sources, targets, strict=True):
        linearize_plates(source, (target,), light.lut, plan.plates)


def _write_sheet(path: Path, estimated: FileEstimate) -> None:
    """Draw the sheet; matplotlib, an optional dependency that loads slowly, is imported only for it."""
    from ..report.sheet import draw_sheet

    first = estimated.photographs[0]
    draw_sheet(path, first.preview, estimated.estimate, stride=first.stride)


def estimated_light(estimated: FileEstimate, plates: PlateOptions) -> PlateLight:
    """Return the meaning of the linear values of an estimate's photographs; the LUT's comments name its primaries, too.

    Raise CRFNetError if the photographs differ in their primaries, or these are unknown and have to be converted.
    """
    tags = {facts.plate.paths[0]: facts.tags for facts in estimated.firsts}
    plate = common_primaries(tags, plates.primaries)
    lut = response_lut(estimated.estimate)
    comment = f"Primaries: {plate}; the LUT leaves them as they are"
    return PlateLight.from_tags(estimated.firsts[0].tags, replace(lut, comments=(*lut.comments, comment)), plates)


def with_light(space: PlateColorSpace, stops: float, plate: PlatePrimaries, linear: LinearSpace) -> PlateColorSpace:
    """Return a plate's color space with its exposure, its primaries (Rec.709 if unknown), and its linear primaries."""
    treated = "" if plate.primaries else ", treated as Rec.709"
    return replace(
        space,
        exposure=stops,
        primaries=plate.primaries or REC709,
        linear_primaries=linear.target,
        description=f"{space.description}; primaries {plate}{treated}",
    )
