"""Plan the files of an estimate: which there are, and whether they may be written; and let them appear together."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from crfnet_core.locks import locked_folder

from ..configs.plate_color_space import PlateColorSpace, lost_plates
from ..configs.portable import portable_config
from ..errors import PlateError
from ..options import OutputOptions, PlateOptions
from ..output_files import OutputFiles, all_or_none, check_targets, folded


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
