"""The boxes of files of the ISO base media format, HEIF and JPEG 2000 among them: ISO/IEC 14496-12, 15444-1."""

from collections.abc import Iterator


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
