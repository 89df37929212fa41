"""Photographs, real and simulated, as the network's features of their windows, by cue."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
import torch

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.statistics import window_statistics
from crfnet_core.statistics.windows import cut_windows, select_windows
from crfnet_core.types import Float32Array, Float64Array, IndexArray
from training.data.curves import CurveSource
from training.data.real.photographs import REAL_BODIES, RealPhotograph, real_photographs
from training.data.scenes import Scene
from training.network.features import Features
from training.synthesis.camera_draws import WINDOWS, CameraShares
from training.synthesis.photographs import PhotographSource

#: The cues, which are the kinds of features of `training.network.features`, in the order in which it returns them.
CUES = ("levels", "edges", "equations", "candidates")

#: All cues together.
ALL = "all"


class RealSet(StrEnum):
    """Real photographs: whose windows are point-sampled, those made small before, and crops at full resolution."""

    SAMPLED = "point-sampled"
    SMALL = "made small"
    CROPS = "crops"


@dataclass(frozen=True)
class SampleSet:
    """Photographs as a classifier sees them.

    Parameters
    ----------
    features : dict of str to ndarray, float64, shape (N, F)
        Cue -> features of the photographs' windows together.
    groups : ndarray of int, shape (N,)
        Scene or body of each photograph: those of one are never both learned from and judged.
    """

    features: dict[str, Float64Array]
    groups: IndexArray

    @classmethod
    def of(cls, statistics: Sequence[Float32Array], groups: Sequence[int]) -> SampleSet:
        """Return the set of photographs whose windows' statistics, (LENGTH,), are added up."""
        with torch.no_grad():
            parts = Features()(torch.from_numpy(np.stack(statistics)))
        arrays = [part.flatten(1).double().numpy() for part in parts]
        features = dict(zip(CUES, arrays, strict=True)) | {ALL: np.concatenate(arrays, axis=1)}
        return cls(features, np.asarray(groups))

    @classmethod
    def joined(cls, sets: Sequence[SampleSet]) -> SampleSet:
        """Return all photographs of several sets."""
        features = {cue: np.concatenate([one.features[cue] for one in sets]) for cue in (*CUES, ALL)}
        return cls(features, np.concatenate([one.groups for one in sets]))


def real_samples(data: Path) -> dict[RealSet, SampleSet]:
    """Return the real photographs of DATA/real_bodies: the windows of each that the product would choose first."""
    photographs = real_photographs(data)[REAL_BODIES]
    bodies = sorted({photograph.body_key for photograph in photographs})
    statistics: dict[RealSet, list[Float32Array]] = {kind: [] for kind in RealSet}
    groups: dict[RealSet, list[int]] = {kind: [] for kind in RealSet}
    for photograph in photographs:
        for kind, path in _files(photograph).items():
            statistics[kind].append(_statistics(_real_windows(path)))
            groups[kind].append(bodies.index(photograph.body_key))
    return {kind: SampleSet.of(statistics[kind], groups[kind]) for kind in RealSet}


def measured_responses(data: Path) -> CurveSource:
    """Return the measured responses of the bodies of DATA/real_bodies, so that responses separate nothing."""
    files = sorted({photograph.measured: photograph for photograph in real_photographs(data)[REAL_BODIES]}.items())
    curves = np.stack([photograph.truth().brightness for _, photograph in files])
    return CurveSource(curves, (), camera_fraction=0, plain_fraction=1)


def simulated_samples(
    scenes: list[Scene], curves: CurveSource, shares: CameraShares, luminance: Float32Array, *, count: int, seed: int
) -> SampleSet:
    """Return `count` simulated photographs, evenly of the scenes; `luminance` sets the exposures."""
    statistics: list[Float32Array] = []
    groups: list[int] = []
    rng = np.random.default_rng(seed)
    while len(statistics) < count:
        number = len(statistics) % len(scenes)
        source = PhotographSource([scenes[number]], (curves,), (1.0,), luminance, cameras=1, shares=shares)
        for photo in source.draw(rng):
            statistics.append(_statistics(np.divide(photo.windows, np.float32(255), dtype=np.float32)))
            groups.append(number)
    return SampleSet.of(statistics, groups)


def _files(photograph: RealPhotograph) -> dict[RealSet, Path]:
    """Return the set -> the file of a photograph, and of its crop where there is one."""
    is_sampled = photograph.photograph.suffix == ".webp"
    files = {RealSet.SAMPLED if is_sampled else RealSet.SMALL: photograph.photograph}
    crop = photograph.photograph.parent.parent / "crops" / f"{photograph.name}.jpg"
    return files | ({RealSet.CROPS: crop} if crop.exists() else {})


def _real_windows(path: Path) -> Float32Array:
    """Return the windows of a photograph that the product chooses, up to `WINDOWS` of them, (N, 227, 227, 3)."""
    pixels = read_photo(path).pixels
    return cut_windows(pixels, select_windows(pixels, count=WINDOWS))


def _statistics(windows: Float32Array) -> Float32Array:
    """Return the statistics of all windows of a photograph together."""
    total: Float32Array = np.sum([window_statistics(window) for window in windows], axis=0)
    return total
