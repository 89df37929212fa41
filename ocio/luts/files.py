"""Read or write a LUT file; its suffix names the format."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.files import atomic_write_text

from ..errors import LutError
from .clf import clf_text
from .cube import cube_text
from .opencolorio import read_lut
from .rgb_lut import AnyLut
from .spi1d import spi1d_text

__all__ = ["WRITERS", "LutFormat", "read_lut", "write_lut"]


@dataclass(frozen=True)
class LutFormat:
    """A format that LUTs are written in.

    Parameters
    ----------
    suffix : str
        The suffix of its files, in lower case.
    title : str
        Its name in words.
    text : callable
        Returns a LUT as the text of a file, the comments of the LUT included; the same LUT gives the same text.
    """

    suffix: str
    title: str
    text: Callable[[AnyLut], str]


#: The formats that are written, by suffix; each estimate writes all of them, and configs name the first.
WRITERS = {
    each.suffix: each
    for each in (
        LutFormat(".spi1d", "Sony Imageworks 1D", spi1d_text),
        LutFormat(".cube", "Adobe and Resolve 1D cube", cube_text),
        LutFormat(".clf", "Academy Common LUT Format", clf_text),
    )
}


def write_lut(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> None:
    """Write a LUT in one of the formats of `WRITERS`.

    Parameters
    ----------
    path : str or Path
        The file to be written; its suffix, in lower or upper case, names the format.
    lut : Lut1D or RgbLut1D
        The table; nine digits keep its float32 values bit for bit.
    overwrite : bool
        Whether an existing file may be replaced.

    Raises
    ------
    LutError
        If no format has the suffix, the file exists and may not be replaced, or it cannot be written.
    """
    path = Path(path)
    if path.suffix.lower() not in WRITERS:
        raise LutError("lut_suffix", path=path, suffixes=", ".join(WRITERS))
    atomic_write_text(path, WRITERS[path.suffix.lower()].text(lut), overwrite=overwrite, error=LutError)
