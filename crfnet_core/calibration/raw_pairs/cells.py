"""Cells of a pair: the raw light and the codes of the same flat places."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates, maximum_filter, minimum_filter

from crfnet_core.calibration.blocks import WITHIN, members_of_bins, squares
from crfnet_core.calibration.raw_pairs.registration import LUMA, Registration, coordinates
from crfnet_core.photograph.camera_raw import RawPicture
from crfnet_core.photograph.photo import CodeArray
from crfnet_core.types import BoolArray, Float32Array, Float64Array, IndexArray

#: Cells along a picture's width, and the fewest and the most pixels along a cell.
ACROSS, SMALLEST, LARGEST = 160, 3, 24

#: Samples of the raw light along a cell.
FEWEST_SAMPLES, MOST_SAMPLES = 4, 10

#: A cell is flat if codes within it deviate by less than the first, and its neighbors differ by less than the second.
FLAT, EVEN = 12.0, 50.0

#: 8-bit code from which a pixel may be clipped, and the one from which all pixels of a cell count as white.
CLIPPED, WHITE = 251, 254

#: Step in stops of the bins of light that cells are picked from; of each, the flattest are picked, and as many others.
BIN, PER_BIN = 0.2, 50

#: Width of the surroundings that local tone mapping goes by, as a part of the picture's.
SURROUNDINGS = 1 / 24

#: Deviation of a cell's mean in 8-bit codes: JPEG and sharpening, and parts of the deviation within the cell and of the
#: range of its neighbors.
NOISE, SPREAD_NOISE, RANGE_NOISE = 0.6, 0.25, 0.08

SEED = 0


@dataclass(frozen=True, eq=False)
class Cells:
    """N cells of one pair or several."""

    light: Float64Array  # (N, 3): raw, balanced; once shots are joined, a white surface saturates at 1
    codes: Float64Array  # (N, 3): mean code, in 8 bits
    deviation: Float64Array  # (N, 3): expected standard deviation of the same
    is_open: BoolArray  # (N, 3): whether no pixel is clipped
    is_white: BoolArray  # (N, 3): whether all pixels are white
    is_saturated: BoolArray  # (N,): whether the raw light is, in some channel
    surroundings: Float64Array  # (N,): log2 of the raw light around the cell, less its median over the picture
    place: Float64Array  # (N, 2): right and down from the center; a corner is 1 away
    tile: IndexArray  # (N,): 0 or 1, a checkerboard over the picture
    shot: Float64Array  # (N, S): 1 at the cell's own of S pairs, else 0

    def subset(self, cells: BoolArray | IndexArray) -> Self:
        """Return some of the cells."""
        return replace(self, **{name: values[cells] for name, values in vars(self).items()})

    @classmethod
    def joined(cls, parts: list[Self]) -> Self:
        """Return the cells of several pairs."""
        each = {name: np.concatenate([getattr(part, name) for part in parts]) for name in vars(parts[0])}
        each["shot"] = np.repeat(np.eye(len(parts)), [len(part.shot) for part in parts], axis=0)
        return cls(**each)


def find_cells(raw: RawPicture, codes: CodeArray, place: Registration, inverse: Float32Array) -> Cells:
    """Return the cells of a pair that are flat, the ones of equal light thinned out.

    `codes` are 8-bit and of shape (H, W, 3). `inverse`, of shape (256,), is the light of each code by the response as
    far as it is known: codes are averaged in light, and the mean is turned back, because a lens blurs light.
    """
    side = int(np.clip(codes.shape[1] // ACROSS, SMALLEST, LARGEST))
    pixels = squares(codes, side)
    channels = np.moveaxis(pixels, -1, 0)  # one by one: all at once take twice the memory and the time
    light_by_codes = np.dstack([inverse[channel].mean(axis=WITHIN) for channel in channels])
    mean = np.interp(light_by_codes, inverse, np.arange(256))
    spread = np.dstack([channel.std(axis=WITHIN, dtype=np.float32) for channel in channels])
    uneven = maximum_filter(mean, (3, 3, 1)) - minimum_filter(mean, (3, 3, 1))
    light, is_saturated, is_inside = _raw_cells(raw, place, codes.shape, side)
    logs = np.log2(np.maximum(gaussian_filter(light @ LUMA, ACROSS * SURROUNDINGS, mode="nearest"), 1e-4))
    rows, columns = logs.shape
    y, x = np.mgrid[:rows, :columns]
    every = Cells(
        light=light,
        codes=mean,
        deviation=np.sqrt(NOISE**2 + (SPREAD_NOISE * spread) ** 2 + (RANGE_NOISE * uneven) ** 2),
        is_open=pixels.max(axis=WITHIN) < CLIPPED,
        is_white=pixels.min(axis=WITHIN) >= WHITE,
        is_saturated=is_saturated,
        surroundings=logs - np.median(logs),
        place=np.dstack([x * 2 - columns + 1, y * 2 - rows + 1]) / np.hypot(rows, columns),
        tile=(y * 6 // rows + x * 8 // columns) % 2,
        shot=np.ones((rows, columns, 1)),
    )  # each of shape (rows, columns, ...)
    is_flat = (spread.max(axis=-1) <= FLAT) & (uneven.max(axis=-1) <= EVEN) & is_inside
    flat = every.subset(is_flat)
    return flat.subset(_picked(flat.light[:, 1], spread[is_flat].max(axis=-1)))


def _raw_cells(
    raw: RawPicture, place: Registration, shape: tuple[int, ...], side: int
) -> tuple[Float64Array, BoolArray, BoolArray]:
    """Return the balanced light of the cells of a JPEG, (rows, columns, 3), which are saturated, and which inside."""
    height, width = shape[:2]
    scale = np.exp(place.place[0]) * max(raw.light.shape) / max(shape)
    count = int(np.clip(np.ceil(side * scale), FEWEST_SAMPLES, MOST_SAMPLES))  # along each side of a cell
    down, right = ((np.arange(length // side * count) + 0.5) * side / count for length in (height, width))
    y, x = np.meshgrid((2 * down - height) / width, (2 * right - width) / width, indexing="ij")
    turned, near_saturated = place.turned(raw.light), maximum_filter(place.turned(raw.is_saturated), 3)
    at = coordinates(place.place, x, y, turned.shape)
    seen = [map_coordinates(channel, at, order=1, mode="nearest") for channel in np.moveaxis(turned, -1, 0)]
    light = np.dstack([squares(channel, count).mean(axis=WITHIN) for channel in seen])
    is_saturated = map_coordinates(near_saturated, at, order=0, mode="nearest")
    is_within = (at >= 0) & (at <= np.reshape(near_saturated.shape, (2, 1, 1)) - 1)
    is_inside = squares(is_within[0] & is_within[1], count).min(axis=WITHIN)
    return light * raw.balance, squares(is_saturated, count).max(axis=WITHIN), is_inside


def _picked(light: Float64Array, spread: Float64Array) -> IndexArray:
    """Return the positions of the flattest cells of every brightness, and of others at random, for their colors."""
    rng = np.random.default_rng(SEED)
    bins = np.floor(np.log2(np.maximum(light, 2.0**-14)) / BIN)
    picked = [(part[:PER_BIN], rng.permutation(part[PER_BIN:])[:PER_BIN]) for part in members_of_bins(bins, spread)]
    return np.concatenate([part for parts in picked for part in parts])
