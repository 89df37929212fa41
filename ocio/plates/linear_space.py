"""The space of linear EXR files: from the plate's primaries to it, and how an OpenEXR header names it."""

from __future__ import annotations

from dataclasses import dataclass

from crfnet_core.colorimetry import AP0, AP1, REC709, Primaries, conversion_matrix
from crfnet_core.types import Float64Array

from ..defaults import OUTPUT_SPACES
from ..errors import PlateError
from .primaries import PlatePrimaries

#: The Color Interop Forum's name of a space that has none, or is not known.
UNKNOWN = "unknown"

#: The primaries of the output spaces; "plate" has those of the plate.
TARGETS = {"scene_linear": REC709, "plate": None, "ACEScg": AP1, "ACES2065-1": AP0}


@dataclass(frozen=True)
class LinearSpace:
    """The space of linear values: the primaries of the encoded plate, and of the values; None if they are not known."""

    source: Primaries | None
    target: Primaries | None

    @property
    def matrix(self) -> Float64Array | None:
        """From the plate's linear RGB to that of the space, shape (3, 3); None where nothing is to be done."""
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
    """Return the space of a plate's linear values; `output` is one of `TARGETS`.

    The matrix does not clip: colors outside the target's gamut get negative values, by which they can be converted
    back. A plate of unknown primaries is left as it is, and its space is unknown. Raise a PlateError if there is no
    such space, or unknown primaries are to be converted to ACES.
    """
    if output not in TARGETS:
        raise PlateError("unknown_output_space", space=output, spaces=", ".join(OUTPUT_SPACES))
    if plate.primaries is not None:
        return LinearSpace(plate.primaries, TARGETS[output] or plate.primaries)
    if output.startswith("ACES"):
        raise PlateError("primaries_unknown", primaries=plate, space=output)
    return LinearSpace(None, None)
