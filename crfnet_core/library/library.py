"""Cameras in a folder, one JSON file each: listed, read, written and removed."""

import os
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import platformdirs

from crfnet_core.errors import CameraError
from crfnet_core.files import atomic_write_text, json_text
from crfnet_core.library.camera import Camera, camera_document, name_key, read_camera

#: The environment variable that names another data folder, such as one that a studio shares.
DATA_VARIABLE = "CRFNET_DATA_DIR"

#: The measured cameras that come with this project; ``python -m training.export.cameras`` writes them.
SHIPPED = Path(__file__).parents[1] / "data" / "cameras"


@dataclass(frozen=True)
class CameraLibrary:
    """Cameras in a folder, each in a file of its name, written whole: nothing needs a lock, and a copy hands one on."""

    folder: Path  # the folder; it need not exist

    @classmethod
    def of_user(cls) -> Self:
        """Return the user's own library: in `DATA_VARIABLE`, or in the data folder that the system gives a user."""
        chosen = os.environ.get(DATA_VARIABLE)
        data = Path(chosen) if chosen else platformdirs.user_data_path("crfnet", appauthor=False)
        return cls(data / "cameras")

    @classmethod
    def shipped(cls) -> Self:
        """Return the library of measured cameras that comes with this project."""
        return cls(SHIPPED)

    def cameras(self) -> list[Camera]:
        """Return the cameras, sorted by name; other and damaged files are left out: see `problems`."""
        cameras = [camera for camera in self._contents() if isinstance(camera, Camera)]
        return sorted(cameras, key=lambda camera: name_key(camera.name))

    def problems(self) -> list[str]:
        """Return the reason why each other file is left out, one line each."""
        return [str(problem) for problem in self._contents() if isinstance(problem, CameraError)]

    def file_of(self, name: str) -> Path | None:
        """Return the file of the camera of this name, in upper or lower case; None if there is none."""
        return next((path for path in self._files() if name_key(path.stem) == name_key(name)), None)

    def get(self, name: str) -> Camera:
        """Return the camera of this name. Raise CameraError if there is none, or its file is damaged."""
        return read_camera(self._present(name))

    def save(self, camera: Camera, *, overwrite: bool = False) -> Path:
        """Write a camera and return its file; the folder is made if it is absent.

        Raise CameraError if there is a camera of this name that may not be replaced, or the folder cannot be written.
        """
        path = self.file_of(camera.name)
        if path and not overwrite:
            raise CameraError("camera_exists", name=camera.name, folder=self.folder)
        path = path or self.folder / f"{camera.name}.json"
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as problem:
            raise self._unusable(problem) from None
        atomic_write_text(path, json_text(camera_document(camera)), overwrite=overwrite, error=CameraError)
        return path

    def remove(self, name: str) -> None:
        """Remove the camera of this name. Raise CameraError if there is none, or its file cannot be removed."""
        path = self._present(name)
        try:
            path.unlink()
        except OSError as problem:
            raise CameraError("camera_not_removed", path=path, reason=problem.strerror) from problem

    def _present(self, name: str) -> Path:
        """Return the file of a camera that must be there."""
        if path := self.file_of(name):
            return path
        raise CameraError("no_camera", name=name, folders=self.folder)

    def _files(self) -> list[Path]:
        """Return the library's files in the order of their names; files being written begin with a dot.

        Raise CameraError for a folder that this user may not read.
        """
        try:
            return sorted(self.folder.glob("[!.]*.json"))
        except OSError as problem:
            raise self._unusable(problem) from None

    def _unusable(self, problem: OSError) -> CameraError:
        """Return the error of a folder that cannot be made or read."""
        return CameraError("camera_folder", folder=self.folder, reason=problem.strerror, variable=DATA_VARIABLE)

    def _contents(self) -> Iterator[Camera | CameraError]:
        """Yield the camera in each file, or the reason why there is none."""
        try:
            files = self._files()
        except CameraError as problem:
            yield problem
            return
        for path in files:
            try:
                yield read_camera(path)
            except CameraError as problem:
                yield problem


def find_camera(name: str) -> Camera:
    """Return the user's camera of this name, else the shipped one. Raise CameraError as `CameraLibrary.get` does."""
    libraries = CameraLibrary.of_user(), CameraLibrary.shipped()
    for library in libraries:
        if library.file_of(name):
            return library.get(name)
    raise CameraError("no_camera", name=name, folders=" or ".join(str(library.folder) for library in libraries))


def known_cameras() -> list[Camera]:
    """Return the user's own cameras, then those that come with this project and have no namesake among them."""
    cameras = CameraLibrary.of_user().cameras()
    names = {name_key(camera.name) for camera in cameras}
    return cameras + [camera for camera in CameraLibrary.shipped().cameras() if name_key(camera.name) not in names]


def listed_cameras(text: str = "", models: Collection[str] = ()) -> list[tuple[str, str]]:
    """Return the names of all cameras that hold a text, in upper or lower case, each with its `basis`.

    Cameras of `models` (make and model, as in `FileOrigin.camera`) come first.
    """
    wanted = {model.casefold() for model in models}
    cameras = [camera for camera in known_cameras() if text.casefold() in camera.name.casefold()]
    ordered = sorted(cameras, key=lambda camera: camera.settings.camera.casefold() not in wanted)
    return [(camera.name, camera.basis) for camera in ordered]
