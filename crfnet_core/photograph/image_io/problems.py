"""The errors of files that cannot be decoded, and of those that hold no encoded picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import OpenImageIO as oiio

from crfnet_core.errors import PhotoError


def damaged(path: Path, kind: str, problem: str) -> PhotoError:
    """Return the error of a file that cannot be decoded, with the first line of the decoder's message."""
    if kind == "TIFF" and any(words in problem for words in ("support is not configured", "is not implemented")):
        return PhotoError(f"{path}: has a compression that is not read ({first_line(problem)}); save it with another")
    return PhotoError(f"{path}: this {kind} file is damaged or cut short ({first_line(problem)}); copy it again")


def oiio_message(source: Any = oiio) -> str:
    """Return OpenImageIO's last message, of an open file or else of the library, without control characters.

    Messages may quote bytes of a damaged file that are no text, at which the Python binding raises.
    """
    try:
        problem = str(source.geterror())
    except UnicodeDecodeError as failure:
        problem = failure.object.decode(errors="replace")
    return "".join(character if character.isprintable() or character == "\n" else "?" for character in problem)


def first_line(problem: str) -> str:
    """Return the first line of a decoder's message."""
    return problem.strip().partition("\n")[0] or "no reason is given"


def linear(path: Path, kind: str) -> PhotoError:
    """Return the error of a scene-linear file."""
    return PhotoError(
        f"{path}: {kind} holds scene-linear values, in which no camera response is left to estimate;"
        " give the JPEG, HEIC or TIFF that the camera or the raw developer wrote"
    )


def paletted(path: Path, kind: str) -> PhotoError:
    """Return the error of a file whose pixels are the numbers of colours in a table."""
    return PhotoError(
        f"{path}: {kind} holds at most 256 colours, mostly mixed by dither, from which no response can be estimated;"
        " give the photograph that it was made from"
    )


def camera_raw(path: Path) -> PhotoError:
    """Return the error of camera raw."""
    return PhotoError(
        f"{path}: camera raw holds no encoded picture; give the JPEG, HEIC or TIFF developed from it, or that the"
        " camera wrote beside it"
    )
