"""The primaries of an encoded plate, by its tags, as stated or by convention; and the space of its linear values."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.colorimetry import AP0, AP1, PHOTOGRAPHIC, REC709, Primaries, conversion_matrix
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.types import Float64Array

from ..defaults import OUTPUT_SPACES, PRIMARIES
from ..errors import PlateError

#: The sources of primaries that the user states, and of a file without tags, which is taken for sRGB; and the Color
#: Interop Forum's name of a space that has none, or is not known.
CHOSEN, BY_CONVENTION, UNKNOWN = "as given", "no tag, so by convention", "unknown"

#: The primaries of the output spaces; "plate" keeps the primaries of the plate.
TARGETS = {"scene_linear": REC709, "plate": None, "ACEScg": AP1, "ACES2065-1": AP0}


@dataclass(frozen=True)
class PlatePrimaries:
    """The primaries of a plate, None if its file names some that are not known, and the source that states them."""

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
    """Return the primaries of a plate by its tags ("auto"; Rec.709 without any), or by a choice such as "p3"."""
    if choice in PHOTOGRAPHIC:
        return PlatePrimaries(PHOTOGRAPHIC[choice], CHOSEN)
    if tags.source or tags.transfer:  # by convention, only pictures for a display are in Rec.709
        return PlatePrimaries(tags.primaries, tags.source or tags.transfer_source)
    return PlatePrimaries(REC709, BY_CONVENTION)


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


@dataclass(frozen=True)
class LinearSpace:
    """The space of linear values: the primaries of the encoded plate, and of the values; None if they are not known."""

    source: Primaries | None
    target: Primaries | None

    @property
    def matrix(self) -> Float64Array | None:
        """From linear RGB of the plate to linear RGB of the space, (3, 3); None if they are the same or unknown."""
        if self.source is None or self.target is None or self.source == self.target:
            return None
        return conversion_matrix(self.source, self.target)

    @property
    def interop_id(self) -> str:
        """The Color Interop Forum's name, for OpenEXR's attribute `colorInteropID`."""
        return (self.target and self.target.interop_id) or UNKNOWN

    @property
    def chromaticities(self) -> tuple[float, ...]:
        """OpenEXR's attribute of this name, 8 numbers, where the primaries are known but have no interop name."""
        if self.target is None or self.target.interop_id:
            return ()
        return tuple(map(float, self.target.corners.ravel()))

    def __str__(self) -> str:
        """Return the space in words."""
        if self.target is None:
            return "linear light of unknown primaries"
        return {AP1: "ACEScg", AP0: "ACES2065-1"}.get(self.target, f"linear {self.target.name}")


def linear_space(plate: PlatePrimaries, output: str = OUTPUT_SPACES[0]) -> LinearSpace:
    """Return the space of a plate's linear values, one of `TARGETS`; of unknown primaries ACES is refused."""
    if plate.primaries is not None:
        return LinearSpace(plate.primaries, TARGETS[output] or plate.primaries)
    if output.startswith("ACES"):
        raise PlateError("primaries_unknown", primaries=plate, space=output)
    return LinearSpace(None, None)
