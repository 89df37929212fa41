"""From the chromaticities of an RGB to matrices: RGB to CIE XYZ, and chromatic adaptation between white points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crfnet_core.types import Float64Array

#: CIE 1931 x and y.
Chromaticity = tuple[float, float]

#: XYZ to the cone responses of the Bradford transform (Lam 1985; Annex E of ISO 15076-1:2010, the ICC's specification).
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz_of(chromaticity: Chromaticity) -> Float64Array:
    """Return the XYZ of a chromaticity at a luminance Y of 1, shape (3,)."""
    x, y = chromaticity
    return np.array([x / y, 1.0, (1 - x - y) / y])


def chromaticity_of(xyz: Sequence[float] | Float64Array) -> Chromaticity:
    """Return the x and y of an XYZ."""
    total = float(np.sum(xyz))
    return float(xyz[0]) / total, float(xyz[1]) / total


def rgb_to_xyz(red: Chromaticity, green: Chromaticity, blue: Chromaticity, white: Chromaticity) -> Float64Array:
    """Return the matrix from linear RGB to XYZ, by which RGB (1, 1, 1) is the white at Y = 1; shape (3, 3).

    Source: SMPTE RP 177-1993, Derivation of Basic Television Color Equations.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the three primaries lie on a line.
    """
    columns = np.array([(x, y, 1 - x - y) for x, y in (red, green, blue)]).T
    scales: Float64Array = np.linalg.solve(columns, xyz_of(white))
    return np.asarray(columns * scales)


def adaptation(source: Chromaticity, target: Chromaticity) -> Float64Array:
    """Return the Bradford matrix from XYZ under one white to the corresponding XYZ under another, shape (3, 3)."""
    before, after = BRADFORD @ xyz_of(source), BRADFORD @ xyz_of(target)
    return np.asarray(np.linalg.inv(BRADFORD) @ np.diag(after / before) @ BRADFORD)
