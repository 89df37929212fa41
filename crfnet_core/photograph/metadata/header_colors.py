"""Color tags in an image file's header: of the ICC profile, CICP, PNG, EXIF and OpenEXR, in order of precedence."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from crfnet_core.colorimetry import ADOBE_RGB, AP0, AP1, DISPLAY_P3, REC709, REC2020, Primaries
from crfnet_core.photograph.metadata.color_tags import DPX_TRANSFERS, NAMED, ColorTags, cicp_tags
from crfnet_core.photograph.metadata.icc import DAMAGED, read_icc

#: EXIF ColorSpace: 1 is sRGB; 2, of no standard, is written for Adobe RGB; 65535 leaves it to the next.
EXIF_PRIMARIES = {1: REC709, 2: ADOBE_RGB}

#: InteroperabilityIndex of DCF 2.0: of a basic file, and of an option file, in Adobe RGB; and our name of it.
INTEROP_INDEX = "Exif:InteroperabilityIndex"
DCF_PRIMARIES = {"R98": REC709, "R03": ADOBE_RGB}

#: The parts of a Color Interop Forum name, such as "pq_p3d65_display", that stand for the primaries and the encoding.
_INTEROP_TRANSFERS = {"lin": "linear", "pq": "PQ", "hlg": "HLG"}
_INTEROP = {"rec709": REC709, "p3d65": DISPLAY_P3, "adobergb": ADOBE_RGB, "rec2020": REC2020, "ap0": AP0, "ap1": AP1}

#: Largest difference from named primaries by which chromaticities count as theirs: they are written with four digits.
#: Least area of the triangle of primaries in x and y, doubled: Rec.709 has 0.22. How far from 1 a linear gamma may be.
SAME_CHROMATICITIES, LEAST_AREA, LINEAR_GAMMA = 2e-4, 0.01, 0.04


def header_color_tags(header: Any, file_format: str, interop_index: str = "") -> ColorTags:
    """Return the color tags of an open file: the primaries, and the encoding, of the first source that has any.

    The ICC profile comes before CICP, in PNG behind it (PNG Specification, third edition, 4.3); damaged, it comes last.
    OpenImageIO does not read EXIF's InteroperabilityIndex: the readers of files other than JPEG put it there.
    """
    icc = read_icc(bytes(np.asarray(_sequence(header, "ICCProfile"), dtype=np.uint8)))
    codes = cicp_tags(_sequence(header, "CICP"))
    tags = [codes, icc, *_png_tags(header)] if file_format == "PNG" else [icc, codes]
    tags.append(_exif_tags(header, interop_index or header_attribute(header, INTEROP_INDEX)))
    if file_format == "OpenEXR":
        tags += [_interop_tags(header), _chromaticity_tags(header, "chromaticities")]
    name = str(header_attribute(header, "dpx:Transfer"))
    if file_format == "DPX" and name in DPX_TRANSFERS:
        tags.append(ColorTags(transfer=DPX_TRANSFERS[name], transfer_source=f'dpx:Transfer "{name}"'))
    tags.sort(key=lambda each: each.source == DAMAGED)
    color = next((each for each in tags if each.source), ColorTags())
    encoding = next((each for each in tags if each.transfer_source), ColorTags())
    return ColorTags(color.primaries, encoding.transfer, color.source, encoding.transfer_source)


def header_attribute(header: Any, name: str) -> Any:
    """Return a value in the header; None where it is absent or not a value of Python's."""
    try:
        return header.getattribute(name)
    except (RuntimeError, TypeError, ValueError):
        return None


def _png_tags(header: Any) -> tuple[ColorTags, ...]:
    """Return the tags of PNG's other chunks: a gamma of 1 is linear."""
    gamma = header_attribute(header, "png:gamma")
    is_linear = isinstance(gamma, float) and abs(gamma - 1) < LINEAR_GAMMA
    is_srgb = header_attribute(header, "png:sRGB") is not None
    srgb = ColorTags(REC709, "", "sRGB chunk", "sRGB chunk") if is_srgb else ColorTags()
    linear = ColorTags(transfer="linear", transfer_source="gAMA chunk") if is_linear else ColorTags()
    return srgb, _chromaticity_tags(header, "cHRM chunk"), linear


def _exif_tags(header: Any, interop_index: str | None) -> ColorTags:
    """Return the tags of EXIF; an uncalibrated picture has none."""
    space = header_attribute(header, "Exif:ColorSpace")
    primaries = EXIF_PRIMARIES.get(space if isinstance(space, int) else 0) or DCF_PRIMARIES.get(interop_index or "")
    return ColorTags(primaries, source="EXIF") if primaries else ColorTags()


def _interop_tags(header: Any) -> ColorTags:
    """Return the tags of the Color Interop Forum's name; of primaries without a name there, chromaticities tell."""
    name, source = header_attribute(header, "colorInteropID"), "colorInteropID"
    parts = name.split("_") if isinstance(name, str) else []
    if len(parts) < 3:
        return ColorTags()
    primaries = _INTEROP.get(parts[1])
    is_named = primaries or not _chromaticity_tags(header, source).source
    return ColorTags(primaries, _INTEROP_TRANSFERS.get(parts[0], ""), source if is_named else "", source)


def _chromaticity_tags(header: Any, source: str) -> ColorTags:
    """Return the tags of chromaticities in OpenEXR and PNG; none if the primaries lie on a line."""
    numbers = np.ravel(_sequence(header, "chromaticities"))
    if numbers.size != 8 or not np.isfinite(numbers).all():
        return ColorTags()
    corners = numbers.reshape(4, 2)  # of red, green, blue and white
    for named in NAMED:
        if np.abs(named.corners - corners).max() < SAME_CHROMATICITIES:
            return ColorTags(named, source=source)
    area = abs(np.linalg.det(np.column_stack([corners[:3], np.ones(3)])))
    if area <= LEAST_AREA or corners[3].min() <= 0:
        return ColorTags()
    red, green, blue, white = ((float(x), float(y)) for x, y in corners)
    return ColorTags(Primaries("primaries of its own", red, green, blue, white), source=source)


def _sequence(header: Any, name: str) -> Sequence[Any]:
    """Return an array of numbers in the header; empty where it is absent."""
    value = header_attribute(header, name)
    return () if value is None or isinstance(value, str | int | float) else value
