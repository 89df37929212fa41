"""The directories of TIFF files and of EXIF, which is one; Pillow would load values of any claimed size."""

from collections.abc import Callable
from functools import partial
from typing import BinaryIO

#: Tags that lead to EXIF and to the InteroperabilityIndex; the type of a value of two bytes; the most entries read.
_EXIF, _INTEROP, _INTEROP_INDEX, _SHORT, _MOST_ENTRIES = 34665, 40965, 1, 3, 4096

_SOFTWARE, _LONGEST = 305, 200  # the tag of the program that wrote the file last; bytes of its name that are read


def tiff_directory(file: BinaryIO, *tags: int) -> dict[int, int]:
    """Return tag -> value, or its place, of the first directory of TIFF or EXIF, or of that where `tags` lead."""
    file.seek(0)
    head = file.read(16)
    number = partial(int.from_bytes, byteorder="little" if head.startswith(b"II") else "big")
    width = 8 if b"+" in head[2:4] else 4  # of places and values: BigTIFF has 8 bytes
    directory = _entries(file, number(head[width : 2 * width]), width, number)
    for tag in tags:
        directory = _entries(file, directory[tag], width, number) if tag in directory else {}
    return directory


def interop_index(file: BinaryIO) -> str:
    """Return the InteroperabilityIndex of EXIF or a TIFF file, such as "R98"; empty if it is absent or damaged."""
    index = tiff_directory(file, _EXIF, _INTEROP).get(_INTEROP_INDEX, 0)
    file.seek(0)
    text = index.to_bytes(8, "little" if file.read(2) == b"II" else "big").strip(b"\0").decode("latin-1")
    return text if text.isalnum() else ""


def exif_software(file: BinaryIO) -> str:
    """Return Software of EXIF or a TIFF file; empty if it is absent or shorter than four characters."""
    place = tiff_directory(file).get(_SOFTWARE, 0)
    file.seek(min(place, 2**62))
    return file.read(_LONGEST if place else 0).partition(b"\0")[0].decode(errors="replace")


def _entries(file: BinaryIO, place: int, width: int, number: Callable[[bytes], int]) -> dict[int, int]:
    """Return tag -> value, or its place, of the directory at a place; none at 0, where the file begins."""
    file.seek(min(place, 2**62))
    count = number(file.read(8 if width == 8 else 2)) if place else 0
    size = 4 + 2 * width  # of an entry: its tag, its type, the number of values, and the value or its place
    content = file.read(size * min(count, _MOST_ENTRIES))
    directory = {}
    for at in range(0, len(content) - size + 1, size):
        tag, kind = (number(content[begin : begin + 2]) for begin in (at, at + 2))
        value = content[at + 4 + width : at + size]
        directory[tag] = number(value[:2] if kind == _SHORT else value)
    return directory
