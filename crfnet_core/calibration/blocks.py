"""Blocks of pixels that a stack is measured in, and the most informative of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from crfnet_core.errors import CalibrationError
from crfnet_core.photograph.photo import CodeArray
from crfnet_core.types import BoolArray, Float64Array, IndexArray

#: Axes of the values within a square: see `squares`.
WITHIN = (1, 3)

#: Cells along each side of a block, and blocks along a picture's longer side, about.
CELLS, BLOCKS_ACROSS = 4, 190

#: 8-bit codes below the white level from which on a pixel counts as white: JPEG and rounding move codes by as much.
WHITE_MARGIN = 0.5

#: Fraction of white pixels from which on a block is white, and above which it is partly white.
ALL_WHITE, PARTLY_WHITE = 0.98, 0.03

#: 8-bit code below which brightness is not used, because black level and clipping change it there; and the one at which
#: deviations are doubled for the same reason: they are multiplied by 1 + (DARK_CODE / code)^2.
DARKEST_CODE, DARK_CODE = 5, 10

#: Standard deviation of a block's mean, in 8-bit codes: rounding, JPEG; and the part of the spread within the block.
CODE_NOISE, SPREAD_NOISE = 0.4, 0.15

#: Factor on the deviation where another channel clips, and the chroma (a part of the brightness) at which the variance
#: is twice gray's.
CLIPPED_NEIGHBOR, STRONG_CHROMA = 4.0, 0.35

#: Step in stops of the bins of irradiance that blocks are picked from, and how many blocks are picked in all.
BIN, BLOCKS = 0.2, 650

#: Samples that a measurement needs, of blocks that every channel shows between black and white in two frames or more.
LEAST_SAMPLES = 200


@dataclass(frozen=True, eq=False)
class Observations:
    """The brightness of M samples (a block in one channel) in T frames."""

    brightness: Float64Array  # (M, T): mean brightness, white = 1
    deviation: Float64Array  # (M, T): its expected standard deviation
    is_used: BoolArray  # (M, T): whether the brightness counts
    white_fraction: Float64Array  # (M, T): fraction of white pixels
    spread: Float64Array  # (M,): typical spread within the block, in brightness
    block: IndexArray  # (M,): the sample's block of the picture
    channel: IndexArray  # (M,): the sample's channel

    @property
    def is_white(self) -> BoolArray:
        """Whether the sample is white, shape (M, T): its irradiance is then at least white's."""
        return self.white_fraction >= ALL_WHITE

    def subset(self, samples: BoolArray | IndexArray) -> Self:
        """Return some of the samples."""
        return replace(self, **{name: values[samples] for name, values in vars(self).items()})

    def in_frames(self, frames: BoolArray) -> Self:
        """Return the samples in some of the frames."""
        return replace(self, **{name: values[:, frames] for name, values in vars(self).items() if values.ndim == 2})


def block_means(codes: CodeArray, white: float) -> Float64Array:
    """Return brightness, its spread over cells, and the white fraction of the blocks of a frame: (3, N, 3).

    `codes` are of shape (H, W, 3), `white` is the code of white. The blocks come row by row.
    """
    cell = max(1, round(max(codes.shape) / (CELLS * BLOCKS_ACROSS)))  # so small pictures have fewer blocks
    cells = squares(_means(codes, cell) / white, CELLS)
    is_white = codes >= white * (1 - WHITE_MARGIN / 255)
    parts = np.minimum(cells.mean(axis=WITHIN), 1), cells.std(axis=WITHIN), _means(is_white, CELLS * cell)
    return np.stack(parts).reshape(3, -1, 3)


def observe(frames: Sequence[Float64Array], *, is_gray: bool) -> Observations:
    """Return every sample of every block, channel after channel, given `block_means`; one channel only if gray."""
    brightness, spread, white = np.stack(frames, axis=-1)[:, :, : 1 if is_gray else 3]  # (N, C, T)
    is_used = (white <= PARTLY_WHITE) & (brightness * 255 >= DARKEST_CODE)
    dark = 1 + (DARK_CODE / np.maximum(brightness * 255, 1)) ** 2
    chroma = np.ptp(brightness, axis=1, keepdims=True) / np.maximum(brightness.max(axis=1, keepdims=True), 1 / 255)
    has_clipped = (white > PARTLY_WHITE).any(axis=1, keepdims=True) & is_used
    uncertain = dark * np.hypot(1, chroma / STRONG_CHROMA) * np.where(has_clipped, CLIPPED_NEIGHBOR, 1)
    blocks, channels, count = brightness.shape
    flat = (blocks * channels, count)
    return Observations(
        brightness=brightness.reshape(flat),
        deviation=(np.hypot(CODE_NOISE / 255, SPREAD_NOISE * spread) * uncertain).reshape(flat),
        is_used=is_used.reshape(flat),
        white_fraction=white.reshape(flat),
        spread=((spread * is_used).sum(axis=2) / np.maximum(is_used.sum(axis=2), 1)).ravel(),
        block=np.repeat(np.arange(blocks), channels),
        channel=np.tile(np.arange(channels), blocks),
    )


def pick_blocks(seen: Observations, log_irradiance: Float64Array) -> Observations:
    """Return the samples of about `BLOCKS` blocks, the flattest and most neutral ones of every level of irradiance.

    `log_irradiance`, shape (M,), is rough; NaN where no frame shows a sample. Raise CalibrationError if there are fewer
    than `LEAST_SAMPLES` samples of blocks that every channel shows in two frames.
    """
    channels = int(seen.channel.max()) + 1
    levels, spread = log_irradiance.reshape(-1, channels), seen.spread.reshape(-1, channels)
    is_often = (seen.is_used.sum(axis=1) >= 2).reshape(-1, channels)
    if (count := channels * int(is_often.all(axis=1).sum())) < LEAST_SAMPLES:
        is_poor = channels * is_often.sum(axis=0) < LEAST_SAMPLES
        poor = " and ".join(np.array(["red", "green", "blue"])[:channels][is_poor])
        if poor and not is_poor.all():
            raise CalibrationError("dark_channel", count=count, least=LEAST_SAMPLES, channels=poor)
        raise CalibrationError("few_flat_places", count=count, least=LEAST_SAMPLES)
    fit = np.flatnonzero(is_often.all(axis=1) & np.isfinite(levels).all(axis=1))
    rank = spread[fit].mean(axis=1) * (1 + np.ptp(levels[fit], axis=1))
    parts = members_of_bins(np.floor(levels[fit].mean(axis=1) / BIN), rank)
    places = np.concatenate([np.arange(len(part)) for part in parts])
    picked = np.concatenate(parts)[places.argsort(kind="stable")[:BLOCKS]]
    return seen.subset(np.isin(seen.block, fit[picked]))


def members_of_bins(bins: NDArray[Any], rank: Float64Array) -> list[IndexArray]:
    """Return the positions of the members of each bin, the ones of the lowest rank first."""
    order = np.lexsort((rank, bins))
    return np.split(order, np.flatnonzero(np.diff(bins[order])) + 1)


def medians_of_bins(values: Float64Array, bins: NDArray[Any], least: int) -> Float64Array:
    """Return the median of the values in each bin that has at least so many."""
    return np.array([np.median(values[part]) for part in members_of_bins(bins, values) if len(part) >= least])


def squares(picture: NDArray[Any], side: int) -> NDArray[Any]:
    """Return a picture of shape (H, W, ...) in squares: (H / side, side, W / side, side, ...), rounded down."""
    rows, columns = picture.shape[0] // side, picture.shape[1] // side
    return picture[: rows * side, : columns * side].reshape(rows, side, columns, side, *picture.shape[2:])


def _means(picture: NDArray[Any], side: int) -> Float64Array:
    """Return the means of squares, (H / side, W / side, 3); along one axis after the other, which is much faster."""
    return np.asarray(squares(picture, side).mean(axis=1).mean(axis=2), dtype=np.float64)
