"""Code points of ITU-T H.273 (CICP), by which HEIC, AVIF, PNG, ICC profiles and movies tag their colours."""

from __future__ import annotations

from collections.abc import Sequence

from crfnet_core.colorimetry import Chromaticity
from crfnet_core.photograph.metadata.color_tags import DISPLAY_P3, REC709, REC2020, ColorTags, Primaries

#: CIE illuminant C, and the white of a cinema projector (SMPTE RP 431-2).
C: Chromaticity = (0.310, 0.316)
DCI: Chromaticity = (0.314, 0.351)

_SMPTE_C: tuple[Chromaticity, Chromaticity, Chromaticity] = ((0.63, 0.34), (0.31, 0.595), (0.155, 0.07))

#: ColourPrimaries of ITU-T H.273 (07/2021), Table 2. 2 is "unspecified"; 10, CIE XYZ, is no RGB of a camera.
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

#: TransferCharacteristics of ITU-T H.273, Table 3, that are no ordinary picture for a display.
TRANSFERS = {8: "linear", 9: "log 100:1", 10: "log 316:1", 16: "PQ", 18: "HLG"}


def cicp_tags(codes: Sequence[int]) -> ColorTags:
    """Return what code points say: at least ColourPrimaries and TransferCharacteristics.

    Codes that are unspecified or reserved say nothing.
    """
    if len(codes) < 2:
        return ColorTags()
    primaries, transfer = PRIMARIES.get(codes[0]), TRANSFERS.get(codes[1], "")
    return ColorTags(primaries, transfer, "CICP") if primaries or transfer else ColorTags()
