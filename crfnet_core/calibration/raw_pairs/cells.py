"""Cells of a pair: the raw light and the codes of the same flat places."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates, maximum_filter, minimum_filter

from crfnet_core.calibration.raw_pairs.registration import LUMA, Registration
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

#: Step in stops of the bins of light that cells are picked from, and how many are picked of each.
BIN, PER_BIN = 0.2, 100

#: Width of the surroundings that local tone mapping goes by, as a part of the picture's.
SURROUNDINGS = 1 / 24

#: Deviation of a cell's mean in 8-bit codes: JPEG and sharpening, and parts of the deviation within the cell and of the
#: range of its neighbors.
NOISE, SPREAD_NOISE, RANGE_NOISE = 0.6, 0.25, 0.08

SEED = 0


@dataclass(frozen=True, eq=False)
class Cells:
    """N cells of one pair or several."""

    light: Float64Array  # (N, 3): raw, balanced
    codes: Float64Array  # (N, 3): mean code, in 8 bits
    deviation: Float64Array  # (N, 3): expected standard deviation of the same
    is_open: BoolArray  # (N, 3): whether no pixel is clipped
    is_white: BoolArray  # (N, 3): whether all pixels are white
    is_saturated: BoolArray  # (N,): whether the raw light is, in some channel
    surroundings: Float64Array  # (N,): log2 of the raw light around the cell, less its median over the picture
    place: Float64Array  # (N, 2): right and down from the center; a corner is 1 away
    tile: IndexArray  # (N,): 0 or 1, a checkerboard over the picture
    shot: IndexArray  # (N,)

    def subset(self, cells: BoolArray | IndexArray) -> Cells:
        """Return some of the cells."""
        return Cells(**{name: values[cells] for name, values in vars(self).items()})

    @classmethod
    def joined(cls, parts: list[Cells]) -> Cells:
        """Return the cells of several pairs, numbered in order."""
        each = {name.name: [getattr(part, name.name) for part in parts] for name in fields(cls)}
        each["shot"] = [np.full_like(shot, number) for number, shot in enumerate(each["shot"])]
        return cls(**{name: np.concatenate(values) for name, values in each.items()})


def find_cells(raw: RawPicture, codes: CodeArray, place: Registration, inverse: Float32Array) -> Cells:
    """Return the cells of a pair that are flat, the ones of equal light thinned out.

    `codes` are 8-bit and of shape (H, W, 3). `inverse`, of shape (256,), is the light of each code by the response as
    far as it is known: codes are averaged in light, and the mean is turned back, because a lens blurs light.
    """
    side = int(np.clip(codes.shape[1] // ACROSS, SMALLEST, LARGEST))
    rows, columns = codes.shape[0] // side, codes.shape[1] // side
    blocks = codes[: rows * side, : columns * side].reshape(rows, side, columns, side, 3)
    means = np.stack([inverse[blocks[..., c]].mean(axis=(1, 3)) for c in range(3)], axis=-1)
    mean = np.interp(means, inverse, np.arange(256))
    spread = np.stack([blocks[..., c].std(axis=(1, 3), dtype=np.float32) for c in range(3)], axis=-1)
    uneven = maximum_filter(mean, (3, 3, 1)) - minimum_filter(mean, (3, 3, 1))
    light, is_saturated, is_inside = _raw_cells(raw, place, codes.shape, side, (rows, columns))
    logs = np.log2(np.maximum(gaussian_filter(light @ LUMA, ACROSS * SURROUNDINGS, mode="nearest"), 1e-4))
    y, x = np.mgrid[:rows, :columns]
    position = np.stack([x * 2 - columns + 1, y * 2 - rows + 1], axis=-1) / np.hypot(columns, rows)
    cells = Cells(
        light=light.reshape(-1, 3),
        codes=mean.reshape(-1, 3),
        deviation=np.sqrt(NOISE**2 + (SPREAD_NOISE * spread) ** 2 + (RANGE_NOISE * uneven) ** 2).reshape(-1, 3),
        is_open=(blocks.max(axis=(1, 3)) < CLIPPED).reshape(-1, 3),
        is_white=(blocks.min(axis=(1, 3)) >= WHITE).reshape(-1, 3),
        is_saturated=is_saturated.ravel(),
        surroundings=(logs - np.median(logs)).ravel(),
        place=position.reshape(-1, 2),
        tile=((y * 6 // rows + x * 8 // columns) % 2).ravel(),
        shot=np.zeros(rows * columns, np.intp),
    )
    is_flat = (spread.max(axis=-1) <= FLAT) & (uneven.max(axis=-1) <= EVEN) & is_inside
    return cells.subset(_picked(cells, is_flat.ravel(), spread.max(axis=-1).ravel()))


def _raw_cells(
    raw: RawPicture, place: Registration, shape: tuple[int, ...], side: int, grid: tuple[int, int]
) -> tuple[Float64Array, BoolArray, BoolArray]:
    """Return the balanced light of every cell, (*grid, 3), whether a photosite in it is saturated, and it is inside."""
    height, width = shape[:2]
    scale = np.exp(place.place[0]) * max(raw.light.shape[:2]) / max(height, width)
    samples = int(np.clip(np.ceil(side * scale), FEWEST_SAMPLES, MOST_SAMPLES))
    steps = [((np.arange(count * samples) + 0.5) * side / samples) for count in grid]
    y, x = np.meshgrid((2 * steps[0] - height) / width, (2 * steps[1] - width) / width, indexing="ij")
    turned = place.turned(raw.light)
    at = place.coordinates(x, y, turned.shape)
    parts = (grid[0], samples, grid[1], samples)
    light = [map_coordinates(turned[..., c], at, order=1, mode="nearest") for c in range(3)]
    means = np.stack([values.reshape(parts).mean(axis=(1, 3)) for values in light], axis=-1)
    row, column = (
        np.clip(np.rint(each), 0, size - 1).astype(int) for each, size in zip(at, turned.shape, strict=False)
    )
    is_saturated = maximum_filter(place.turned(raw.is_saturated), 3)[row, column].reshape(parts).any(axis=(1, 3))
    outside = (at < 0) | (at > np.array(turned.shape[:2])[:, None, None] - 1)
    is_outside = np.any(np.reshape(outside[0] | outside[1], parts), axis=(1, 3))
    return means * raw.balance, is_saturated, np.logical_not(is_outside)


def _picked(cells: Cells, is_flat: BoolArray, spread: Float64Array) -> IndexArray:
    """Return the positions of flat cells, at most `PER_BIN` of one brightness: the flattest, and others for colors."""
    rng = np.random.default_rng(SEED)
    bins = np.floor(np.log2(np.maximum(cells.light[:, 1], 2.0**-14)) / BIN)
    picked = []
    for value in np.unique(bins[is_flat]):
        members = np.flatnonzero(is_flat & (bins == value))
        members = members[spread[members].argsort(kind="stable")]
        flattest, others = members[: PER_BIN // 2], members[PER_BIN // 2 :]
        picked += [flattest, rng.permutation(others)[: PER_BIN - len(flattest)]]
    return np.concatenate(picked) if picked else np.zeros(0, np.intp)
