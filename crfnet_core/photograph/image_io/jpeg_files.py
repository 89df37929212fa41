"""JPEG files: checks before decoding, harmless warnings, and the standard image of a file with a gain map."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from crfnet_core.errors import PhotoError
from crfnet_core.files import read_bytes
from crfnet_core.photograph.image_io.header_checks import MOST_CONTENT, check_size, damaged
from crfnet_core.photograph.metadata.file_metadata import FileMetadata
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header

#: A marker with its length, behind bytes that belong to no segment, such as a scan's with its restart markers.
_SEGMENT = re.compile(rb"\xff+([^\0\1\xd0-\xd7\xff])(..)", re.DOTALL)

_MOST_SEGMENTS, _MOST_BETWEEN = 4096, 2**20  # of a header; and bytes between them, which Pillow reads one by one
_MOST_SCANS = 500  # as libjpeg-turbo advises for untrusted files: each takes as long as the whole picture

_START_OF_SCAN, _END_OF_IMAGE, _JPEG_LS = 0xDA, b"\xff\xd9", 0xF7
_START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}


@dataclass(frozen=True)
class JpegFile:
    """A JPEG file with a checked header."""

    metadata: FileMetadata  # in its segments
    warnings: frozenset[str]  # messages of libjpeg about stray bytes in the header, which touch no pixel

    def damage(self, problem: str) -> str:
        """Return the messages of a decoder, one a line, without those that touch no pixel."""
        harmless = (*self.warnings, "unknown JFIF revision", "Unknown Adobe color transform")
        return "\n".join(line for line in problem.split("\n") if not any(each in line for each in harmless))


def checked_jpeg(path: Path) -> JpegFile:
    """Refuse a JPEG that OpenImageIO would accept: a huge frame, which opening allocates, and a missing end."""
    warnings, scan, before, between = set(), 0, 2, 0
    content = read_bytes(path, most=MOST_CONTENT)
    for count, (marker, stray, scan, end) in enumerate(_segments(content)):
        if stray:
            warnings.add(f"Corrupt JPEG data: {stray} extraneous bytes before marker 0x{marker:02x}")
        between += scan - before - 4
        before = end
        if count >= _MOST_SEGMENTS or between > _MOST_BETWEEN:
            raise damaged(path, "JPEG", "its header has no end")
        if marker == _JPEG_LS:
            raise PhotoError("coding_not_read", path=path, kind="JPEG", problem="JPEG-LS")
        if marker in _START_OF_FRAME and (frame := content[scan:end]):
            if frame[0] != 8:
                problem = f"{frame[0]} bits per sample"
                raise PhotoError("coding_not_read", path=path, kind="JPEG", problem=problem)
            check_size(path, int.from_bytes(frame[3:5], "big"), int.from_bytes(frame[1:3], "big"))
    if content.rfind(_END_OF_IMAGE, scan) < 0:
        raise damaged(path, "JPEG", "it has no end marker")
    later = [marker for marker, *_ in islice(_segments(content, before, last=_END_OF_IMAGE[1]), _MOST_SEGMENTS)]
    if len(later) == _MOST_SEGMENTS or later.count(_START_OF_SCAN) >= _MOST_SCANS:
        raise PhotoError("coding_not_read", path=path, kind="JPEG", problem=f"more than {_MOST_SCANS} scans")
    return JpegFile(read_jpeg_header(content), frozenset(warnings))


def base_image(path: Path) -> bytes:
    """Return the first picture of an Ultra HDR JPEG, of which OpenImageIO makes linear half floats with the second."""
    content = read_bytes(path, most=MOST_CONTENT)
    scan = max((begin for _, _, begin, _ in _segments(content)), default=0)
    base = content[: content.find(_END_OF_IMAGE, scan) + 2]
    if len(base) == len(content):
        raise PhotoError("scene_linear_file", path=path, kind="a JPEG file of half samples")
    return base


def _segments(content: bytes, end: int = 2, *, last: int = _START_OF_SCAN) -> Iterator[tuple[int, int, int, int]]:
    """Yield segments, up to a marker: each one's marker, the stray bytes in front, where its payload begins, ends."""
    while segment := _SEGMENT.search(content, end):
        begin, stray = segment.end(), segment.start() - end
        end = segment.start(2) + max(2, int.from_bytes(segment[2], "big"))
        yield segment[1][0], stray, begin, end
        if segment[1][0] == last:
            return
