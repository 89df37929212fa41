"""JPEG files: their checks before decoding, and the standard image of those with a gain map."""

from __future__ import annotations

import mmap
from pathlib import Path

from crfnet_core.photograph.image_io import problems
from crfnet_core.photograph.image_io.header_checks import check_size
from crfnet_core.photograph.metadata.jpeg import JpegHeader, read_jpeg_header

_END_OF_IMAGE = b"\xff\xd9"


def checked_jpeg_header(path: Path) -> JpegHeader:
    """Refuse a JPEG for what OpenImageIO would not: a huge frame, which opening allocates, and a missing end.

    Where the rest of a file is zeros (a failed download or recovery) the decoder paints gray and does not complain.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        header = read_jpeg_header(content)
        for width, height in header.sizes:
            check_size(path, width, height)
        if content.rfind(_END_OF_IMAGE, header.scan) < 0:
            raise problems.damaged(path, "JPEG", "it has no end marker")
    return header


def base_image(path: Path) -> bytes:
    """Return the standard image of an Ultra HDR JPEG, for which OpenImageIO with libultrahdr gives linear half floats.

    The file holds two JPEG pictures; without the second, the gain map, it is an ordinary one.

    Raises
    ------
    PhotoError
        If the file holds one picture only.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        base = content[: content.find(_END_OF_IMAGE, read_jpeg_header(content).scan) + 2]
        if len(base) == len(content):
            raise problems.linear(path, "a JPEG file of half samples")
    return base
