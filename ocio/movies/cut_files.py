"""Find files that are cut short, by the size or the end that their container states; FFmpeg reads them as whole.

Sources: AVI and OpenDML; Advanced Systems Format (3.2); Adobe Flash Video (E.5); SMPTE ST 377-1 (7.1); RFC 3533 (6).
"""

import os
import re
import struct
from pathlib import Path
from typing import BinaryIO

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
    fields = ((pattern.search(head), form) for pattern, form in _FIELDS)
    return any(field and struct.unpack(form, field[1])[0] > size for field, form in fields)


def _has_last_page(file: BinaryIO, size: int) -> bool:
    """Return whether the last page of an Ogg file is whole, and the last of its stream: a bit of its flags."""
    file.seek(max(0, size - _REACH))
    page = file.read().rpartition(b"OggS")[2].ljust(23, b"\0")
    end = 23 + page[22]  # behind the sizes of its parts
    return bool(page[1] & 4) and end + sum(page[23:end]) <= len(page)


def _end_of_riff(file: BinaryIO) -> int:
    """Return where the last chunk of an AVI file ends, which has one or more."""
    end = 0
    file.seek(0)
    while (head := file.read(8)).startswith(b"RIFF"):
        end += 8 + int.from_bytes(head[4:], "little")
        file.seek(end)
    return end
