"""Chromaticities of RGB color spaces, and the matrices between them: RGB to CIE XYZ, and chromatic adaptation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from crfnet_core.types import Float64Array, number_of

Chromaticity = tuple[float, float]  # CIE 1931 x and y

#: XYZ to the cone responses of the Bradford transform (Lam 1985; Annex E of ISO 15076-1:2010, the ICC's specification).
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz_of(chromaticity: Chromaticity) -> Float64Array:
    """Return the XYZ of a chromaticity at a luminance Y of 1, shape (3,)."""
    x, y = chromaticity
    return np.array([x / y, 1.0, (1 - x - y) / y])


def chromaticity_of(xyz: Sequence[float] | Float64Array) -> Chromaticity:
    """Return the x and y of an XYZ."""
    total = float(np.sum(xyz))
    return float(xyz[0]) / total, float(xyz[1]) / total


def adaptation(source: Chromaticity, target: Chromaticity) -> Float64Array:
    """Return the Bradford matrix from XYZ under one white to the corresponding XYZ under another, shape (3, 3)."""
    before, after = BRADFORD @ xyz_of(source), BRADFORD @ xyz_of(target)
    return np.asarray(np.linalg.inv(BRADFORD) @ np.diag(after / before) @ BRADFORD)


#: White points: CIE D65 as video and sRGB round it, ISO 22028's D50, and the white of ACES ("D60", SMPTE ST 2065-1).
D65: Chromaticity = (0.3127, 0.3290)
D50: Chromaticity = (0.3457, 0.3585)
D60: Chromaticity = (0.32168, 0.33767)

#: The chromaticities of an RGB by name, and the largest condition of their matrix: 2 to 20 of known ones.
CORNERS, MOST_CONDITION = ("red", "green", "blue", "white"), 1e4


@dataclass(frozen=True)
class Primaries:
    """The chromaticities of an RGB, CIE 1931 x and y."""

    name: str  # as people know it, for example "Display P3"
    red: Chromaticity
    green: Chromaticity
    blue: Chromaticity
    white: Chromaticity = D65
    interop_id: str = ""  # the Color Interop Forum's name of the scene-linear space; empty if there is none

    @classmethod
    def from_dict(cls, entry: Mapping[str, Any]) -> Self:
        """Return the primaries that `dataclasses.asdict` made an entry of, also after JSON.

        Raise KeyError, TypeError or ValueError if it lacks one, or they are not chromaticities that span a space.
        """
        corners = [tuple(number_of(part, least=-10, most=10) for part in entry[name]) for name in CORNERS]
        red, green, blue, white = ((x, y) for x, y in corners)
        primaries = cls(str(entry["name"]), red, green, blue, white, str(entry.get("interop_id", "")))
        if not white[1] >= 0.01 or not np.linalg.cond(primaries.to_xyz()) < MOST_CONDITION:
            raise ValueError("these are not primaries")
        return primaries

    @property
    def corners(self) -> Float64Array:
        """The x and y of red, green, blue and white, shape (4, 2)."""
        return np.array([self.red, self.green, self.blue, self.white])

    def to_xyz(self) -> Float64Array:
        """Return the matrix from linear RGB to CIE XYZ, by which (1, 1, 1) is the white at Y = 1; shape (3, 3).

        It is Eq. 35 of docs/METHOD.md (SMPTE RP 177-1993). Raise LinAlgError if the primaries lie on a line.
        """
        columns = np.array([(x, y, 1 - x - y) for x, y in (self.red, self.green, self.blue)]).T
        scales: Float64Array = np.linalg.solve(columns, xyz_of(self.white))
        return np.asarray(columns * scales)


#: ITU-R BT.709-6 and IEC 61966-2-1 (sRGB); SMPTE EG 432-1 with a D65 white; Adobe RGB (1998) Color Image Encoding,
#: 4.3.1; ISO 22028-2 (ROMM RGB); ITU-R BT.2020-2; SMPTE ST 2065-1 (ACES2065-1); and the Academy's S-2014-004 (ACEScg).
REC709 = Primaries("Rec.709", (0.64, 0.33), (0.30, 0.60), (0.15, 0.06), interop_id="lin_rec709_scene")
DISPLAY_P3 = Primaries("Display P3", (0.68, 0.32), (0.265, 0.69), (0.15, 0.06), interop_id="lin_p3d65_scene")
ADOBE_RGB = Primaries("Adobe RGB", (0.64, 0.33), (0.21, 0.71), (0.15, 0.06), interop_id="lin_adobergb_scene")
PROPHOTO = Primaries("ProPhoto RGB", (0.734699, 0.265301), (0.159597, 0.840403), (0.036598, 0.000105), D50)
REC2020 = Primaries("Rec.2020", (0.708, 0.292), (0.17, 0.797), (0.131, 0.046), interop_id="lin_rec2020_scene")
AP0 = Primaries("ACES AP0", (0.7347, 0.2653), (0.0, 1.0), (0.0001, -0.077), D60, "lin_ap0_scene")
AP1 = Primaries("ACES AP1", (0.713, 0.293), (0.165, 0.83), (0.128, 0.044), D60, "lin_ap1_scene")

#: The primaries that photographs have, by the names that users give them.
PHOTOGRAPHIC = {"rec709": REC709, "p3": DISPLAY_P3, "adobe": ADOBE_RGB, "prophoto": PROPHOTO, "rec2020": REC2020}


def conversion_matrix(source: Primaries, target: Primaries) -> Float64Array:
    """Return the matrix from linear RGB of one kind to another, shape (3, 3) (Eq. 36 of docs/METHOD.md).

    White stays white: between different white points colors are adapted by the Bradford transform, as in the ACES
    configs of OpenColorIO. Colors outside the target's gamut become negative.
    """
    if source == target:
        return np.eye(3)
    adapted = adaptation(source.white, target.white) @ source.to_xyz()
    return np.asarray(np.linalg.solve(target.to_xyz(), adapted))
