"""Read or write a LUT file; its suffix names the format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..errors import LutError
from .agreement import check_agreement
from .clf import read_clf, write_clf
from .cube import read_cube, write_cube
from .rgb_lut import AnyLut
from .spi1d import read_spi1d, write_spi1d

#: The reader of each format, by suffix.
READERS: dict[str, Callable[[str | Path], AnyLut]] = {".spi1d": read_spi1d, ".cube": read_cube, ".clf": read_clf}

#: The writer of each format, by suffix.
WRITERS: dict[str, Callable[..., None]] = {".spi1d": write_spi1d, ".cube": write_cube, ".clf": write_clf}


def read_lut(path: str | Path) -> AnyLut:
    """Return the LUT in a .spi1d, .cube or .clf file, as OpenColorIO reads it too.

    Parameters
    ----------
    path : str or Path
        The file; its suffix, in lower or upper case, names the format.

    Raises
    ------
    LutError
        If the suffix is another one, as the reader of the format raises it, and if OpenColorIO refuses the file or
        reads another table in it.
    """
    lut = READERS[_known_suffix(path)](path)
    check_agreement(Path(path), lut)
    return lut


def write_lut(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> None:
    """Write a LUT as .spi1d, .cube or .clf.

    Parameters
    ----------
    path : str or Path
        The file to be written; its suffix, in lower or upper case, names the format.
    lut : Lut1D or RgbLut1D
        The table.
    overwrite : bool
        Whether an existing file may be replaced.

    Raises
    ------
    LutError
        If the suffix is another one, and as the writer of the format raises it.
    """
    WRITERS[_known_suffix(path)](path, lut, overwrite=overwrite)


def _known_suffix(path: str | Path) -> str:
    """Return the suffix in lower case; raise a LutError if no format has it."""
    suffix = Path(path).suffix.lower()
    if suffix not in READERS:
        raise LutError(f"{path}: LUT files end in {', '.join(READERS)}, found {suffix or 'no suffix'!r}; rename it")
    return suffix
