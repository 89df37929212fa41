"""Transfer functions that standards define: scene-linear light to encoded values."""

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.types import Float64Array


def srgb_encode(linear: ArrayLike) -> Float64Array:
    """Return the sRGB encoding (IEC 61966-2-1) of linear values in [0, 1], of the same shape."""
    linear = np.asarray(linear, dtype=np.float64)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def rec709_encode(linear: ArrayLike) -> Float64Array:
    """Return the transfer function of ITU-R BT.709 of linear values in [0, 1], of the same shape."""
    linear = np.asarray(linear, dtype=np.float64)
    return np.where(linear < 0.018, 4.5 * linear, 1.099 * linear**0.45 - 0.099)


def hlg_encode(linear: ArrayLike) -> Float64Array:
    """Return the Hybrid Log-Gamma encoding (ITU-R BT.2100) of linear values in [0, 1], of the same shape."""
    linear = np.asarray(linear, dtype=np.float64)
    a, b, c = 0.17883277, 0.28466892, 0.55991073
    return np.where(linear <= 1 / 12, (3 * linear) ** 0.5, a * np.log(np.maximum(12 * linear, 1) - b) + c)
