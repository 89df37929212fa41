"""Matrix, primaries and transfer functions as streams tag them, by the numbers of ITU-T H.273 (CICP)."""

from __future__ import annotations

from dataclasses import dataclass

from crfnet_core.metadata.color_tags import DISPLAY_P3, REC709, REC2020, Primaries

#: H.273 ColourPrimaries. BT.601's two systems are those of ITU-R BT.601-7; DCI-P3 has the white of SMPTE RP 431-2.
PRIMARIES = {
    1: REC709,
    5: Primaries("Rec.601 (625 lines)", (0.64, 0.33), (0.29, 0.60), (0.15, 0.06)),
    6: (REC601_525 := Primaries("Rec.601 (525 lines)", (0.630, 0.340), (0.310, 0.595), (0.155, 0.070))),
    7: REC601_525,
    9: REC2020,
    11: Primaries("DCI-P3", (0.68, 0.32), (0.265, 0.69), (0.15, 0.06), (0.314, 0.351)),
    12: DISPLAY_P3,
}

#: H.273 MatrixCoefficients -> name, and the weights of red and blue in luma.
MATRICES = {
    1: ("BT.709", 0.2126, 0.0722),
    4: ("FCC", 0.30, 0.11),
    5: ("BT.601", 0.299, 0.114),
    6: ("BT.601", 0.299, 0.114),
    7: ("SMPTE 240M", 0.212, 0.087),
    9: ("BT.2020", 0.2627, 0.0593),
}

#: MatrixCoefficients of RGB, and of a stream that does not say.
RGB, UNSPECIFIED = 0, 2

#: AVColorRange: full, where black is code 0 and white the largest.
FULL_RANGE = 2

#: Lines from which an untagged stream is taken to have the matrix of BT.709, below it that of BT.601.
HD_LINES = 720


@dataclass(frozen=True)
class PublishedCurve:
    """A transfer function that is published, so that no response need be estimated.

    Parameters
    ----------
    name : str
        As `ColorTags.transfer` has it.
    standard : str
        Who publishes it.
    color_space : str
        The colour space to choose, by its name in OpenColorIO's studio config; empty if that has none.
    """

    name: str
    standard: str
    color_space: str = ""

    @property
    def advice(self) -> str:
        """What to do with footage of this curve, as the second part of an error message."""
        space = f'give it the color space "{self.color_space}" of an ACES studio config' if self.color_space else ""
        return (
            f"is tagged {self.name} ({self.standard}), whose curve is published, so there is no response to estimate;"
            f" {space or 'linearize it with that curve'}"
        )


#: H.273 TransferCharacteristics that are not those of ordinary pictures.
TRANSFERS = {
    8: PublishedCurve("linear", "H.273"),
    9: PublishedCurve("Log 100:1", "H.273"),
    10: PublishedCurve("Log 316:1", "H.273"),
    16: PublishedCurve("PQ", "SMPTE ST 2084, ITU-R BT.2100", "Rec.2100-PQ - Display"),
    18: PublishedCurve("HLG", "ARIB STD-B67, ITU-R BT.2100", "Rec.2100-HLG - Display"),
}


@dataclass(frozen=True)
class Coding:
    """How a stream codes RGB.

    Parameters
    ----------
    matrix : str
        Name of the matrix; "RGB" if the stream holds RGB or gray.
    red, blue : float
        Weights of red and blue in luma (K_R and K_B of H.273, 8.3).
    is_full_range : bool
        Whether black is code 0 and white the largest; otherwise 16 and 235, times 2 ** (bits - 8).
    is_centered : bool
        Whether chroma samples lie between luma samples horizontally, as in JPEG, and not on them, as in video.
    assumptions : tuple of str
        What the stream does not say, and what was taken instead, in words.
    """

    matrix: str
    red: float
    blue: float
    is_full_range: bool
    is_centered: bool
    assumptions: tuple[str, ...] = ()

    @classmethod
    def of(cls, *, matrix: int, color_range: int, is_rgb: bool, is_jpeg: bool, lines: int) -> Coding | None:
        """Return the coding that tags describe; None if the matrix is none of `MATRICES`.

        Parameters
        ----------
        matrix : int
            H.273 MatrixCoefficients.
        color_range : int
            AVColorRange: 0 for a stream that does not say, 1 for limited, 2 for full.
        is_rgb : bool
            Whether the decoder gives RGB.
        is_jpeg : bool
            Whether the stream is made of JPEG pictures.
        lines : int
            Height of the picture as stored.
        """
        if is_rgb:
            return cls("RGB", 0.0, 0.0, True, False)
        assumptions = []
        if matrix in (UNSPECIFIED, RGB):
            matrix = 5 if is_jpeg or lines < HD_LINES else 1
            if not is_jpeg:
                assumptions.append(f"does not say its matrix: {MATRICES[matrix][0]} taken, as it has {lines} lines")
        if color_range == 0 and not is_jpeg:
            assumptions.append("does not say its range: limited taken")
        if matrix not in MATRICES:
            return None
        is_full_range = color_range == FULL_RANGE or (color_range == 0 and is_jpeg)
        return cls(*MATRICES[matrix], is_full_range, is_jpeg, tuple(assumptions))
