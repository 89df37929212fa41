"""What a file says of its colours: the primaries of its RGB, and how its codes were made of light."""

from __future__ import annotations

from dataclasses import dataclass

#: CIE 1931 x and y.
Chromaticity = tuple[float, float]

#: White points: CIE D65 as video and sRGB round it, and ISO 22028's D50.
D65: Chromaticity = (0.3127, 0.3290)
D50: Chromaticity = (0.3457, 0.3585)


@dataclass(frozen=True)
class Primaries:
    """The chromaticities of an RGB.

    Parameters
    ----------
    name : str
        As people know it, for example "Display P3".
    red, green, blue, white : (float, float)
        CIE 1931 x and y.
    interop_id : str
        The Color Interop Forum's name of the scene-linear space with these primaries; empty if there is none.
    """

    name: str
    red: Chromaticity
    green: Chromaticity
    blue: Chromaticity
    white: Chromaticity = D65
    interop_id: str = ""


#: ITU-R BT.709-6 and IEC 61966-2-1 (sRGB).
REC709 = Primaries("Rec.709", (0.64, 0.33), (0.30, 0.60), (0.15, 0.06), interop_id="lin_rec709_scene")

#: SMPTE EG 432-1 with a D65 white.
DISPLAY_P3 = Primaries("Display P3", (0.68, 0.32), (0.265, 0.69), (0.15, 0.06), interop_id="lin_p3d65_scene")

#: Adobe RGB (1998) Color Image Encoding, 4.3.1.
ADOBE_RGB = Primaries("Adobe RGB", (0.64, 0.33), (0.21, 0.71), (0.15, 0.06), interop_id="lin_adobergb_scene")

#: ISO 22028-2 (ROMM RGB).
PROPHOTO = Primaries("ProPhoto RGB", (0.734699, 0.265301), (0.159597, 0.840403), (0.036598, 0.000105), D50)

#: ITU-R BT.2020-2.
REC2020 = Primaries("Rec.2020", (0.708, 0.292), (0.17, 0.797), (0.131, 0.046), interop_id="lin_rec2020_scene")


@dataclass(frozen=True)
class ColorTags:
    """What a file says of its colours.

    Parameters
    ----------
    primaries : Primaries, optional
        None if the file says nothing, or something that cannot be expressed by primaries: see `source`.
    transfer : str
        The published encoding that a tag names, such as "HLG", "PQ" or "S-Log3"; empty if there is none, or if the
        tag is that of ordinary pictures (sRGB, BT.709), which says nothing of a camera's response.
    source : str
        Who says so, for example "ICC profile", "CICP" or "EXIF"; empty if the file says nothing.
    """

    primaries: Primaries | None = None
    transfer: str = ""
    source: str = ""
