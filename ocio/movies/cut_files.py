"""Find files that are cut short, by the size or the end that their container states; FFmpeg reads them as whole.

Sources: AVI and OpenDML; Advanced Systems Format (3.2); Adobe Flash Video (E.5); SMPTE ST 377-1 (7.1); RFC 3533 (6).
"""

import os
import struct
from pathlib import Path
from typing import BinaryIO

#: Bytes in which a header, or the last page of an Ogg file, begins.
_REACH = 2**16

#: Windows Media: the key of the file's properties, the places in them of its size and of the flag that it is still
#: being written. Flash: the name and the type of the size.
_WINDOWS, _WINDOWS_SIZE, _WINDOWS_FLAG = bytes.fromhex("a1dcab8c47a9cf118ee400c00c205365"), 40, 88
_FLASH = b"\0\x08filesize\0"

#: MXF: how the key of the first partition begins, its size, and the place of the last partition's address behind it.
_MXF, _MXF_KEY, _MXF_ADDRESS = b"\x06\x0e\x2b\x34\x02\x05\x01\x01", 16, 24


def is_cut_short(path: Path) -> bool:
    """Return whether a file ends before it says; False for a container that does not say."""
    with path.open("rb") as file:
        head = file.read(_REACH)
        size = file.seek(0, os.SEEK_END)
        if head.startswith(b"OggS"):
            return not _has_last_page(file, size)
        return _end_of_riff(file) > size if head.startswith(b"RIFF") else _stated_end(head) > size


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


def _stated_end(head: bytes) -> float:
    """Return the size of Windows Media or Flash, or where the last partition of MXF begins; 0 if it is not stated."""
    if (at := head.find(_WINDOWS)) >= 0:
        is_final = not int.from_bytes(head[at + _WINDOWS_FLAG : at + _WINDOWS_FLAG + 1]) & 1
        return is_final * int.from_bytes(head[at + _WINDOWS_SIZE : at + _WINDOWS_SIZE + 8], "little")
    if head.startswith(b"FLV") and (at := head.find(_FLASH)) >= 0:
        return float(struct.unpack_from(">d", head + bytes(8), at + len(_FLASH))[0])
    if head.startswith(_MXF):
        at = _MXF_KEY + 1 + head[_MXF_KEY] % 128 + _MXF_ADDRESS  # behind the bytes of a length, by their number
        return int.from_bytes(head[at : at + 8])
    return 0
