"""Inverse responses measured from an exposure series: a table over the codes, for each channel up to its own noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.response.curve import nearest_increasing
from crfnet_core.types import Float64Array

from ..errors import LutError
from ..luts.lut1d import MAX_LENGTH, single_precision, strictly_increasing
from ..luts.rgb_lut import AnyLut, lut_of_columns
from .response_file import ResponseFile, described

#: Codes of the files that are written, as of pictures of 8 bits.
CODES = 256

#: How much farther than the step before it the last code may lie before it is taken for clipped light.
CLIPPED_STEP = 4.0


def calibrated_response(path: Path, table: ArrayLike, source: str) -> ResponseFile:
    """Return the inverse response of a table over the codes.

    Calibration leaves traces that no response has, and they are mended: codes that no picture held (NaN or 0) are
    interpolated from 0 at black; the largest code, which stands for all clipped light as well, is extrapolated if it is
    `CLIPPED_STEP` times as far from its neighbour as that from the next; a table that falls is replaced by the
    nearest increasing one. The scale, which a calibration leaves open, becomes 1 for green's white; it is one for all
    channels, because their ratios are the white balance. The comments of the LUT say all this.

    Parameters
    ----------
    path : Path
        The file.
    table : array_like, shape (N, 1) or (N, 3)
        Relative light of N uniform codes; R, G and B.
    source : str
        The format in words.

    Raises
    ------
    LutError
        If the table has another shape, holds less than two values, or does not increase.
    """
    columns = np.array(table, dtype=np.float64)
    if columns.ndim != 2 or columns.shape[1] not in (1, 3) or not 2 <= len(columns) <= MAX_LENGTH:
        raise LutError(
            f"{path}: has shape {columns.shape}; needed is light for 2 to {MAX_LENGTH} codes, 1 or 3 channels"
        )
    notes = []
    unseen = ~np.isfinite(columns) | (columns <= 0)
    unseen[0] &= ~(columns[0] == 0)
    if unseen.any():
        columns = np.stack([_filled(path, column) for column in columns.T], axis=1)
        notes.append(f"{unseen.any(axis=1).sum()} codes that no picture held are interpolated")
    if (clipped := _is_clipped(columns)).any():
        columns[-1] = np.where(clipped, 2 * columns[-2] - columns[-3], columns[-1])
        notes.append("The largest code, which stands for clipped light too, is extrapolated")
    rising = np.stack([nearest_increasing(column) for column in columns.T], axis=1)
    white = rising[-1, rising.shape[1] // 2]
    if not (rising[-1] > rising[0]).all():
        raise LutError(f"{path}: is not brighter for larger codes, so it is no inverse response; calibrate again")
    if (moved := float(np.abs(rising - columns).max() / white)) > 0:
        notes.append(f"Made to increase, which moved it by up to {100 * moved:.2g} % of white")
    notes.append("Scaled so that white, of green, is 1")
    increasing = np.stack([strictly_increasing(column) for column in (rising / white).T], axis=1)
    try:
        lut = lut_of_columns(increasing)
    except LutError as problem:
        raise LutError(f"{path}: {problem}; calibrate again") from problem
    return described(path, ResponseFile(lut, source), notes)


def codes_table(lut: AnyLut) -> Float64Array:
    """Return an inverse response as light per 8-bit code, shape (256, 3): 1 at code 128 of green, above 0 everywhere.

    Programs take the logarithm of the light, so a black of 0 becomes half the light of the next code.
    """
    codes = np.linspace(0, 1, CODES)
    light = np.broadcast_to(np.stack([channel.apply(codes) for channel in lut.channels], axis=1), (CODES, 3))
    scaled = light / light[CODES // 2, 1]
    scaled[0] = np.where(scaled[0] > 0, scaled[0], scaled[1] / 2)
    return np.asarray(np.maximum(single_precision(scaled), np.finfo(np.float32).tiny))


def _filled(path: Path, column: Float64Array) -> Float64Array:
    """Return a column whose codes without light are interpolated, from 0 at code 0."""
    known = np.isfinite(column) & (column > 0)
    if known.sum() < 2:
        raise LutError(f"{path}: holds light for {known.sum()} codes; calibrate again with more pictures")
    codes = np.arange(len(column))
    points, light = codes[known], column[known]
    if points[0] > 0:
        points, light = np.append(0, points), np.append(0, light)
    return np.interp(codes, points, light)


def _is_clipped(columns: Float64Array) -> np.ndarray:
    """Return for each channel whether the largest code stands apart."""
    if len(columns) < 3:
        return np.zeros(columns.shape[1], dtype=bool)
    before, last = np.diff(columns[-3:], axis=0)
    return np.asarray((before > 0) & (last > CLIPPED_STEP * before))
