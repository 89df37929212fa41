"""The picture in the HEIC and AVIF files of the tests."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def colored_ramp(bits: int, *, height: int = 48, width: int = 64) -> NDArray[Any]:
    """Return RGB codes of `bits` bits, shape (height, width, 3): red grows to the right, green down, blue both ways."""
    across, down = np.linspace(0, 1, width)[None], np.linspace(0, 1, height)[:, None]
    red, green, blue = across * np.ones_like(down), down * np.ones_like(across), (across + down) / 2
    codes = np.rint(np.stack([red, green, blue], axis=-1) * (2**bits - 1))
    return codes.astype(np.uint8 if bits == 8 else np.uint16)
