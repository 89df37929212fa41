"""LUT files by their suffix."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from crfnet_core.errors import LutError
from ocio.luts.clf import read_clf, write_clf
from ocio.luts.cube import read_cube, write_cube
from ocio.luts.lut1d import Lut1D
from ocio.luts.spi1d import read_spi1d, write_spi1d

#: The readers of LUT files, by suffix.
READERS: dict[str, Callable[[str | Path], Lut1D]] = {".spi1d": read_spi1d, ".cube": read_cube, ".clf": read_clf}

#: The writers of LUT files, by suffix.
WRITERS: dict[str, Callable[..., None]] = {".spi1d": write_spi1d, ".cube": write_cube, ".clf": write_clf}


def read_lut(path: str | Path) -> Lut1D:
    """Return the LUT of a .spi1d, .cube or .clf file.

    Parameters
    ----------
    path : str or Path
        The file; its suffix, in any case, names the format.

    Raises
    ------
    LutError
        If the suffix is another one, or as the reader of the format.
    """
    return READERS[_known_suffix(path)](path)


def write_lut(path: str | Path, lut: Lut1D, *, overwrite: bool = False) -> None:
    """Write a LUT as .spi1d, .cube or .clf.

    Parameters
    ----------
    path : str or Path
        The file to be written; its suffix, in any case, names the format.
    lut : Lut1D
        The table.
    overwrite : bool
        Whether an existing file may be replaced.

    Raises
    ------
    LutError
        If the suffix is another one, or as the writer of the format.
    """
    WRITERS[_known_suffix(path)](path, lut, overwrite=overwrite)


def _known_suffix(path: str | Path) -> str:
    """Return the suffix in lower case; a LutError if no format has it."""
    suffix = Path(path).suffix.lower()
    if suffix not in READERS:
        raise LutError(f"{path}: LUT files end in {', '.join(READERS)}, found {suffix or 'no suffix'!r}; rename it")
    return suffix
