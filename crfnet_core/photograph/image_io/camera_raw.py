"""Tell camera raw by name and by content: many raw files are TIFF with a small preview in front."""

from __future__ import annotations

import struct
from pathlib import Path

#: Suffixes of camera raw. Some of these files are read as their small preview, which must not pass for the photograph.
RAW_SUFFIXES = (
    ".3fr .ari .arw .cr2 .cr3 .crw .dcr .dng .erf .fff .iiq .kdc .mef .mos .mrw .nef .nrw .orf .pef .raf .rw2 .rwl"
    " .sr2 .srf .srw .x3f"
)

#: How raw files begin that are no plain TIFF: Fujifilm, Olympus, Panasonic, Minolta, Sigma.
RAW_SIGNATURES = (b"FUJIFILMCCD", b"IIRO", b"IIRS", b"MMOR", b"IIU\0", b"\0MRM", b"FOVb")

#: Tags of TIFF (TIFF 6.0, DNG 1.7): NewSubfileType, whose bit 0 marks a reduced picture; SubIFDs; DNGVersion.
_SUBFILE_TYPE, _SUB_DIRECTORIES, _DNG_VERSION = 254, 330, 50706

#: Directories longer than this are damaged.
_MOST_ENTRIES = 4096


def is_raw_name(path: Path) -> bool:
    """Return whether the suffix is one of camera raw."""
    return path.suffix.lower() in RAW_SUFFIXES.split()


def is_raw_content(path: Path, head: bytes) -> bool:
    """Return whether a file is camera raw, whatever its name.

    A TIFF file is if it says so (DNG, Canon's CR2), or if its first picture is a reduced one and larger ones hang below
    it, as in NEF, ARW and others.

    Parameters
    ----------
    path : Path
        The file.
    head : bytes
        Its first 12 bytes.
    """
    if head.startswith(RAW_SIGNATURES) or (head[8:10] == b"CR" and head.startswith((b"II*\0", b"MM\0*"))):
        return True
    if not head.startswith((b"II*\0", b"MM\0*")):
        return False
    entries = _first_directory(path, "<" if head.startswith(b"II") else ">")
    is_reduced = bool(entries.get(_SUBFILE_TYPE, 0) & 1)
    return _DNG_VERSION in entries or (is_reduced and _SUB_DIRECTORIES in entries)


def _first_directory(path: Path, order: str) -> dict[int, int]:
    """Return tag -> value, or where the values stand, of a TIFF's first directory; empty if it is damaged."""
    with path.open("rb") as file:
        file.seek(4)
        start = file.read(4)
        if len(start) < 4:
            return {}
        file.seek(*struct.unpack(order + "I", start))
        count = file.read(2)
        number = struct.unpack(order + "H", count)[0] if len(count) == 2 else 0
        content = file.read(12 * min(number, _MOST_ENTRIES))
    entries = (content[at : at + 12] for at in range(0, len(content) - 11, 12))
    return {struct.unpack_from(order + "H", entry)[0]: _value(entry, order) for entry in entries}


def _value(entry: bytes, order: str) -> int:
    """Return the number in a directory's entry: 16 bits for SHORT, else 32."""
    is_short = struct.unpack_from(order + "H", entry, 2)[0] == 3
    return int(struct.unpack_from(order + ("H" if is_short else "I"), entry, 8)[0])
