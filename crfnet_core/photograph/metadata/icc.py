"""ICC profiles: the primaries of a matrix profile, and whether the curve of any profile is linear, PQ, HLG or log.

Pillow's ImageCms (LittleCMS) reads them. Source: ISO 15076-1:2010 (ICC.1:2010, version 4.3), and ICC.1:2022 for the tag
`cicp`; ITU-R BT.2100-2 for PQ and HLG.
"""

import io
import re
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from PIL import Image, ImageCms

from crfnet_core.colorimetry import D50, PHOTOGRAPHIC, Primaries, adaptation, chromaticity_of
from crfnet_core.photograph.metadata.color_tags import ColorTags, cicp_tags, profile_transfer
from crfnet_core.types import Float64Array


def _pq_stops(codes: Float64Array) -> Float64Array:
    """Return the light of PQ codes above 0 in stops below 10 000 cd/m2 (table 4)."""
    power = codes ** (32 / 2523)
    return np.asarray(np.log2((power - 3424 / 4096) / (2413 / 128 - 2392 / 128 * power)) * 8192 / 1305)


def _hlg_stops(codes: Float64Array) -> Float64Array:
    """Return the scene light of HLG codes above 0 in stops below white (table 5)."""
    above = (np.exp((codes - 0.55991073) / 0.17883277) + 0.28466892) / 12
    return np.asarray(np.log2(np.where(codes <= 0.5, codes**2 / 3, above)))


#: The source of tags from an ICC profile; from one that works by tables, one of CMYK or Lab, and a damaged one.
SOURCE, TABLES = "ICC profile", "ICC profile of tables"
OTHER_COLORS, DAMAGED = "ICC profile of other colors", "damaged ICC profile"

#: Largest difference in XYZ from named primaries by which a profile's colorants count as theirs. Known profiles differ
#: by up to 0.0002 (rounding to four digits, other values of D65); two of the named spaces by 0.06 or more.
SAME_COLORANTS = 0.002

#: XYZ of the profile connection space's white, D50 (7.2.16 of the specification), and the largest difference from it of
#: the sum of the colorants of a profile that is not damaged.
PCS_WHITE, SAME_WHITE = np.array([0.9642, 1.0, 0.8249]), 0.02

#: Codes of a gray ramp, and the least range of its L*; a damaged profile may make it flat.
_RAMP, LEAST_LIGHTNESS = np.arange(8, 256, 8, dtype=np.uint8), 30

#: Largest difference in L* between the ramp of a linear profile and linear light: gamma 1.05 has 2.2, sRGB 23.
SAME_LIGHTNESS = 1.5

#: Lightness between which a curve is compared: below, 8 bits are too coarse, and above it may be clipped; and the least
#: number of codes there.
_COMPARED, LEAST_COMPARED = (8, 98.5), 9

#: Encoding -> the curve of its light, in stops; the powers of it that occur, as a display may add one; and the largest
#: difference in stops. Log curves are like PQ, but for their exponent. sRGB and powers differ from all by 0.33.
_ENCODINGS: dict[str, tuple[Callable[[Float64Array], Float64Array], tuple[float, float], float]] = {
    "PQ": (_pq_stops, (0.988, 1.012), 0.035),
    "log": (_pq_stops, (0.9, 1.1), 0.08),
    "HLG": (_hlg_stops, (0.9, 1.3), 0.08),
}

#: Color space of a profile -> Pillow's mode of its pictures.
_MODES = {"RGB": "RGB", "GRAY": "L"}

#: The element `cicp`: its type, four zeros, and the code points. Pillow does not hand it out.
_CICP = re.compile(rb"cicp\0{4}(....)", re.DOTALL)


def read_icc(profile: bytes) -> ColorTags:
    """Return the tags of an ICC profile; empty without one, or if it is of gray and of an ordinary curve."""
    try:
        return _color_tags(profile, ImageCms.ImageCmsProfile(io.BytesIO(profile)))
    except (OSError, ImageCms.PyCMSError, np.linalg.LinAlgError, ValueError):  # damaged names are a ValueError
        return ColorTags(source=DAMAGED if profile else "")


def _color_tags(profile: bytes, opened: ImageCms.ImageCmsProfile) -> ColorTags:
    """Return the tags of a profile."""
    facts = cast(Any, opened.profile)
    space = facts.xcolor_space.strip()
    transfer = profile_transfer(facts.profile_description or "")
    if space not in _MODES:
        return ColorTags(transfer=transfer, source=OTHER_COLORS)
    transfer = transfer or _encoding(opened, _MODES[space])
    if space != "RGB":
        return ColorTags(transfer=transfer, source=SOURCE) if transfer else ColorTags()
    is_matrix = facts.is_matrix_shaper and facts.connection_space.strip() == "XYZ" and b"A2B0" not in profile
    element = _CICP.search(profile)
    codes = cicp_tags(element[1]) if element else ColorTags()
    primaries = (_primaries(facts) if is_matrix else None) or codes.primaries
    source = SOURCE if primaries else TABLES if b"A2B" in profile else DAMAGED
    return ColorTags(primaries, codes.transfer or transfer, source)


def _encoding(profile: ImageCms.ImageCmsProfile, mode: str) -> str:
    """Return the encoding that the lightness of a gray ramp shows, whatever the tags are; or none."""
    ramp = Image.fromarray(_RAMP[None, :]).convert(mode)
    intent = ImageCms.Intent.RELATIVE_COLORIMETRIC
    try:
        to_lab = ImageCms.buildTransform(profile, ImageCms.createProfile("LAB"), mode, "LAB", intent)
        lightness = np.asarray(ImageCms.applyTransform(ramp, to_lab))[0, :, 0] / 2.55
    except (ImageCms.PyCMSError, ValueError):
        return ""
    if np.ptp(lightness) <= LEAST_LIGHTNESS:
        return ""
    if lightness[0] > lightness[-1]:
        return "a negative"
    if _is_linear(lightness):
        return "linear"
    is_compared = (lightness > _COMPARED[0]) & (lightness < _COMPARED[1])
    stops, codes = 3 * np.log2((lightness[is_compared] + 16) / 116), _RAMP[is_compared] / 255
    if len(codes) < LEAST_COMPARED:
        return ""
    for name, (curve, powers, most) in _ENCODINGS.items():
        fit = np.polynomial.Polynomial.fit(curve(codes), stops, 1)
        if powers[0] < fit.deriv()(0) < powers[1] and np.abs(fit(curve(codes)) - stops).max() < most:
            return name
    return ""


def _is_linear(lightness: Float64Array) -> bool:
    """Return whether a ramp has the lightness of linear light (CIE 15:2018, 8.2.1), wherever its ends lie."""
    first, last = ((lightness[[0, -1]] + 16) / 116) ** 3
    expected = 116 * np.cbrt(np.linspace(first, last, len(_RAMP))) - 16
    return bool(np.abs(lightness - expected).max() < SAME_LIGHTNESS)


def _primaries(facts: Any) -> Primaries | None:
    """Return the primaries of the colorants; None if they are damaged."""
    columns = [facts.red_colorant, facts.green_colorant, facts.blue_colorant]
    if None in columns:
        return None
    colorants = np.stack([column[0] for column in columns], axis=1)  # (3, 3), XYZ under D50
    if np.abs(colorants.sum(axis=1) - PCS_WHITE).max() > SAME_WHITE:
        return None
    for named in PHOTOGRAPHIC.values():
        if np.abs(colorants - adaptation(named.white, D50) @ named.to_xyz()).max() < SAME_COLORANTS:
            return named
    try:
        return _unnamed(np.asarray(np.linalg.solve(_to_pcs(facts), colorants), np.float64))
    except np.linalg.LinAlgError:
        return None


def _to_pcs(facts: Any) -> Float64Array:
    """Return the matrix by which the profile's maker adapted the colorants to D50, shape (3, 3)."""
    if facts.chromatic_adaptation is not None:
        return np.array(facts.chromatic_adaptation[0])
    white = facts.media_white_point
    if facts.version >= 4 or white is None or min(white[0]) <= 0.1:
        return np.eye(3)
    return adaptation(chromaticity_of(white[0]), D50)


def _unnamed(matrix: Float64Array) -> Primaries | None:
    """Return the primaries of a matrix from RGB to XYZ, shape (3, 3); None if they make no white."""
    if abs(np.linalg.det(matrix)) < 1e-4 or (matrix.sum(axis=0) <= 0).any():
        return None
    red, green, blue, white = (chromaticity_of(xyz) for xyz in (*matrix.T, matrix.sum(axis=1)))
    return Primaries("primaries of its own", red, green, blue, white) if white[1] > 0 else None
