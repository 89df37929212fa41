"""The primaries of an encoded plate: as its file tags them, as the user states, or by convention."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.colorimetry import PHOTOGRAPHIC, REC709, Primaries
from crfnet_core.photograph.metadata.color_tags import ColorTags

from ..defaults import PRIMARIES
from ..errors import PlateError

#: The source of primaries that the user gave, and of those of a file without tags, which is taken for sRGB.
CHOSEN, BY_CONVENTION = "as given", "no tag, so by convention"


@dataclass(frozen=True)
class PlatePrimaries:
    """The primaries of a plate, None if its file names some that cannot be expressed, and the source that states them.

    Sources are "ICC profile", "CICP", "EXIF", `CHOSEN` or `BY_CONVENTION`.
    """

    primaries: Primaries | None
    source: str

    @property
    def name(self) -> str:
        """As people know them, or "unknown"."""
        return self.primaries.name if self.primaries else "unknown"

    def __str__(self) -> str:
        """Return the name and the source in words."""
        return f"{self.name} ({self.source})"


def plate_primaries(tags: ColorTags, choice: str = PRIMARIES[0]) -> PlatePrimaries:
    """Return the primaries of a plate by its tags, or by a choice: "rec709", "p3", "adobe", "prophoto" or "rec2020".

    "auto" goes by the tags, and takes a file without any for Rec.709, as the sRGB standard has it. Raise a PlateError
    if there is no such choice.
    """
    if choice in PHOTOGRAPHIC:
        return PlatePrimaries(PHOTOGRAPHIC[choice], CHOSEN)
    if choice != PRIMARIES[0]:
        raise PlateError("unknown_primaries", primaries=choice, choices=", ".join(PRIMARIES))
    return PlatePrimaries(tags.primaries, tags.source) if tags.source else PlatePrimaries(REC709, BY_CONVENTION)


def common_primaries(tags: Mapping[Path, ColorTags], choice: str = PRIMARIES[0]) -> PlatePrimaries:
    """Return the primaries that several plates have in common; raise a PlateError if two differ."""
    (first, expected), *others = ((path, plate_primaries(each, choice)) for path, each in tags.items())
    for path, primaries in others:
        check_same_primaries(path, primaries, first, expected)
    return expected


def check_same_primaries(path: Path, plate: PlatePrimaries, first: Path, expected: PlatePrimaries) -> None:
    """Raise a PlateError if a plate has other primaries than the first one that it goes together with."""
    if plate.primaries != expected.primaries:
        raise PlateError("primaries_differ", path=path, primaries=plate, first=first.name, expected=expected)
