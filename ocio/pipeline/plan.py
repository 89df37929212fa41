"""Plan the files of an estimate: which there are, whether they may be written, and what an earlier run has left."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from ..configs.files import load_config
from ..configs.plate_color_space import PlateColorSpace, plates_in_config
from ..configs.portable import portable_config
from ..errors import ConfigError
from ..options import OutputOptions, PlateOptions
from ..output_files import OutputFiles, check_outputs
from .photographs import check_distinct


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
    with suppress(ConfigError, UnicodeError):  # a name, or the error's text, may not be UTF-8
        plates = plates_in_config(load_config(files.config))
        return tuple(plate.name for plate in plates if plate.name != files.color_space)
    return ()
