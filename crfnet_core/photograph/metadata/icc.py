"""ICC profiles: the primaries of a matrix profile, and whether the curve of any profile is linear, PQ, HLG or log.

Pillow's ImageCms (LittleCMS) reads them. Source: ISO 15076-1:2010 (ICC.1:2010, version 4.3), and ICC.1:2022 for the tag
`cicp`; ITU-R BT.2100-2 for PQ and HLG.
"""

import io
import struct
from contextlib import suppress
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageCms

from crfnet_core.colorimetry import D50, Primaries, adaptation, chromaticity_of
from crfnet_core.photograph.metadata.color_tags import NAMED, ColorTags, cicp_tags, profile_transfer
from crfnet_core.response.log_curves import LOG_CURVES, reflectance_of
from crfnet_core.types import BoolArray, Float64Array

#: The source of tags from an ICC profile; from one that works by tables, one of CMYK or Lab, and a damaged one.
SOURCE, TABLES = "ICC profile", "ICC profile of tables"
OTHER_COLORS, DAMAGED = "ICC profile of other colors", "damaged ICC profile"

#: Largest difference in XYZ from named primaries by which a profile's colorants count as theirs. Known profiles differ
#: by up to 0.0002 (rounding to four digits, other values of D65); two of the named spaces by 0.06 or more.
SAME_COLORANTS = 0.002

#: XYZ of the profile connection space's white, D50 (7.2.16 of the specification), and the largest difference from it of
#: the sum of the colorants of a profile that is not damaged.
PCS_WHITE, SAME_WHITE = np.array([0.9642, 1.0, 0.8249]), 0.02

#: The codes of a gray ramp, and the least range of its L*; a damaged profile may make it flat.
_RAMP, LEAST_LIGHTNESS = np.arange(1, 256, dtype=np.uint8), 30

#: Largest difference in L* between the ramp of a linear profile and linear light: gamma 1.05 has 2.2, sRGB 23. And the
#: least exponent of a display's curve: 1.8 occurs.
SAME_LIGHTNESS, LEAST_POWER = 1.5, 1.3

#: Lightness between which a curve is compared: below, 8 bits are too coarse, and above it may be clipped; and the least
#: number of codes there.
_COMPARED, LEAST_COMPARED = (8, 98.5), 70

#: Largest difference in stops from a published curve, of any exposure: rounding makes 0.035, sRGB and powers up to 3
#: differ from all by 0.4; and the powers of HLG that occur, as a display may add one.
SAME_STOPS, HLG_POWERS = 0.04, (0.9, 1.3)

#: A log curve that is not known: half the code is darker by more stops than by a gamma of 3.4, and the lower quarter of
#: codes has at most 1.25 times as many of them as the upper one: 1 of logarithms, 1.4 of powers.
LOG_STOPS, LOG_STRAIGHT = 3.4, 1.25

MOST_COLORED = 0.35  # largest range, in stops, of X and Z against Y along the ramp: gammas of 2.2, 2.2 and 2.4 make 0.5
_MODES = {"RGB": "RGB", "GRAY": "L"}  # color space of a profile -> Pillow's mode of its pictures


def read_icc(profile: bytes) -> ColorTags:
    """Return the tags of an ICC profile; empty without one, or if it is of gray and of an ordinary curve."""
    try:
        return _color_tags(profile, ImageCms.ImageCmsProfile(io.BytesIO(profile)))
    except (OSError, ImageCms.PyCMSError, np.linalg.LinAlgError, ValueError):
        return ColorTags(source=DAMAGED if profile else "")


def _color_tags(profile: bytes, opened: ImageCms.ImageCmsProfile) -> ColorTags:
    """Return the tags of a profile. Its curve outweighs its name, unless tables may show it as a display does."""
    facts, elements, named = cast(Any, opened.profile), _elements(profile), ""
    with suppress(ValueError):  # names of version 2 in other letters than ASCII
        named = profile_transfer(facts.profile_description or "")
    space = facts.xcolor_space.strip()
    if space not in _MODES:
        return ColorTags(None, named, OTHER_COLORS, OTHER_COLORS if named else "")
    codes = cicp_tags(elements.get(b"cicp", b"")[8:])
    has_tables = any(name.startswith((b"A2B", b"D2B")) for name in elements)
    transfer = codes.transfer
    if not codes.transfer_source:
        transfer = _encoding(opened, _MODES[space], named, is_exact=not has_tables) or (named if has_tables else "")
    is_matrix = facts.is_matrix_shaper and facts.connection_space.strip() == "XYZ" and not has_tables
    primaries = (_primaries(facts) if is_matrix else None) or codes.primaries
    source = SOURCE if primaries else TABLES if has_tables else DAMAGED
    return ColorTags(primaries, transfer, source if space == "RGB" else "", SOURCE)


def _elements(profile: bytes) -> dict[bytes, bytes]:
    """Return the elements of a profile by their names of four letters (7.3); those that its bytes hold."""
    table = profile[132 : 132 + 12 * int.from_bytes(profile[128:132])]
    rows = struct.iter_unpack(">4sII", table[: len(table) // 12 * 12])
    return {name: profile[start : start + size] for name, start, size in rows}


def _encoding(profile: ImageCms.ImageCmsProfile, mode: str, named: str, *, is_exact: bool) -> str:
    """Return the encoding that a gray ramp shows, or none; `named` where it is one of several, or none can show.

    The gray of scanners and printers, whose profiles have tables and are not exact, may have any color.
    """
    ramp, intent = Image.fromarray(_RAMP[None, :]).convert(mode), ImageCms.Intent.RELATIVE_COLORIMETRIC
    lab = ImageCms.createProfile("LAB")
    try:
        to_lab = ImageCms.buildTransform(profile, lab, mode, "LAB", intent, ImageCms.Flags.NOOPTIMIZE)
        colors = np.asarray(ImageCms.applyTransform(ramp, to_lab))[0]
    except (ImageCms.PyCMSError, ValueError):
        return named
    lightness = colors[:, 0] / 2.55
    is_compared = (lightness > _COMPARED[0]) & (lightness < _COMPARED[1])
    if np.ptp(lightness) <= LEAST_LIGHTNESS or np.count_nonzero(is_compared) < LEAST_COMPARED:
        return named
    if lightness[0] > lightness[-1]:
        return "a negative"
    if is_exact and _is_colored(colors[is_compared]):
        return "three channels of different curves"
    if _is_linear(lightness):
        return "linear"
    stops = 3 * np.log2((lightness + 16) / 116)
    is_display = not is_exact or stops[len(_RAMP) // 2] < -LEAST_POWER  # half the code is a stop of a linear curve
    return _published(stops, is_compared, named) or ("" if is_display else "nearly linear")


def _is_colored(colors: NDArray[np.uint8]) -> bool:
    """Return whether L*, a* and b*, each of 8 bits, change their chromaticity, as of channels of different curves."""
    luminance, (red, yellow) = (colors[:, 0] / 2.55 + 16) / 116, colors[:, 1:].view(np.int8).T
    others = np.maximum([luminance + red / 500, luminance - yellow / 200], 0.01)  # cube roots of X and Z
    return bool(np.ptp(3 * np.log2(others / luminance), axis=1).max() > MOST_COLORED)


def _published(stops: Float64Array, is_compared: BoolArray, named: str) -> str:
    """Return the published encoding that a ramp has, "log" of several or of one that is not known; or none."""
    near = []
    for name, known in _published_stops().items():
        powers = HLG_POWERS if name == "HLG" else (1, 1)
        power = np.clip(np.polyfit(known[is_compared], stops[is_compared], 1)[0], *powers)
        if np.ptp((stops - power * known)[is_compared]) / 2 < SAME_STOPS:
            near.append(name)
    top = np.flatnonzero(is_compared)[-1]
    dark, bright = np.diff(stops[[top // 2, 3 * top // 4, top]])
    if not near and (dark + bright < LOG_STOPS or dark > LOG_STRAIGHT * bright):
        return ""
    if named in near or not near:
        return named or "log"
    return near[0] if len(near) == 1 else "log"


@cache
def _published_stops() -> dict[str, Float64Array]:
    """Return the light of the ramp in stops by published curves, of an exposure of their own."""
    codes = _RAMP / 255
    power = codes ** (32 / 2523)  # PQ: table 4
    pq = np.log2((power - 3424 / 4096) / (2413 / 128 - 2392 / 128 * power)) * 8192 / 1305
    bright = (np.exp((codes - 0.55991073) / 0.17883277) + 0.28466892) / 12  # HLG: table 5
    logs = {name: np.log2(reflectance_of(curve, codes)) for name, curve in LOG_CURVES.items()}
    return {"PQ": pq, "HLG": np.log2(np.where(codes <= 0.5, codes**2 / 3, bright))} | logs


def _is_linear(lightness: Float64Array) -> bool:
    """Return whether a ramp has the lightness of linear light (CIE 15:2018, 8.2.1), wherever its ends lie."""
    first, last = ((lightness[[0, -1]] + 16) / 116) ** 3
    expected = 116 * np.cbrt(np.linspace(first, last, len(_RAMP))) - 16
    return bool(np.abs(lightness - expected).max() < SAME_LIGHTNESS)


def _primaries(facts: Any) -> Primaries | None:
    """Return the primaries of the colorants; None if they are damaged, or make no white."""
    columns = [facts.red_colorant, facts.green_colorant, facts.blue_colorant]
    if None in columns:
        return None
    colorants = np.stack([column[0] for column in columns], axis=1)  # (3, 3), XYZ under D50
    if np.abs(colorants.sum(axis=1) - PCS_WHITE).max() > SAME_WHITE:
        return None
    for named in NAMED:
        if np.abs(colorants - adaptation(named.white, D50) @ named.to_xyz()).max() < SAME_COLORANTS:
            return named
    with suppress(np.linalg.LinAlgError):
        matrix = np.linalg.solve(_to_pcs(facts), colorants)
        if abs(np.linalg.det(matrix)) >= 1e-4 and (matrix.sum(axis=0) > 0).all():
            red, green, blue, white = (chromaticity_of(xyz) for xyz in (*matrix.T, matrix.sum(axis=1)))
            return Primaries("primaries of its own", red, green, blue, white) if white[1] > 0 else None
    return None


def _to_pcs(facts: Any) -> Float64Array:
    """Return the matrix by which the profile's maker adapted the colorants to D50, shape (3, 3)."""
    if facts.chromatic_adaptation is not None:
        return np.array(facts.chromatic_adaptation[0])
    white = facts.media_white_point
    if facts.version >= 4 or white is None or min(white[0]) <= 0.1:
        return np.eye(3)
    return adaptation(chromaticity_of(white[0]), D50)
