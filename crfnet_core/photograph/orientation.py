"""Quarter turns and mirroring: pictures upright, whatever way the camera was held."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

#: a, b, c, d, each -1, 0 or 1: a stored pixel (x, y) belongs at x' = a x + c y, y' = b x + d y, with y downwards.
Turn: TypeAlias = tuple[int, int, int, int]

UPRIGHT: Turn = (1, 0, 0, 1)

#: EXIF's Orientation -> turn (JEITA CP-3451, 4.6.4).
EXIF_TURNS: dict[int, Turn] = {
    **{1: UPRIGHT, 2: (-1, 0, 0, 1), 3: (-1, 0, 0, -1), 4: (1, 0, 0, -1)},
    **{5: (0, 1, 1, 0), 6: (0, 1, -1, 0), 7: (0, -1, -1, 0), 8: (0, -1, 1, 0)},
}


def upright(pixels: NDArray[Any], turn: Turn) -> NDArray[Any]:
    """Return pixels, shape (H, W, ...), turned and mirrored by quarter turns."""
    a, b, c, d = turn
    if a == 0:
        pixels = pixels.swapaxes(0, 1)
    columns, rows = (c, b) if a == 0 else (a, d)
    return np.ascontiguousarray(pixels[:: rows or 1, :: columns or 1])
