"""The boxes of files of the ISO base media format: HEIF, JPEG 2000, JPEG XL (ISO/IEC 14496-12, 15444-1, 18181-2)."""

from collections.abc import Iterator
from pathlib import Path

MOST_META, MOST_BOXES = 4 * 2**20, 1000  # bytes of the largest box that is read, and the most boxes before it


def find_box(path: Path, wanted: bytes) -> bytes:
    """Return the content of a file's first box of a kind, nothing without it; ValueError if it is too large or far."""
    with path.open("rb") as file:
        for _ in range(MOST_BOXES):
            size, kind = int.from_bytes(file.read(4)), file.read(4)
            size, head = (int.from_bytes(file.read(8)), 16) if size == 1 else (size, 8)
            if kind == wanted and size <= MOST_META:
                return file.read(size - head if size else MOST_META)
            if kind == wanted:
                break
            if size < head:  # the last box, or not a box
                return b""
            file.seek(size - head, 1)
    raise ValueError(f"its box {wanted.decode()} is not found")


def boxes(content: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield the kind and the content of each box."""
    place = 0
    while place + 8 <= len(content):
        size, head = int.from_bytes(content[place : place + 4]), 8
        if size == 1:
            size, head = int.from_bytes(content[place + 8 : place + 16]), 16
        size = size or len(content) - place
        if size < head:
            raise ValueError("a box has no size")
        yield content[place + 4 : place + 8], content[place + head : place + size]
        place += size
