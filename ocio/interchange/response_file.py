"""A response as a file held it: its inverse as a LUT, from which format, in which direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from crfnet_core.errors import CurveError
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Float64Array

from ..defaults import LUT_LENGTH
from ..errors import LutError
from ..luts.lut1d import Lut1D, inverse_response_lut, strictly_increasing
from ..luts.response import is_forward
from ..luts.rgb_lut import AnyLut, lut_of_channels


@dataclass(frozen=True)
class ResponseFile:
    """What was read.

    Parameters
    ----------
    lut : Lut1D or RgbLut1D
        The inverse response, whichever direction the file has.
    source : str
        The format in words, such as "OpenCV response".
    was_forward : bool
        Whether the file leads from light to code values.
    notes : tuple of str
        What else the file says, and what was mended; they are among the comments of `lut`.
    """

    lut: AnyLut
    source: str
    was_forward: bool = False
    notes: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """The format, the channels and the direction of the file in one line."""
        channels = "one table" if isinstance(self.lut, Lut1D) else "R, G and B apart"
        direction = "from light to code values" if self.was_forward else "from code values to light"
        return f"{self.source}, {channels}, {direction}"


def described(path: Path, found: ResponseFile, notes: Sequence[str] = ()) -> ResponseFile:
    """Return what was read, with the file, its format and `notes` as the first comments of the LUT."""
    inverted = "; this is its inverse" if found.was_forward else ""
    comments = (f"Read from {path.name}: {found.words}{inverted}", *notes, *found.lut.comments)
    return replace(found, lut=replace(found.lut, comments=comments), notes=tuple(notes))


def from_curve(path: Path, samples: Float64Array, source: str, notes: Sequence[str] = ()) -> ResponseFile:
    """Return the response of brightness samples at uniform irradiances, shape (N,); a LutError if it is none."""
    try:
        curve = ResponseCurve.from_samples(samples)
    except CurveError as problem:
        raise LutError(f"{path}: {problem}") from problem
    return described(path, ResponseFile(inverse_response_lut(curve), source, was_forward=True), notes)


def from_lut(lut: AnyLut, source: str) -> ResponseFile:
    """Return the response of a LUT of either direction: one that brightens leads to codes, and is inverted."""
    if not is_forward(lut):
        return ResponseFile(lut, source)
    codes = np.linspace(0, 1, LUT_LENGTH)
    tables = [Lut1D(strictly_increasing(channel.apply_inverse(codes))) for channel in lut.channels]
    return ResponseFile(replace(lut_of_channels(tables), comments=lut.comments), source, was_forward=True)
