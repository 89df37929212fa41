"""Cameras in a folder, one JSON file each: listed, found, kept and removed."""

from __future__ import annotations

import hashlib
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from crfnet_core.errors import CameraError
from crfnet_core.files import atomic_write_text, json_text
from crfnet_core.library.camera import Camera, name_key
from crfnet_core.library.documents import camera_document, read_camera

#: The environment variable that names another data folder, such as one that a studio shares.
DATA_VARIABLE = "CRFNET_DATA_DIR"

#: The responses of measured cameras that come with this project; ``python -m training.export.cameras`` writes them.
SHIPPED = Path(__file__).parents[1] / "data" / "cameras"

#: Seconds to wait for another process that changes the library.
LOCK_SECONDS = 10.0

#: Most characters of a name that are kept in its file's name.
LONGEST_STEM = 40


@dataclass(frozen=True)
class CameraLibrary:
    """Cameras in a folder.

    Any JSON file of a camera in the folder counts, whatever it is called: to hand a camera on, copy its file.

    Parameters
    ----------
    folder : str or Path
        The folder; it need not exist.
    """

    folder: Path

    def __post_init__(self) -> None:
        object.__setattr__(self, "folder", Path(self.folder))

    @classmethod
    def of_user(cls) -> CameraLibrary:
        """Return the user's own library: in `DATA_VARIABLE`, or in the data folder that the system gives a user."""
        chosen = os.environ.get(DATA_VARIABLE)
        data = Path(chosen) if chosen else platformdirs.user_data_path("crfnet", appauthor=False)
        return cls(data / "cameras")

    @classmethod
    def shipped(cls) -> CameraLibrary:
        """Return the library of measured cameras that comes with this project."""
        return cls(SHIPPED)

    def cameras(self) -> list[Camera]:
        """Return the cameras, sorted by name; files that are none or damaged are left out: see `problems`."""
        return sorted((found for _, found in self._files() if isinstance(found, Camera)), key=_order)

    def problems(self) -> list[str]:
        """Return what is wrong with the files that are left out, one line each."""
        return [str(found) for _, found in self._files() if isinstance(found, CameraError)]

    def find(self, name: str) -> Camera | None:
        """Return the camera of this name, in upper or lower case; None if there is none."""
        return next((camera for camera in self.cameras() if name_key(camera.name) == name_key(name)), None)

    def get(self, name: str) -> Camera:
        """Return the camera of this name.

        Raises
        ------
        CameraError
            If there is none, or its file is damaged.
        """
        if camera := self.find(name):
            return camera
        raise self._absent(name)

    def save(self, camera: Camera) -> Path:
        """Write a camera, in the place of the one of its name if there is one, and return its file.

        Raises
        ------
        CameraError
            If the file cannot be written: see also `target`.
        """
        path = self.target(camera.name)
        atomic_write_text(path, json_text(camera_document(camera)), overwrite=True, error=CameraError)
        return path

    def target(self, name: str) -> Path:
        """Return the file that a camera of this name is written to.

        Raises
        ------
        CameraError
            If a file would be replaced that cannot be read as a camera, or holds another one.
        """
        if path := self._file_of(name):
            return path
        path = self.folder / _file_name(name)
        found = dict(self._files()).get(path)
        if isinstance(found, CameraError):
            raise found
        if found:
            raise CameraError(f"{path}: holds the camera {found.name!r}, not {name!r}; rename the file")
        return path

    def remove(self, name: str) -> None:
        """Remove the camera of this name.

        Raises
        ------
        CameraError
            If there is none, or its file cannot be removed.
        """
        path = self._file_of(name)
        if path is None:
            raise self._absent(name)
        try:
            path.unlink()
        except OSError as problem:
            raise CameraError(f"{path}: cannot be removed ({problem.strerror})") from problem

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Make the folder, and keep other processes from changing the library during a block that reads and writes.

        Raises
        ------
        CameraError
            If the folder cannot be made, or another process holds the library for `LOCK_SECONDS`.
        """
        lock = self.folder / ".lock"
        due = time.monotonic() + LOCK_SECONDS
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            while not _made(lock):
                if time.monotonic() > due:
                    raise CameraError(f"{lock}: another crfnet changes the library; if none runs, remove this file")
                time.sleep(0.05)
        except OSError as problem:
            reason = f"{self.folder}: cannot be written to ({problem.strerror})"
            raise CameraError(f"{reason}; set {DATA_VARIABLE} to another folder") from None
        try:
            yield
        finally:
            lock.unlink(missing_ok=True)

    def _absent(self, name: str) -> CameraError:
        """Return the error of a camera that is not there, with what is wrong with the library's files."""
        if self.folder != SHIPPED and CameraLibrary.shipped().find(name):
            return CameraError(f"{name!r} is a measured camera that comes with crfnet; it cannot be changed or removed")
        damaged = "".join(f"; {problem}" for problem in self.problems())
        return CameraError(f"no camera {name!r} in {self.folder}; crfnet camera list shows them{damaged}")

    def _files(self) -> Iterator[tuple[Path, Camera | CameraError]]:
        """Yield the library's files in the order of their names, each with its camera or with what is wrong."""
        for path in sorted(self.folder.glob("[!.]*.json")):  # a name with a dot in front is being written
            try:
                yield path, read_camera(path)
            except CameraError as problem:
                yield path, problem

    def _file_of(self, name: str) -> Path | None:
        """Return the file that holds the camera of this name."""
        files = {name_key(found.name): path for path, found in self._files() if isinstance(found, Camera)}
        return files.get(name_key(name))


def find_camera(name: str) -> Camera:
    """Return the camera of this name: the user's own, else one that comes with this project.

    Raises
    ------
    CameraError
        If there is none, or its file is damaged.
    """
    own, shipped = CameraLibrary.of_user(), CameraLibrary.shipped()
    return own.find(name) or shipped.find(name) or own.get(name)


def known_cameras() -> tuple[list[Camera], list[Camera]]:
    """Return the user's own cameras, and those that come with this project and have no namesake among them."""
    own = CameraLibrary.of_user().cameras()
    names = {name_key(camera.name) for camera in own}
    return own, [camera for camera in CameraLibrary.shipped().cameras() if name_key(camera.name) not in names]


def _made(lock: Path) -> bool:
    """Return whether a file that did not exist could be made."""
    try:
        lock.touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


def _order(camera: Camera) -> str:
    """Return what cameras are sorted by."""
    return name_key(camera.name)


def _file_name(name: str) -> str:
    """Return a file's name for a camera's: readable, allowed on every system, and another one for every name."""
    key = name_key(name)
    readable = re.sub(r"[^a-z0-9]+", "-", key)[:LONGEST_STEM].strip("-") or "camera"
    return f"{readable}-{hashlib.sha256(key.encode()).hexdigest()[:8]}.json"
