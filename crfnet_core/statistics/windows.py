"""Choose the windows of a photograph that are analyzed (CRF-net paper, Sec. 3.2)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from crfnet_core.types import LARGEST, Float32Array, Pixels, Uint8Array

WINDOW_SIZE = 227  # side of a window in samples
WINDOWS_PER_PHOTOGRAPH = 10  # windows that are analyzed in a photograph
FULL_COVERAGE = 220  # code values over all three channels that a good window holds, of 256 (CRF-net paper, Sec. 3.2)
POSITIONS_TRIED = 400  # random positions that are tried before the best-covering windows so far are taken
WINDOWS_ACROSS = 2  # the shorter side of a photograph holds at least this many windows

#: Windows begin at even rows and columns: JPEG and video keep the color of 2 x 2 pixels together, and in training,
#: where windows are compressed as pictures of their own, these pixels always begin at a window's first.
GRID = 2


@dataclass(frozen=True)
class Window:
    """A square of `WINDOW_SIZE` samples, `step` pixels apart, whose first sample is pixel (x, y)."""

    x: int
    y: int
    step: Annotated[int, (1, LARGEST)]
    filled: Annotated[int, (0, 256)]

    @property
    def extent(self) -> int:
        """Pixels of the photograph that the window spans in each direction."""
        return window_extent(self.step)

    @property
    def covers_range(self) -> bool:
        """Whether the window holds enough of the 256 code values to show the whole response."""
        return self.filled >= FULL_COVERAGE

    def cut(self, pixels: Pixels) -> Float32Array:
        """Return the window's samples, shape (227, 227, 3); of an array a view."""
        end_y, end_x = self.y + self.extent, self.x + self.extent
        return pixels[self.y : end_y : self.step, self.x : end_x : self.step]


def window_extent(step: int) -> int:
    """Return the pixels that a window of this step spans in each direction."""
    return (WINDOW_SIZE - 1) * step + 1


def sampling_step(height: int, width: int) -> int:
    """Return the distance in pixels between the samples of a window: Eq. 7 of docs/METHOD.md.

    Large photographs are point-sampled, never averaged: averaging mixes brightness where the camera mixed irradiance,
    and so distorts the curve. Every sample keeps its exact code value, and a window sees as much of the scene as the
    windows of training did.
    """
    return max(1, min(height, width) // (WINDOWS_ACROSS * WINDOW_SIZE))


def filled_bins(samples: Float32Array) -> int:
    """Return how many bins of one 256-bin histogram hold a sample; `samples` in [0, 1], of any shape."""
    return filled_codes(np.rint(samples * np.float32(255)).astype(np.uint8))


def filled_codes(codes: Uint8Array) -> int:
    """Return how many of the 256 code values occur among `codes`, of any shape."""
    seen = np.zeros(256, dtype=bool)
    seen[codes] = True
    return int(seen.sum())


def select_windows(
    pixels: Pixels, *, count: int = WINDOWS_PER_PHOTOGRAPH, seed: int = 0, coverage: int = FULL_COVERAGE
) -> tuple[Window, ...]:
    """Return the windows of a photograph to analyze (CRF-net paper, Sec. 3.2).

    Even positions are drawn at random. A window is taken if its 256-bin histogram over all channels has at least
    `coverage` bins filled; 0 takes the first positions. If `POSITIONS_TRIED` positions do not give enough of them, the
    best-covering others fill the number: look at `Window.covers_range`. The same seed gives the same windows; there are
    fewer than `count` only if the photograph, whose sides are at least `WINDOW_SIZE`, has fewer positions.
    """
    height, width = pixels.shape[:2]
    step = sampling_step(height, width)
    chosen: list[Window] = []
    others: list[Window] = []
    for x, y in _positions(height, width, step, seed):
        uncounted = Window(x, y, step, filled=0)
        window = replace(uncounted, filled=filled_bins(uncounted.cut(pixels)))
        (chosen if window.filled >= coverage else others).append(window)
        if len(chosen) == count:
            return tuple(chosen)
    others.sort(key=lambda window: -window.filled)
    return tuple(chosen + others[: count - len(chosen)])


def cut_windows(pixels: Pixels, windows: Sequence[Window]) -> Float32Array:
    """Return the samples of `windows`, shape (N, 227, 227, 3), copied from `pixels` of shape (H, W, 3)."""
    return np.stack([window.cut(pixels) for window in windows])


def _positions(height: int, width: int, step: int, seed: int) -> list[tuple[int, int]]:
    """Return up to `POSITIONS_TRIED` distinct random window corners (x, y), multiples of `GRID`."""
    extent = window_extent(step)
    rows, columns = ((side - extent) // GRID + 1 for side in (height, width))
    drawn = np.random.default_rng(seed).choice(rows * columns, min(POSITIONS_TRIED, rows * columns), replace=False)
    return [(GRID * int(position % columns), GRID * int(position // columns)) for position in drawn]
