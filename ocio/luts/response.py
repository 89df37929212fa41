"""The response of a camera from a LUT of its inverse, and from a LUT file of either direction."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from crfnet_core.response.curve import MOST_BRIGHTNESS, SAMPLES, ResponseCurve

from ..defaults import LUT_LENGTH
from ..errors import LutError
from .lut1d import Lut1D, strictly_increasing
from .opencolorio import read_lut
from .rgb_lut import AnyLut, RgbLut1D, lut_of_channels

#: Largest irradiance of brightness 0, as a part of the irradiance of brightness 1.
MOST_BLACK = 0.01

#: Largest first and least last code of a LUT file: black is 0.125 in V-Log, white 0.92 in video.
MOST_FIRST, LEAST_LAST = 0.15, 0.9

#: Largest mean of an inverse response, as a part of its range; the mean of linear light is 0.5, cameras have less.
MOST_MEAN = 0.55


@dataclass(frozen=True)
class ResponseFile:
    """A LUT file: its table, and the inverse response, from code values to light, that the table is or stands for."""

    path: Path
    table: AnyLut
    lut: AnyLut

    @property
    def was_forward(self) -> bool:
        """Whether the file leads from light to code values."""
        return self.lut is not self.table

    @property
    def words(self) -> str:
        """The format, the channels and the direction of the file in one line."""
        channels = "one table" if isinstance(self.table, Lut1D) else "tables of R, G and B"
        direction = "from light to code values" if self.was_forward else "from code values to light"
        return f"LUT of the format {self.path.suffix.lower()}, {channels}, {direction}"


def read_response(path: str | Path) -> ResponseFile:
    """Return the response in a LUT file of either direction; a LUT that brightens is inverted.

    Raises as `read_lut`, and a LutError if the code values of the LUT are such as 0 to 255, or only a part of 0 to 1.
    """
    path, table = Path(path), read_lut(path)
    was_forward = is_forward(table)
    ends = float(table.values[0].max()), float(table.values[-1].min())
    low, high = ends if was_forward else table.domain
    if low > MOST_FIRST or not LEAST_LAST <= high <= MOST_BRIGHTNESS:
        raise LutError("lut_of_codes", path=path, low=low, high=high)
    if not was_forward:
        return ResponseFile(path, table, table)
    codes = np.linspace(0, 1, LUT_LENGTH)
    inverse = lut_of_channels([Lut1D(strictly_increasing(each.apply_inverse(codes))) for each in table.channels])
    response = ResponseFile(path, table, inverse)
    comments = (f"Read from {path.name}: {response.words}; this is its inverse", *table.comments)
    return replace(response, lut=replace(inverse, comments=comments))


def response_of_lut(lut: AnyLut) -> ResponseCurve:
    """Return the response whose inverse a LUT is, scaled so that brightness 1 is irradiance 1; it is the LUT's to 5e-5.

    Raise a LutError if the LUT treats the channels apart, its domain does not hold [0, 1], black is not 0, or it
    brightens: it then leads from light to codes. Raise a CurveError if the response does not increase strictly.
    """
    if isinstance(lut, RgbLut1D):
        raise LutError("lut_channels_differ")
    low, high = lut.domain
    if low > 0 or high < 1:
        raise LutError("lut_domain_short", low=low, high=high)
    black, white = lut.apply(np.array([0.0, 1.0]))
    if not white > 0 or abs(black) > MOST_BLACK * white:
        raise LutError("lut_black_or_white", black=black, white=white)
    if is_forward(lut):
        raise LutError("lut_brightens")
    brightness = np.clip(lut.apply_inverse(np.linspace(black, white, SAMPLES)), 0, 1).astype(np.float64)
    brightness[0], brightness[-1] = 0, 1
    return ResponseCurve(brightness)


def is_forward(lut: AnyLut) -> bool:
    """Return whether a LUT brightens on average over its domain: it then leads from light to code values."""
    ramp = np.linspace(*lut.domain, SAMPLES)
    means = [(each.apply(ramp).mean() - each.values[0]) / np.ptp(each.values) for each in lut.channels]
    return bool(np.mean(means) > MOST_MEAN)
