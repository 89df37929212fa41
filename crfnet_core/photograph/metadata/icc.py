"""ICC profiles: the primaries of those that are a matrix and curves.

Source: ISO 15076-1:2010 (ICC.1:2010, version 4.3), and ICC.1:2022 for the tag `cicp`.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np

from crfnet_core.colorimetry import adaptation, chromaticity_of
from crfnet_core.photograph.metadata.color_tags import D50, PHOTOGRAPHIC, Primaries
from crfnet_core.types import Float64Array

#: XYZ of the profile connection space's white, D50 (7.2.16 of the specification).
PCS_WHITE = np.array([0.9642, 1.0, 0.8249])

#: Largest difference in XYZ by which a profile's colourants are still those of named primaries. Those at hand
#: differ by up to 0.0002 (rounding to four digits, other values of D65); two of the named spaces by 0.06 or more.
SAME_COLORANTS = 0.002

#: Largest difference in XYZ between PCS_WHITE and the sum of the colourants of a profile that is not damaged.
SAME_WHITE = 0.02

_SIGNATURE, _TAG_COUNT, _TAG_TABLE, _MAX_TAGS = slice(36, 40), 128, 132, 200
_FIXED = 65536.0  # s15Fixed16Number


@dataclass(frozen=True)
class IccProfile:
    """What a profile says of RGB.

    Parameters
    ----------
    is_rgb : bool
        Whether it is a profile of RGB; one of gray says nothing of primaries.
    primaries : Primaries, optional
        None if it works by tables, or is damaged.
    cicp : tuple of int
        Primaries, transfer, matrix and range as codes of ITU-T H.273, from the tag `cicp`; empty if it has none.
    """

    is_rgb: bool
    primaries: Primaries | None
    cicp: tuple[int, ...]


def read_icc(profile: bytes) -> IccProfile | None:
    """Return what an ICC profile says; None if these bytes are none. What is damaged counts as absent.

    Primaries are recognised by their matrix, not by the profile's description: that is free text. Of a matrix that is
    none of the named ones the adaptation to D50 is undone, by the tag `chad`, or in version 2 from the media white.
    """
    if len(profile) < _TAG_TABLE or profile[_SIGNATURE] != b"acsp":
        return None
    tags = _tags(profile)
    cicp = tags.get("cicp", b"")
    is_rgb, is_table = profile[16:20] == b"RGB ", "A2B0" in tags or profile[20:24] != b"XYZ "
    return IccProfile(
        is_rgb=is_rgb,
        primaries=_primaries(tags, version=profile[8]) if is_rgb and not is_table else None,
        cicp=tuple(cicp[8:12]) if len(cicp) >= 12 else (),
    )


def _tags(profile: bytes) -> dict[str, bytes]:
    """Return the tagged elements by signature; those outside the profile are left out."""
    (count,) = struct.unpack_from(">I", profile, _TAG_COUNT)
    tags = {}
    for index in range(min(count, _MAX_TAGS, (len(profile) - _TAG_TABLE) // 12)):
        name, offset, size = struct.unpack_from(">4sII", profile, _TAG_TABLE + 12 * index)
        tags[name.decode("latin-1")] = profile[offset : offset + size]
    return tags


def _numbers(tags: dict[str, bytes], name: str, count: int) -> Float64Array | None:
    """Return the first numbers of an element of fixed-point numbers, shape (count,); None if it is absent or short."""
    element = tags.get(name, b"")
    if len(element) < 8 + 4 * count:
        return None
    return np.array(struct.unpack_from(f">{count}i", element, 8)) / _FIXED


def _primaries(tags: dict[str, bytes], *, version: int) -> Primaries | None:
    """Return the primaries of the colourants."""
    columns = [_numbers(tags, name, 3) for name in ("rXYZ", "gXYZ", "bXYZ")]
    if any(column is None for column in columns):
        return None
    colorants = np.stack([column for column in columns if column is not None], axis=1)  # (3, 3), XYZ under D50
    if np.abs(colorants.sum(axis=1) - PCS_WHITE).max() > SAME_WHITE:
        return None
    for named in PHOTOGRAPHIC.values():
        if np.abs(colorants - adaptation(named.white, D50) @ named.to_xyz()).max() < SAME_COLORANTS:
            return named
    try:
        return _unnamed(np.asarray(np.linalg.solve(_to_pcs(tags, version=version), colorants), np.float64))
    except np.linalg.LinAlgError:
        return None


def _to_pcs(tags: dict[str, bytes], *, version: int) -> Float64Array:
    """Return the matrix by which the profile's maker adapted the colourants to D50, shape (3, 3)."""
    stated = _numbers(tags, "chad", 9)
    if stated is not None:
        return stated.reshape(3, 3)
    white = _numbers(tags, "wtpt", 3)
    if version >= 4 or white is None or not (white > 0.1).all():
        return np.eye(3)
    return adaptation(chromaticity_of(white), D50)


def _unnamed(matrix: Float64Array) -> Primaries | None:
    """Return the primaries of a matrix from RGB to XYZ, shape (3, 3); None if they make no white."""
    if abs(np.linalg.det(matrix)) < 1e-4 or (matrix.sum(axis=0) <= 0).any():
        return None
    red, green, blue, white = (chromaticity_of(xyz) for xyz in (*matrix.T, matrix.sum(axis=1)))
    return Primaries("primaries of its own", red, green, blue, white) if white[1] > 0 else None
