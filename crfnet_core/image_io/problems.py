"""The errors of files that cannot be decoded, and of those that hold no encoded picture."""

from __future__ import annotations

from pathlib import Path

from crfnet_core.errors import PhotoError


def damaged(path: Path, kind: str, problem: str) -> PhotoError:
    """Return the error of a file that cannot be decoded, with the first line of the decoder's message."""
    return PhotoError(f"{path}: this {kind} file is damaged or cut short ({first_line(problem)}); copy it again")


def first_line(problem: str) -> str:
    """Return the first line of a decoder's message."""
    return problem.strip().partition("\n")[0] or "OpenImageIO gives no reason"


def linear(path: Path, kind: str) -> PhotoError:
    """Return the error of a scene-linear file."""
    return PhotoError(
        f"{path}: {kind} holds scene-linear values, in which no camera response is left to estimate;"
        " give the JPEG, HEIC or TIFF that the camera or the raw developer wrote"
    )


def camera_raw(path: Path) -> PhotoError:
    """Return the error of camera raw."""
    return PhotoError(
        f"{path}: camera raw holds no encoded picture; give the JPEG, HEIC or TIFF developed from it, or that the"
        " camera wrote beside it"
    )
