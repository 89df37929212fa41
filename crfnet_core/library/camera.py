"""A camera of the library: a measured response, with its uncertainty and the settings that it was measured with."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from crfnet_core.errors import CameraError
from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.photograph.metadata.devices import camera_name
from crfnet_core.response.curve import ResponseCurve

#: Names of cameras are names of files on every system: they begin with a letter or a digit, do not end with a dot, and
#: are not a device of Windows.
NAME = re.compile(r"(?!(?:con|prn|aux|nul|com\d|lpt\d)(?:\.|$))[^\W_][\w '.,+()-]{0,59}(?<!\.)", re.IGNORECASE)


@dataclass(frozen=True)
class CameraSettings:
    """A camera and its settings as files name them; the picture mode, which matters more than ISO, is unknown."""

    make: str = ""  # as the camera writes itself; empty if unknown
    model: str = ""
    software: str = ""  # the camera's firmware, or the program that wrote the file last
    iso: tuple[int, ...] = ()  # sensitivities, sorted

    @classmethod
    def from_metadata(cls, metadata: FileMetadata) -> CameraSettings:
        """Return the settings in a file's metadata."""
        iso = () if metadata.iso is None else (metadata.iso,)
        return cls(metadata.make, metadata.model, metadata.software, iso)

    @property
    def camera(self) -> str:
        """Make and model in one name, such as "Canon EOS 20D"; empty if both are unknown."""
        return camera_name(self.make, self.model)


@dataclass(frozen=True)
class Camera:
    """A camera in one picture mode, whose response was measured."""

    name: str  # the name that its owner gives it, and its file: see `checked_name`
    curve: ResponseCurve
    shape_stops: float  # standard deviations of the shape of the linear light, and of its scale against white, in stops
    scale_stops: float
    source: str  # the photographs that it was measured from, in words
    settings: CameraSettings  # of the photographs that it was measured on
    warnings: tuple[str, ...] = ()  # reasons why the measurement is less certain, in words

    @property
    def basis(self) -> str:
        """The measurement in words."""
        iso = self.settings.iso
        ends = " to ".join(map(str, dict.fromkeys((iso[0], iso[-1])))) if iso else ""
        return ", ISO ".join(filter(None, [f"measured from {self.source}", ends]))


def checked_name(name: str) -> str:
    """Return a camera's name in Unicode's composed form, with single spaces. Raise CameraError if `NAME` forbids it."""
    plain = " ".join(unicodedata.normalize("NFC", name).split())
    if not NAME.fullmatch(plain):
        raise CameraError("bad_camera_name", name=name)
    return plain


def name_key(name: str) -> str:
    """Return the form in which names are compared: upper and lower case are one."""
    return unicodedata.normalize("NFC", " ".join(name.split()).casefold())
