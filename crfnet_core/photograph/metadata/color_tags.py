"""The color tags of files: primaries, code points of ITU-T H.273 (CICP), and published curves by name."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from crfnet_core.colorimetry import AP0, AP1, DISPLAY_P3, PHOTOGRAPHIC, REC709, REC2020, Chromaticity, Primaries

#: CIE illuminant C, the white of a cinema projector (SMPTE RP 431-2), and the primaries of old television.
C: Chromaticity = (0.310, 0.316)
DCI: Chromaticity = (0.314, 0.351)
_SMPTE_C: tuple[Chromaticity, Chromaticity, Chromaticity] = ((0.63, 0.34), (0.31, 0.595), (0.155, 0.07))

#: ColourPrimaries of ITU-T H.273 (07/2021), Table 2. 10, CIE XYZ, is not an RGB of a camera.
PRIMARIES = {
    1: REC709,
    4: Primaries("BT.470 M", (0.67, 0.33), (0.21, 0.71), (0.14, 0.08), C),
    5: Primaries("Rec.601 (625 lines)", (0.64, 0.33), (0.29, 0.60), (0.15, 0.06)),
    6: Primaries("Rec.601 (525 lines)", *_SMPTE_C),
    7: Primaries("SMPTE 240M", *_SMPTE_C),
    8: Primaries("film", (0.681, 0.319), (0.243, 0.692), (0.145, 0.049), C),
    9: REC2020,
    11: Primaries("DCI-P3", (0.68, 0.32), (0.265, 0.69), (0.15, 0.06), DCI),
    12: DISPLAY_P3,
    22: Primaries("EBU Tech. 3213-E", (0.63, 0.34), (0.295, 0.605), (0.155, 0.077)),
}

#: Primaries that are known by their chromaticities; of equal ones the first counts.
NAMED = (*PHOTOGRAPHIC.values(), AP0, AP1, *PRIMARIES.values())

UNSPECIFIED = (0, 2, 3)  # code points without a meaning there: reserved and unspecified

#: TransferCharacteristics of ITU-T H.273, Table 3, other than of ordinary pictures for a display.
TRANSFERS = {8: "linear", 9: "log 100:1", 10: "log 316:1", 16: "PQ", 17: "SMPTE ST 428-1", 18: "HLG"}

#: Transfer characteristic in a DPX header (SMPTE ST 268) -> the encoding that follows. "Linear" proves nothing: ffmpeg
#: writes it into every DPX, and Blender into all but log.
DPX_TRANSFERS = {"Printing density": "Cineon log", "Logarithmic": "log"}

#: Words of an ICC profile's description, in lower case -> the encoding that it names; special ones come first. PeQ is
#: libjxl's name of PQ.
PROFILE_TRANSFERS = (
    *((r"\bs-?log ?3", "Sony S-Log3"), (r"\bs-?log ?2", "Sony S-Log2"), (r"\bs-?log\b", "Sony S-Log")),
    *((r"\blog ?c ?4", "ARRI LogC4"), (r"\blog ?c(?: ?3)?\b", "ARRI LogC3"), (r"\bapple ?log", "Apple Log")),
    *((r"\b(?:canon|c)-? ?log ?3", "Canon Log 3"), (r"\b(?:canon|c)-? ?log ?2", "Canon Log 2")),
    *((r"\b(?:canon|c)-? ?log\b", "Canon Log"), (r"\bv-?log", "Panasonic V-Log"), (r"\bd-?log\b", "DJI D-Log")),
    *((r"log3g10", "RED Log3G10"), (r"log3g12", "RED Log3G12"), (r"\bn-?log", "Nikon N-Log")),
    *((r"\bf-?log ?2", "Fujifilm F-Log2"), (r"\bf-?log\b", "Fujifilm F-Log")),
    *((r"\bblackmagic.*film|\bbmdfilm", "Blackmagic Film Gen 5"), (r"\bcineon|\bprinting density", "Cineon log")),
    *((r"\blogarithmic", "log"), (r"\bpe?q\b|\bst ?2084", "PQ"), (r"\bhlg\b|\bhybrid log", "HLG")),
)


@dataclass(frozen=True)
class ColorTags:
    """The color tags of a file; `transfer` is empty for sRGB and BT.709, which do not show a camera's response."""

    primaries: Primaries | None = None  # None without a tag, or if it cannot be expressed by primaries: see `source`
    transfer: str = ""  # the published encoding that a tag names, such as "HLG", "linear" or "S-Log3"
    source: str = ""  # the tag that names primaries, for example "ICC profile", "CICP" or "EXIF"; empty without one
    transfer_source: str = ""  # the tag that names an encoding, also sRGB or another one of displays

    def renamed(self, source: str, name: str) -> ColorTags:
        """Return the same tags with another name of their source."""
        sources = (text.replace(source, name) for text in (self.source, self.transfer_source))
        return ColorTags(self.primaries, self.transfer, *sources)


def cicp_tags(codes: Sequence[int]) -> ColorTags:
    """Return the tags of code points, at least ColourPrimaries and TransferCharacteristics; empty if unspecified."""
    if len(codes) < 2:
        return ColorTags()
    source = "" if codes[0] in UNSPECIFIED else "CICP" if codes[0] in PRIMARIES else f"CICP primaries {codes[0]}"
    encoding = "" if codes[1] in UNSPECIFIED else "CICP"
    return ColorTags(PRIMARIES.get(codes[0]), TRANSFERS.get(codes[1], ""), source, encoding)


def profile_transfer(profile: str) -> str:
    """Return the encoding that an ICC profile's description names; empty if none."""
    text = profile.casefold().replace("_", " ")  # which would not end a word for `\b`
    return next((name for words, name in PROFILE_TRANSFERS if re.search(words, text)), "")
