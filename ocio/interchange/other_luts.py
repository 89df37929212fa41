"""LUT formats that OpenColorIO reads and that are not written here: .csp, .3dl and .lut.

The three formats that are written (.spi1d, .cube, .clf) keep readers of their own: theirs name the faulty line, keep
the comments and the domain, and refuse tables that cannot be inverted, which OpenColorIO takes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core.types import Float64Array

from ..errors import LutError
from ..luts.agreement import opencolorio_steps
from ..luts.lut1d import MAX_LENGTH, strictly_increasing
from ..luts.rgb_lut import lut_of_columns
from ..luts.text import LutText
from .response_file import ResponseFile, described, from_lut

#: What OpenColorIO calls the steps of a file that keep the channels apart.
_PER_CHANNEL = (OCIO.Lut1DTransform, OCIO.RangeTransform)


def read_other_lut(path: Path) -> ResponseFile:
    """Return the response in a LUT file, whichever direction it has.

    A file of a single table keeps its entries; one with a shaper before the table is sampled at 65536 uniform inputs
    from 0 to 1. The white of a .3dl file, whose integers have no stated scale, becomes 1.

    Raises
    ------
    LutError
        If OpenColorIO refuses the file, it holds a 3D LUT or a matrix, or it falls somewhere.
    """
    lines = LutText.read(path).lines  # absent, too large or no text is refused here
    marks = [line.strip(" \t\r\f\v").upper() for line in lines]
    begins = [number for number, mark in enumerate(marks) if mark.startswith("BEGIN METADATA")]
    if begins and not any(mark.startswith("END METADATA") for mark in marks[begins[0] :]):  # it would look for ever
        raise LutError(f"{path}: has no line END METADATA; the file is cut or altered")
    steps = opencolorio_steps(path)
    mixing = next((type(step).__name__ for step in steps if not isinstance(step, _PER_CHANNEL)), None)
    if mixing or not steps:
        what = {"Lut3DTransform": "a 3D LUT, which mixes the channels"}.get(mixing or "", mixing or "no table")
        raise LutError(f"{path}: holds {what}; give a 1D LUT of the camera's response")
    table = _table(steps)
    if not np.isfinite(table).all() or (np.diff(table, axis=0) < 0).any() or (table[-1] <= table[0]).any():
        raise LutError(f"{path}: does not increase; a LUT that can be inverted does")
    if path.suffix.lower() == ".3dl":
        table = table / table[-1].max()
    flat = int((np.diff(table, axis=0) == 0).any(axis=1).sum())
    notes = [f"{flat} steps are level in the file, and rise by the least that float32 can hold"] if flat else []
    lut = lut_of_columns(np.stack([strictly_increasing(column) for column in table.T], axis=1))
    return described(path, from_lut(lut, f"LUT of the format {path.suffix.lower()}"), notes)


def _table(steps: list[OCIO.Transform]) -> Float64Array:
    """Return the outputs, shape (N, 3), at uniform inputs from 0 to 1."""
    if len(steps) == 1 and not steps[0].getInputHalfDomain():
        return np.asarray(steps[0].getData(), dtype=np.float64).reshape(-1, 3)
    ramp = np.repeat(np.linspace(0, 1, MAX_LENGTH, dtype=np.float32), 3)
    processor = OCIO.Config.CreateRaw().getProcessor(OCIO.GroupTransform(steps))
    processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(ramp)
    return ramp.astype(np.float64).reshape(-1, 3)
