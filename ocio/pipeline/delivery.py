"""What is made of one LUT: linear frames, or LUT files and a config. Either all files are written, or none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from crfnet_core.files import check_target
from crfnet_core.types import Progress
from ocio.configs.files import write_config
from ocio.configs.plate_color_space import PlateColorSpace
from ocio.configs.portable import portable_config
from ocio.luts.files import write_lut
from ocio.luts.lut1d import Lut1D
from ocio.options import PlateOptions
from ocio.output_files import OutputFiles, check_folder, new_files_removed_on_failure, output_folder
from ocio.plates.frames import FrameSequence
from ocio.plates.linear import linearize_plates


def bake_plates(
    sequence: FrameSequence,
    targets: Sequence[Path],
    lut: Lut1D,
    options: PlateOptions,
    *,
    progress: Progress | None = None,
) -> None:
    """Write the linear EXR of every frame, or none: new files are removed if a frame fails or the run is cancelled.

    `linearize_plates` on its own leaves existing targets alone and keeps finished frames, so that it can be resumed.

    Parameters
    ----------
    sequence : FrameSequence
        The plates, as `find_frames` returns them.
    targets : sequence of Path
        The files to be written, all in one folder, as `linear_targets` returns them; the folder is made if need be.
    lut : Lut1D
        The inverse response.
    options : PlateOptions
        Sample type, exposure, and whether existing files may be replaced.
    progress : callable or None
        Called with (done, total) after every frame; whatever it raises cancels the run.

    Raises
    ------
    CRFNetError
        If a target exists and may not be replaced, the folder cannot be written to, or a frame fails.
    """
    with all_or_none(targets, overwrite=options.overwrite):
        linearize_plates(sequence, targets, lut, options, progress=progress)


def export_luts(files: OutputFiles, space: PlateColorSpace, lut: Lut1D, *, overwrite: bool = False) -> tuple[Path, ...]:
    """Write a LUT in three formats and a portable config with its colour space; return the files.

    If one of them fails, new files are removed again.

    Parameters
    ----------
    files : OutputFiles
        Their names: `luts` and `config`. The folder is made if need be.
    space : PlateColorSpace
        The colour space, as `files.plate_color_space` returns it.
    lut : Lut1D
        The inverse response.
    overwrite : bool
        Whether existing files may be replaced.

    Raises
    ------
    CRFNetError
        If a file exists and may not be replaced, or cannot be written, or OpenColorIO refuses the config.
    """
    written = (*files.luts, files.config)
    with all_or_none(written, overwrite=overwrite):
        for path in files.luts:
            write_lut(path, lut, overwrite=overwrite)
        write_config(files.config, portable_config([space]), check={space.name: lut}, overwrite=overwrite)
    return written


@contextmanager
def all_or_none(targets: Sequence[Path], *, overwrite: bool = False) -> Iterator[None]:
    """Make the folder of files for a block that writes them; if it fails or is cancelled, remove what is new.

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
    with output_folder(folder):
        for target in targets:
            check_target(target, overwrite=overwrite)
        with new_files_removed_on_failure(targets):
            yield
