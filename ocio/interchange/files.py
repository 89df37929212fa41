"""Read or write a response in any known file; the suffix names the format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..errors import LutError
from ..luts.files import WRITERS, read_lut, write_lut
from ..luts.rgb_lut import AnyLut
from .dorf import read_dorf, write_dorf
from .hugin import read_hugin, write_hugin
from .opencv import read_opencv, write_opencv
from .other_luts import read_other_lut
from .pfstools import read_pfstools, write_pfstools
from .response_file import ResponseFile, described, from_lut

#: Suffixes of files that may hold several responses; the reader takes the name of one.
SEVERAL: dict[str, Callable[..., ResponseFile]] = {".txt": read_dorf, ".pto": read_hugin}

#: The reader of each other format, by suffix.
RESPONSE_READERS: dict[str, Callable[[Path], ResponseFile]] = {
    ".npy": read_opencv,
    ".yml": read_opencv,
    ".yaml": read_opencv,
    ".xml": read_opencv,
    ".m": read_pfstools,
    ".csp": read_other_lut,
    ".3dl": read_other_lut,
    ".lut": read_other_lut,
}

#: The writer of each format of other programs, by suffix.
RESPONSE_WRITERS: dict[str, Callable[..., tuple[str, ...]]] = {
    ".npy": write_opencv,
    ".yml": write_opencv,
    ".yaml": write_opencv,
    ".xml": write_opencv,
    ".m": write_pfstools,
    ".txt": write_dorf,
    ".pto": write_hugin,
}

#: Every suffix that can be read, and every one that can be written.
READABLE = (*WRITERS, *RESPONSE_READERS, *SEVERAL)
WRITABLE = (*WRITERS, *RESPONSE_WRITERS)


def read_response(path: str | Path, *, curve: str = "") -> ResponseFile:
    """Return the response in a file, as its inverse.

    Parameters
    ----------
    path : str or Path
        The file; its suffix, in lower or upper case, is one of `READABLE`.
    curve : str
        Which response of a file that holds several: the name or number of a curve, the number of a Hugin image.

    Raises
    ------
    LutError
        If the suffix is another one, `curve` is given for a format of one response, or as the reader raises it.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in READABLE:
        raise LutError(f"{path}: responses are read from {', '.join(READABLE)}; found {suffix or 'no suffix'!r}")
    if suffix in SEVERAL:
        return SEVERAL[suffix](path, curve=curve)
    if curve:
        raise LutError(f"{path}: holds one response, so there is no {curve!r} to choose; leave --curve out")
    if suffix in RESPONSE_READERS:
        return RESPONSE_READERS[suffix](path)
    found = from_lut(read_lut(path), f"LUT of the format {suffix}")
    return described(path, found) if found.was_forward else found


def write_response(path: str | Path, lut: AnyLut, *, overwrite: bool = False) -> tuple[str, ...]:
    """Write an inverse response in any known format, and return what is to be said of the file.

    Parameters
    ----------
    path : str or Path
        The file; its suffix is one of `WRITABLE`. A Hugin project must exist already.
    lut : Lut1D or RgbLut1D
        The inverse response.
    overwrite : bool
        Whether an existing file may be replaced or changed.

    Raises
    ------
    LutError
        If the suffix is another one, or as the writer raises it.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in WRITERS:
        write_lut(path, lut, overwrite=overwrite)
        return ()
    if suffix not in RESPONSE_WRITERS:
        raise LutError(f"{path}: responses are written as {', '.join(WRITABLE)}; found {suffix or 'no suffix'!r}")
    return RESPONSE_WRITERS[suffix](path, lut, overwrite=overwrite)
