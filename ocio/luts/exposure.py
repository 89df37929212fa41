"""The exposure of a linear plate, in stops: anchored at white, or at 18 % gray."""

from __future__ import annotations

import numpy as np

from crfnet_core.response.curve import ResponseCurve

from ..defaults import GRAY_BRIGHTNESS, MIDDLE_GRAY
from ..errors import LutError
from .rgb_lut import AnyLut


def anchored_exposure(response: ResponseCurve | AnyLut, *, gray: float | None = None, stops: float = 0.0) -> float:
    """Return the stops to add after the inverse response, which leaves the exposure open (Eq. 31 of docs/METHOD.md).

    `response` may be the response or a LUT of its inverse; of a LUT for each channel, green counts. `gray` is the
    encoded brightness in (0, 1] of a surface that reflects 18 % of the light, which becomes a linear 0.18. By default
    white is the anchor: brightness 1 becomes a linear 1. `stops` are added on top. Raise a LutError if the gray is
    black.
    """
    if gray is None:
        return stops
    irradiance = linear_gray(response, gray)
    if irradiance <= 0:
        raise LutError("gray_is_black", gray=gray)
    return float(np.log2(MIDDLE_GRAY / irradiance)) + stops


def linear_gray(response: ResponseCurve | AnyLut, gray: float = GRAY_BRIGHTNESS) -> float:
    """Return the linear value of an encoded brightness, by default that at which cameras place 18 % gray."""
    if isinstance(response, ResponseCurve):
        return float(response.inverse(gray))
    return float(response.channels[len(response.channels) // 2].apply(gray))
