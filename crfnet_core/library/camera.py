"""A camera of the library: a measured response, or photographs whose evidence accumulates, or both."""

from __future__ import annotations

import unicodedata
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from functools import cached_property

from crfnet_core.errors import CameraError
from crfnet_core.estimate.analysis import AnalyzedPhotograph
from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.photograph.metadata.devices import camera_name
from crfnet_core.response.curve import ResponseCurve

#: Most characters of a camera's name.
LONGEST_NAME = 100

#: Characters of a photograph's SHA-256 that stand for it where file names do not tell photographs apart.
KEY_LENGTH = 8


@dataclass(frozen=True)
class CameraSettings:
    """What files say of their camera and its settings. They do not say its picture mode, which matters more than ISO.

    Parameters
    ----------
    make, model : str
        As the camera writes itself; empty if unknown.
    software : str
        The camera's firmware, or the program that wrote the file last.
    iso : tuple of int
        Sensitivities, sorted; several of an exposure stack where they differ.
    """

    make: str = ""
    model: str = ""
    software: str = ""
    iso: tuple[int, ...] = ()

    @classmethod
    def of(cls, metadata: FileMetadata | None) -> CameraSettings:
        """Return the settings in a file's metadata."""
        if metadata is None:
            return cls()
        iso = () if metadata.iso is None else (metadata.iso,)
        return cls(metadata.make, metadata.model, metadata.software, iso)

    @property
    def camera(self) -> str:
        """Make and model in one name, such as "Canon EOS 20D"; empty if both are unknown."""
        return camera_name(self.make, self.model)


@dataclass(frozen=True)
class MeasuredResponse:
    """A response that was measured from an exposure stack.

    Parameters
    ----------
    curve : ResponseCurve
        The response.
    shape_stops, scale_stops : float
        Standard deviations of the shape of the linear light, and of its scale beside white, in stops.
    source : str
        What it was measured from, in words.
    settings : CameraSettings
        Of the stack.
    warnings : tuple of str
        What makes the measurement less certain, in words.
    """

    curve: ResponseCurve
    shape_stops: float
    scale_stops: float
    source: str
    settings: CameraSettings
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class KeptPhotograph:
    """What is kept of a photograph: its evidence, not its pixels.

    Parameters
    ----------
    sha256 : str
        Of the file, so that no file counts twice.
    model : str
        The label of the network that read it; evidence of different networks does not mix.
    settings : CameraSettings
        What the file says of the camera.
    analyzed : AnalyzedPhotograph
        Its evidence, without its windows.
    """

    sha256: str
    model: str
    settings: CameraSettings
    analyzed: AnalyzedPhotograph

    @property
    def name(self) -> str:
        """The file's name."""
        return self.analyzed.photograph.name


@dataclass(frozen=True)
class Camera:
    """A camera of the library, with one setting of its tones.

    Parameters
    ----------
    name : str
        What its owner calls it; see `checked_name`.
    measured : MeasuredResponse, optional
        Its measured response, which is the answer if there is one.
    photographs : tuple of KeptPhotograph
        Its photographs, in the order in which they came.
    """

    name: str
    measured: MeasuredResponse | None = None
    photographs: tuple[KeptPhotograph, ...] = ()

    @cached_property
    def settings(self) -> CameraSettings:
        """Make, model and all sensitivities; make, model and firmware are the first that a file names."""
        every = [self.measured.settings] if self.measured else []
        every += [photograph.settings for photograph in self.photographs]
        named = next((settings for settings in every if settings.camera), CameraSettings())
        return replace(named, iso=tuple(sorted({iso for settings in every for iso in settings.iso})))

    @property
    def basis(self) -> str:
        """What the response rests on, in words."""
        count = len(self.photographs)
        words = f"estimated from {count} photograph{'s' * (count != 1)}"
        settings = self.settings
        if self.measured:
            words, settings = f"measured from {self.measured.source}", self.measured.settings
        ends = dict.fromkeys((settings.iso[0], settings.iso[-1])) if settings.iso else ()
        return ", ISO ".join(filter(None, [words, " to ".join(map(str, ends))]))

    def with_photographs(self, photographs: Iterable[KeptPhotograph]) -> Camera:
        """Return the camera with more photographs; one that is there already is replaced, so it counts once.

        Raises
        ------
        CameraError
            If a file says that another camera took it.
        """
        kept = {photograph.sha256: photograph for photograph in self.photographs}
        camera = self
        for photograph in photographs:
            camera.check_same(photograph.settings, photograph.name)
            kept[photograph.sha256] = photograph
            camera = replace(self, photographs=tuple(kept.values()))
        return camera

    def with_measured(self, measured: MeasuredResponse, *, overwrite: bool = False) -> Camera:
        """Return the camera with a measured response.

        Raises
        ------
        CameraError
            If another camera was measured, or there is a measured response that may not be replaced.
        """
        if self.measured and not overwrite:
            raise CameraError(f"{self.name!r} has a measured response; give another name, or --overwrite to replace it")
        unmeasured = replace(self, measured=None)
        unmeasured.check_same(measured.settings, "the measured response")
        return replace(self, measured=measured)

    def without(self, names: Collection[str]) -> Camera:
        """Return the camera without some photographs, named as `photograph` takes them.

        Raises
        ------
        CameraError
            If there is no such photograph, or several have the name.
        """
        taken = {self.photograph(name).sha256 for name in names}
        return replace(self, photographs=tuple(one for one in self.photographs if one.sha256 not in taken))

    def photograph(self, name: str) -> KeptPhotograph:
        """Return the photograph of a file name, or of the first `KEY_LENGTH` or more characters of its SHA-256.

        Raises
        ------
        CameraError
            If there is no such photograph, or several have the name.
        """
        found = [one for one in self.photographs if one.name == name]
        if not found and len(name) >= KEY_LENGTH:
            found = [one for one in self.photographs if one.sha256.startswith(name.lower())]
        if not found:
            raise CameraError(f"{self.name!r} has no photograph {name}; crfnet camera show lists them")
        if len(found) > 1:
            keys = ", ".join(self.key_of(one) for one in found)
            raise CameraError(f"{self.name!r} has {len(found)} photographs {name}; name one by its SHA-256: {keys}")
        return found[0]

    def key_of(self, photograph: KeptPhotograph) -> str:
        """Return what names one of the photographs: its file name, or where several have it, its SHA-256's beginning.

        The beginning has `KEY_LENGTH` characters, and is the whole SHA-256 where that does not tell them apart.
        """
        if sum(one.name == photograph.name for one in self.photographs) == 1:
            return photograph.name
        key = photograph.sha256[:KEY_LENGTH]
        return key if sum(one.sha256.startswith(key) for one in self.photographs) == 1 else photograph.sha256

    def check_same(self, settings: CameraSettings, what: str) -> None:
        """Refuse what another make or model took; a file that names none may be of any camera."""
        own, other = self.settings.camera, settings.camera
        if own and other and own.casefold() != other.casefold():
            raise CameraError(f"{what} is of {other}, but {self.name!r} is {own}; give it another name")


def checked_name(name: str) -> str:
    """Return a camera's name in Unicode's composed form, with single spaces.

    Raises
    ------
    CameraError
        If it is empty, too long, or holds characters that cannot be shown.
    """
    plain = " ".join(unicodedata.normalize("NFC", name).split())
    if not plain or len(plain) > LONGEST_NAME or not plain.isprintable():
        raise CameraError(f"{name!r} is no name for a camera; give 1 to {LONGEST_NAME} printable characters")
    return plain


def name_key(name: str) -> str:
    """Return what names are compared by: two that differ in upper and lower case are one."""
    return unicodedata.normalize("NFC", checked_name(name).casefold())
