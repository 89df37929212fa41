"""Find files that are cut short, by the size or the end that their container states; FFmpeg reads them as whole.

Sources: AVI and OpenDML; Advanced Systems Format (3.2); Adobe Flash Video (E.5); SMPTE ST 377-1 (7.1); RFC 3533 (6);
ISO/IEC 14496-12 (8.8 and 8.16.3: fragments and their index).
"""

import os
import re
import struct
from pathlib import Path
from typing import BinaryIO

from .library import QUICKTIME_BOXES

#: The most boxes that are looked at: an hour of fragments of one frame has 200 000.
MOST_BOXES = 250_000

#: Bytes in which a header, or the last page of an Ogg file, begins.
_REACH = 2**16

#: The field of a header that holds the file's size (Windows Media, Flash) or where its last part begins (MXF), behind
#: its key and other fields, and its type for `struct`.
_FIELDS = (
    (re.compile(rb"\xa1\xdc\xab\x8c\x47\xa9\xcf\x11\x8e\xe4\x00\xc0\x0c\x20\x53\x65.{24}(.{8})", re.DOTALL), "<Q"),
    (re.compile(rb"\AFLV.*\0\x08filesize\0(.{8})", re.DOTALL), ">d"),
    (re.compile(rb"\A\x06\x0e\x2b\x34\x02\x05\x01\x01.{8}(?:\x83.{3}|\x87.{7}|.).{24}(.{8})", re.DOTALL), ">Q"),
)


def is_cut_short(path: Path) -> bool:
    """Return whether a file ends before it says; False for a container that does not say."""
    with path.open("rb") as file:
        head = file.read(_REACH)
        size = file.seek(0, os.SEEK_END)
        if head.startswith(b"OggS"):
            return not _has_last_page(file, size)
        if head.startswith(b"RIFF"):
            return _end_of_riff(file) > size
        if head[4:8] in QUICKTIME_BOXES:
            return _lacks_fragments(file, size)
    fields = ((pattern.search(head), form) for pattern, form in _FIELDS)
    return any(field and struct.unpack(form, field[1])[0] > size for field, form in fields)


def _has_last_page(file: BinaryIO, size: int) -> bool:
    """Return whether the last page of an Ogg file is whole, and the last of its stream: a bit of its flags."""
    file.seek(max(0, size - _REACH))
    page = file.read().rpartition(b"OggS")[2].ljust(23, b"\0")
    end = 23 + page[22]  # behind the sizes of its parts
    return bool(page[1] & 4) and end + sum(page[23:end]) <= len(page)


def _lacks_fragments(file: BinaryIO, size: int) -> bool:
    """Return whether an MP4 or MOV file of fragments ends within one, or before the last one of their index."""
    place, kind, has_fragments = 0, b"", False
    for _ in range(MOST_BOXES):
        file.seek(place)
        if not (head := file.read(16)):
            break
        length, start, kind = int.from_bytes(head[:4]), 8, head[4:8]
        if length == 1:
            length, start = int.from_bytes(head[8:]), 16
        has_fragments |= kind == b"moof"
        if len(head) < 8 or 0 < length < start or place + length > size:
            return has_fragments
        if length == 0:  # the last box, which reaches to the end
            return False
        place += length
        file.seek(place - length + start)
        if kind == b"sidx" and place + _indexed(file.read(length - start)) > size:
            return True
    return kind == b"moof"  # without its samples


def _indexed(index: bytes) -> int:
    """Return the bytes behind the box of an index, by its content, of what it lists."""
    first, number = struct.unpack_from(">12xI2xH" if index[:1] == b"\0" else ">20xQ2xH", index)
    sizes = struct.iter_unpack(">I8x", index[len(index) - 12 * number :])
    return int(first + sum(size & 0x7FFFFFFF for (size,) in sizes))


def _end_of_riff(file: BinaryIO) -> int:
    """Return where the last chunk of an AVI file ends, which has one or more."""
    end = 0
    file.seek(0)
    while (head := file.read(8)).startswith(b"RIFF"):
        end += 8 + int.from_bytes(head[4:], "little")
        file.seek(end)
    return end
