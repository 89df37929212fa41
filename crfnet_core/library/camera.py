"""A camera of the library: a measured response, its uncertainty and settings; and the same as a JSON document."""

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

from crfnet_core.errors import CameraError, CRFNetError, one_line
from crfnet_core.files import read_json
from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.photograph.metadata.devices import camera_name
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import number_of, plain_values

#: The version of the document. Entries may be added to it; if one changes its meaning or goes, the version rises.
CAMERA_VERSION = 1

#: Bounds of sensitivities, and of standard deviations in stops: far beyond all that is measured.
LARGEST_ISO, LARGEST_DEVIATION = 1e9, 100.0

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
    def from_metadata(cls, metadata: FileMetadata) -> Self:
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


def camera_document(camera: Camera) -> dict[str, Any]:
    """Return a camera as plain lists, texts and numbers, ready for JSON; its name is the name of its file."""
    measured = {
        **asdict(camera.settings),
        "source": camera.source,
        "shape_stops": camera.shape_stops,
        "scale_stops": camera.scale_stops,
        "warnings": camera.warnings,
        "brightness": camera.curve.brightness,
    }
    return dict(plain_values({"kind": "camera", "camera_version": CAMERA_VERSION, "measured": measured}))


def read_camera(path: Path) -> Camera:
    """Return the camera in a JSON file, whose name is the camera's.

    Raise CameraError if the file cannot be read, is damaged, holds no measured response, or is of a later version.
    """
    return _read(path, path.stem, ("camera",), "not_a_camera")


def read_calibration(path: Path, name: str | None = None) -> Camera:
    """Return the camera in the JSON document of a calibration, or of a camera; by default named as the file.

    Raise CameraError as `read_camera`, or if the name breaks the rule of `checked_name`.
    """
    return _read(path, path.stem if name is None else name, ("camera", "calibration"), "not_a_calibration")


def _read(path: Path, name: str, kinds: Sequence[str], code: str) -> Camera:
    """Return the camera in a document of some kinds; raise CameraError with a code for documents of other kinds."""
    name = checked_name(name)
    try:
        document = read_json(path)
    except OSError as problem:
        raise CameraError("unreadable_camera", path=path, reason=problem.strerror) from None
    except ValueError:
        document = None
    if not isinstance(document, dict) or document.get("kind") not in kinds:
        raise CameraError(code, path=path)
    is_camera = document["kind"] == "camera"
    if is_camera and (version := document.get("camera_version")) != CAMERA_VERSION:
        raise CameraError("camera_version", path=path, version=version, needed=CAMERA_VERSION)
    if is_camera and document.get("measured") is None:
        raise CameraError("camera_not_measured", path=path)
    try:
        return _camera(name, document["measured"] if is_camera else _entry(document))
    except (CRFNetError, AttributeError, KeyError, OverflowError, TypeError, ValueError) as problem:
        raise CameraError("damaged_camera" if is_camera else "damaged_calibration", path=path, reason=problem) from None


def _entry(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entry of a camera that the document of a calibration makes."""
    used = [frame for frame in document["frames"] if frame["used"]]
    files = f"{len(used)} exposures"
    if document.get("method") == "raw pairs":
        files = f"{len(used)} raw file{'s' * (len(used) > 1)} (white {document['white_basis']})"
    return {
        **document["camera"],
        "software": document["camera"]["firmware"],
        "iso": {round(frame["iso"]) for frame in used if frame["iso"]},
        "source": files,
        "shape_stops": document["shape_uncertainty_stops"],
        "scale_stops": document["scale_uncertainty_stops"],
        "warnings": document["warnings"],
        "brightness": ResponseCurve.restored(document["response"]["brightness"]).brightness,
    }


def _camera(name: str, entry: Mapping[str, Any]) -> Camera:
    """Return the camera in the entry of a document."""
    make, model, software, source = _texts(entry[field] for field in ("make", "model", "software", "source"))
    iso = tuple(sorted(number_of(each, int, least=1, most=LARGEST_ISO) for each in entry["iso"]))
    return Camera(
        name=name,
        curve=ResponseCurve(entry["brightness"]),
        shape_stops=number_of(entry["shape_stops"], least=0, most=LARGEST_DEVIATION),
        scale_stops=number_of(entry["scale_stops"], least=0, most=LARGEST_DEVIATION),
        source=source,
        settings=CameraSettings(make, model, software, iso),
        warnings=_texts(entry["warnings"]),
    )


def _texts(values: Iterable[Any]) -> tuple[str, ...]:
    """Return texts, each on one line and without control characters, since they are printed."""
    return tuple(one_line(str(value)) for value in values)
