"""How streams code RGB: matrix and range, by the numbers of ITU-T H.273 (CICP)."""

from __future__ import annotations

from dataclasses import dataclass

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
    def of(
        cls, *, matrix: int, color_range: int, is_rgb: bool, is_gray: bool, is_jpeg: bool, lines: int
    ) -> Coding | None:
        """Return the coding that tags describe; None if the matrix is none of `MATRICES`.

        Parameters
        ----------
        matrix : int
            H.273 MatrixCoefficients.
        color_range : int
            AVColorRange: 0 for a stream that does not say, 1 for limited, 2 for full.
        is_rgb : bool
            Whether the decoder gives RGB.
        is_gray : bool
            Whether it gives gray, which has no matrix; it is taken for full range unless tagged, as FFmpeg takes it.
        is_jpeg : bool
            Whether the stream is made of JPEG pictures.
        lines : int
            Height of the picture as stored.
        """
        if is_rgb:
            return cls("RGB", 0.0, 0.0, is_full_range=True, is_centered=False)
        if is_gray:
            untold = ("does not say its range: full taken, as it is gray",) if color_range == 0 and not is_jpeg else ()
            return cls(
                "RGB", 0.0, 0.0, is_full_range=color_range in (0, FULL_RANGE), is_centered=False, assumptions=untold
            )
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
