"""Add photographs or a measured response to a camera of a library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from crfnet_core.errors import CameraError, PhotoError
from crfnet_core.estimate.analysis import analyze_photographs
from crfnet_core.estimate.estimate import estimate_from_evidence
from crfnet_core.files import file_sha256
from crfnet_core.library.camera import (
    Camera,
    CameraSettings,
    KeptPhotograph,
    MeasuredResponse,
    checked_name,
)
from crfnet_core.library.library import CameraLibrary
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.types import Progress, show_progress


@dataclass(frozen=True)
class Addition:
    """What became of photographs that were added.

    Parameters
    ----------
    camera : Camera
        The camera as it is kept now.
    added, known : tuple of KeptPhotograph
        Those that are new, and those that had been there and count once.
    """

    camera: Camera
    added: tuple[KeptPhotograph, ...]
    known: tuple[KeptPhotograph, ...]


def add_photographs(
    library: CameraLibrary,
    name: str,
    paths: Sequence[Path],
    *,
    network: ResponseNetwork,
    progress: Progress | None = None,
) -> Addition:
    """Add photographs to a camera, which is made if there is none of its name; all of them, or none.

    The library is locked only while it is read and written again, so of two that add at once, neither loses any.

    Parameters
    ----------
    library : CameraLibrary
        The library.
    name : str
        The camera's name.
    paths : sequence of Path
        Photographs with the same settings, as the camera wrote them.
    network : ResponseNetwork
        The network that reads them.
    progress : callable, optional
        Called with (done, total) after every photograph.

    Raises
    ------
    PhotoError
        If a photograph cannot be read, is recognised as something else, or its encoding has a published curve.
    CameraError
        If a photograph is of another make or model, the camera's file is damaged, or the library cannot be written to.
    """
    name = checked_name(name)
    camera = _own_camera(library, name)
    read = []
    for done, path in enumerate(paths, 1):
        read.append(_kept(path, network))
        camera = camera.with_photographs(read[-1:])  # refuses early
        show_progress(progress, done, len(paths))
    photographs = {photograph.sha256: photograph for photograph in read}.values()
    with library.locked():
        camera = _own_camera(library, name)
        before = {(photograph.sha256, photograph.model) for photograph in camera.photographs}
        added = tuple(one for one in photographs if (one.sha256, one.model) not in before)
        camera = camera.with_photographs(added)
        library.save(camera)
    return Addition(camera, added, tuple(one for one in photographs if one not in added))


def add_measured(library: CameraLibrary, name: str, measured: MeasuredResponse, *, overwrite: bool = False) -> Camera:
    """Give a camera a measured response, and return it; it is made if there is none of its name.

    Raises
    ------
    CameraError
        If it has one that may not be replaced, another camera was measured, its file is damaged, or the library cannot
        be written to.
    """
    name = checked_name(name)
    with library.locked():
        camera = _own_camera(library, name).with_measured(measured, overwrite=overwrite)
        library.save(camera)
    return camera


def remove_photographs(library: CameraLibrary, name: str, photographs: Sequence[str]) -> Camera:
    """Take photographs out of a camera, named as `Camera.photograph` takes them, and return it.

    Raises
    ------
    CameraError
        If the camera or a photograph is not there, several photographs have the name, or nothing would remain.
    """
    library.get(name)  # a wrong name makes no folder
    with library.locked():
        camera = library.get(name).without(photographs)
        if not (camera.measured or camera.photographs):
            raise CameraError(f"nothing would be left of {name!r}; remove it without naming photographs")
        library.save(camera)
    return camera


def _own_camera(library: CameraLibrary, name: str) -> Camera:
    """Return the camera of this name in a library, or a new one; refuse the names that come with this project."""
    if camera := library.find(name):
        return camera
    if CameraLibrary.shipped().find(name):
        raise CameraError(f"{name!r} is a measured camera that comes with crfnet; give another name")
    library.target(name)  # refuses early to replace a file that cannot be read
    return Camera(name)


def _kept(path: Path, network: ResponseNetwork) -> KeptPhotograph:
    """Return what is kept of a photograph."""
    photo = read_photo(path)
    (analyzed,) = analyze_photographs(photo, network=network)
    if found := estimate_from_evidence([analyzed], model=network.config.label).recognition:
        raise PhotoError(f"{path}: {found.reason}; {found.advice}; a camera is known by photographs as it wrote them")
    cut = replace(analyzed.photograph, windows=(), samples=analyzed.photograph.samples[:0])
    return KeptPhotograph(
        sha256=file_sha256(path),
        model=network.config.label,
        settings=CameraSettings.of(photo.metadata),
        analyzed=replace(analyzed, photograph=cut, window_evidences=()),
    )
