"""Headroom: how far the irradiance of white lies above the others, apart from the shape of a response."""

from __future__ import annotations

import numpy as np

from crfnet_core.metrics import LAST_SHAPE_CODE
from crfnet_core.response import SAMPLES, ResponseCurve
from training.data.curves import IRRADIANCE

#: Brightness above which a response bends into white.
SHOULDER = LAST_SHAPE_CODE / 255


def with_headroom(curve: ResponseCurve, stops: float) -> ResponseCurve:
    """Return a response with more headroom: white lies so many stops higher above all that is darker.

    Up to brightness `SHOULDER` the irradiance is divided by one factor, which is an exposure and leaves the shape error
    as it is; above, its logarithm is stretched so that it still ends at 1.

    Parameters
    ----------
    curve : ResponseCurve
        The response.
    stops : float
        Headroom to add; above the logarithm, base 2, of the curve's irradiance at the shoulder, which is negative.
    """
    brightness = np.linspace(0, 1, SAMPLES)
    logarithm = np.log2(curve.inverse(brightness[1:]))  # (1023,)
    at_shoulder = float(np.log2(curve.inverse(SHOULDER)))
    top = logarithm * (at_shoulder - stops) / at_shoulder
    moved = np.where(brightness[1:] <= SHOULDER, logarithm - stops, top)
    irradiance = np.concatenate([[0.0], np.exp2(moved)])
    return ResponseCurve.from_samples(np.interp(IRRADIANCE, irradiance, brightness))
