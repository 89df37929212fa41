"""The response of a camera from a LUT of its inverse: the reverse of `inverse_response_lut`."""

from __future__ import annotations

import numpy as np

from crfnet_core.response.curve import SAMPLES, ResponseCurve
from crfnet_core.types import Float64Array

from ..errors import LutError
from .lut1d import Lut1D
from .rgb_lut import AnyLut, RgbLut1D

#: Largest irradiance of brightness 0, as a part of that of brightness 1.
MOST_BLACK = 0.01

#: Largest mean of an inverse response, as a part of its range; that of linear light is 0.5, those of cameras are below.
MOST_MEAN = 0.55


def response_of_lut(lut: AnyLut) -> ResponseCurve:
    """Return the response of which a LUT is the inverse, scaled so that brightness 1 is irradiance 1.

    Between its samples the response is linear, so its inverse is not quite the LUT: for the LUT of a response with the
    usual length, the two differ by less than 5e-5, white = 1.

    Parameters
    ----------
    lut : Lut1D or RgbLut1D
        From encoded brightness to linear light; the domain holds [0, 1].

    Raises
    ------
    LutError
        If the LUT treats the channels apart, the domain does not hold [0, 1], black is no 0, or the LUT brightens: it
        then leads from light to codes.
    CurveError
        If the response does not increase strictly.
    """
    if isinstance(lut, RgbLut1D):
        raise LutError("the LUT treats R, G and B apart; give one that treats the channels alike")
    low, high = lut.domain
    if low > 0 or high < 1:
        raise LutError(f"the LUT is defined from {low:g} to {high:g}; the inverse of a response needs 0 to 1")
    black, white = lut.apply(np.array([0.0, 1.0]))
    if not white > 0 or abs(black) > MOST_BLACK * white:
        raise LutError(f"the LUT makes {black:g} of black and {white:g} of white; a response needs 0 and more than 0")
    if is_forward(lut):
        raise LutError("the LUT brightens, so it leads from light to code values; give its inverse")
    brightness = brightness_samples(lut)
    brightness[0], brightness[-1] = 0, 1
    return ResponseCurve(brightness)


def brightness_samples(lut: Lut1D) -> Float64Array:
    """Return the response of a LUT of its inverse at 1024 uniform irradiances from black to white, in [0, 1]."""
    black, white = lut.apply(np.array([0.0, 1.0]))
    return np.asarray(np.clip(lut.apply_inverse(np.linspace(black, white, SAMPLES)), 0, 1), dtype=np.float64)


def is_forward(lut: AnyLut) -> bool:
    """Return whether a LUT brightens on average over its domain: it then leads from light to code values.

    The inverses of camera responses darken: in linear light the mean is 0.5 of the range, in theirs it is less.
    """
    ramp = np.linspace(*lut.domain, SAMPLES)
    means = []
    for channel in lut.channels:
        first, last = channel.values[0], channel.values[-1]
        means.append((channel.apply(ramp).mean() - first) / (last - first))
    return bool(np.mean(means) > MOST_MEAN)
