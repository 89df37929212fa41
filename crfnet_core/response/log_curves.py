"""Curves of log footage, as the makers of cameras publish them: reflectance to code value, and back.

Reflectance is scene-linear light of which 0.18 is a middle gray and 0.9 a white paper; highlights go beyond 1. Code
values are fractions of the largest code, as the file stores them: black lies well above 0.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.types import Float64Array

LogCurve = Callable[[ArrayLike], Float64Array]

#: Reflectances between which a curve is inverted: above the brightest light that any of them holds.
LEAST_REFLECTANCE, MOST_REFLECTANCE = 1e-5, 1000.0

#: Curve -> color space of OpenColorIO's ACES studio config, with the maker's usual primaries; S-Log3 and Canon's have
#: more than one.
COLOR_SPACES = {
    "ARRI LogC3": "ARRI LogC3 (EI800)",
    "ARRI LogC4": "ARRI LogC4",
    "Apple Log": "Apple Log",
    "Blackmagic Film Gen 5": "BMDFilm WideGamut Gen5",
    "Canon Log 2": "CanonLog2 CinemaGamut D55",
    "Canon Log 3": "CanonLog3 CinemaGamut D55",
    "DJI D-Log": "D-Log D-Gamut",
    "Panasonic V-Log": "V-Log V-Gamut",
    "RED Log3G10": "Log3G10 REDWideGamutRGB",
    "Sony S-Log3": "S-Log3 S-Gamut3.Cine",
}


@dataclass(frozen=True)
class LinearToe:
    """The form that most makers use: c log10(a x + b) + d from the reflectance `cut` on, and e x + f below it."""

    cut: float
    a: float
    b: float
    c: float
    d: float
    e: float
    f: float

    def __call__(self, reflectance: ArrayLike) -> Float64Array:
        """Return code values, float64, of the shape of `reflectance`; nothing is clipped."""
        x = np.asarray(reflectance, dtype=np.float64)
        above = np.maximum(x, self.cut)
        return np.where(x < self.cut, self.e * x + self.f, self.c * np.log10(self.a * above + self.b) + self.d)


def arri_logc4(reflectance: ArrayLike) -> Float64Array:
    """Return code values of LogC4 (ARRI, "LogC4 Logarithmic Color Space: Specification", 2022)."""
    x = np.asarray(reflectance, dtype=np.float64)
    a, b, c = (2.0**18 - 16) / 117.45, (1023 - 95) / 1023, 95 / 1023
    s = 7 * np.log(2) * 2 ** (7 - 14 * c / b) / (a * b)
    t = (2 ** (14 * -c / b + 6) - 64) / a
    return np.where(x < t, (x - t) / s, (np.log2(a * np.maximum(x, t) + 64) - 6) / 14 * b + c)


def apple_log(reflectance: ArrayLike) -> Float64Array:
    """Return code values of Apple Log ("Apple Log Profile White Paper", 2023), whose toe is a parabola from -0.0564."""
    x = np.maximum(np.asarray(reflectance, dtype=np.float64), -0.05641088)
    above = np.maximum(x, 0.01)
    return np.where(
        x < 0.01, 47.28711236 * (x + 0.05641088) ** 2, 0.08550479 * np.log2(above + 0.00964052) + 0.69336945
    )


def nikon_nlog(reflectance: ArrayLike) -> Float64Array:
    """Return code values of N-Log (Nikon, "N-Log Specification Document"), a cube root below a reflectance of 0.328."""
    x = np.maximum(np.asarray(reflectance, dtype=np.float64), -0.0075)
    return np.where(x < 0.328, 650 * np.cbrt(x + 0.0075), 150 * np.log(np.maximum(x, 0.328)) + 619) / 1023


#: Curve -> function from reflectance (any shape) to code values in about [0.09, 1], not clipped.
LOG_CURVES: dict[str, LogCurve] = {
    # ARRI, "ALEXA Log C Curve: Usage in VFX" (2012), SUP 3.x, linear scene exposure factor at EI 800.
    "ARRI LogC3": LinearToe(0.010591, 5.555556, 0.052272, 0.247190, 0.385537, 5.367655, 0.092809),
    "ARRI LogC4": arri_logc4,
    "Apple Log": apple_log,
    # Blackmagic Design, "Blackmagic Generation 5 Color Science" (2021): A ln(x + B) + C, and D x + E below 0.005.
    "Blackmagic Film Gen 5": LinearToe(
        *(0.005, 1, 0.005494072432257808, 0.08692876065491224 * np.log(10), 0.5300133392291939),
        *(8.283605932402494, 0.09246575342465753),
    ),
    # Canon, "Input Transform Version 202007", v1.2, whose x is reflectance / 0.9. The curves of Canon Log and Canon Log
    # 2 are mirrored below black: here their tangents go on. Canon Log 3 bends once more below x = -0.014: here not.
    "Canon Log": LinearToe(
        *(0, 10.1596 / 0.9, 1, 0.45310179, 0.12512248, 0.45310179 * 10.1596 / 0.9 / np.log(10), 0.12512248)
    ),
    "Canon Log 2": LinearToe(
        *(0, 87.09937546 / 0.9, 1, 0.24136077, 0.092864125), *(0.24136077 * 87.09937546 / 0.9 / np.log(10), 0.092864125)
    ),
    "Canon Log 3": LinearToe(0.014 * 0.9, 14.98325 / 0.9, 1, 0.36726845, 0.12240537, 1.9754798 / 0.9, 0.12512219),
    # DJI, "White Paper on D-Log and D-Gamut" (2017).
    "DJI D-Log": LinearToe(0.0078, 0.9892, 0.0108, 0.256663, 0.584555, 6.025, 0.0929),
    # Fujifilm, "F-Log Data Sheet Ver. 1.1" and "F-Log2 Data Sheet Ver. 1.0".
    "Fujifilm F-Log": LinearToe(0.00089, 0.555556, 0.009468, 0.344676, 0.790453, 8.735631, 0.092864),
    "Fujifilm F-Log2": LinearToe(0.000889, 5.555556, 0.064829, 0.245281, 0.384316, 8.799461, 0.092864),
    "Nikon N-Log": nikon_nlog,
    # Panasonic, "VARICAM V-Log/V-Gamut" (2014).
    "Panasonic V-Log": LinearToe(0.01, 1, 0.00873, 0.241514, 0.598206, 5.6, 0.125),
    # RED Digital Cinema, "White Paper on REDWideGamutRGB and Log3G10" (2017).
    "RED Log3G10": LinearToe(-0.01, 155.975327, 1 + 0.01 * 155.975327, 0.224282, 0, 15.1927, 0.01 * 15.1927),
    # Sony, "S-Log2 Technical Paper" (2012): S-Log of 155 x / 219 of x = reflectance / 0.9, in the codes 64 to 940.
    "Sony S-Log2": LinearToe(
        *(0, 155 / 219 / 0.9, 0.037584, 0.432699 * 876 / 1023, ((0.616596 + 0.03) * 876 + 64) / 1023),
        *(3.53881278538813 / 0.9 * 876 / 1023, (0.030001222851889303 * 876 + 64) / 1023),
    ),
    # Sony, "Technical Summary for S-Gamut3.Cine/S-Log3 and S-Gamut3/S-Log3".
    "Sony S-Log3": LinearToe(
        *(0.01125, 1 / 0.19, 0.01 / 0.19, 261.5 / 1023, 420 / 1023),
        *((171.2102946929 - 95) / 0.01125 / 1023, 95 / 1023),
    ),
}


def reflectance_of(curve: LogCurve, codes: Float64Array) -> Float64Array:
    """Return the reflectances of code values."""
    reflectance = np.geomspace(LEAST_REFLECTANCE, MOST_REFLECTANCE, 4096)
    return np.interp(codes, curve(reflectance), reflectance)
