"""Make and read shards of statistics: ``python -m training.network.shards --data DIR --out DIR --photographs N``."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cache
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from tqdm import tqdm

from crfnet_core.files import atomic_write
from crfnet_core.posterior import UNUSUAL, Family
from crfnet_core.response.emor import EmorBasis
from crfnet_core.statistics import window_statistics
from training.data.curves import BASE_CURVES_FILE, CurveSource, DrawResponse, read_base_curves, read_dorf
from training.data.families import edited
from training.data.manifest import training_digest
from training.data.splits import SPLITS, read_scenes
from training.provenance import record_making
from training.synthesis.camera import reference_luminance
from training.synthesis.photographs import PhotographSource
from training.synthesis.unusual import UnusualKind

SHARD = 500  # photographs in a shard file
UNIT = 256  # statistics are kept as float16, in units of this many samples


class CurveSet(IntEnum):
    """The sets of responses: DoRF without the curves that P2 holds out, these curves, in-camera curves, and others."""

    DORF = 0
    HELD_OUT = 1
    IN_CAMERA = 2
    EDITED = 3
    LINEAR = 4
    LOG = 5
    UNEXPLAINED = 6


#: Fractions of the photographs whose response is of DoRF (both sets together), and of each other set. All families are
#: common enough to be learned. In use, the prior has shares of its own.
OF_DORF = 0.5
FRACTIONS = {
    CurveSet.IN_CAMERA: 0.3,
    CurveSet.EDITED: 0.08,
    CurveSet.LINEAR: 0.02,
    CurveSet.LOG: 0.03,
    CurveSet.UNEXPLAINED: 0.07,
}

#: What the photographs of these sets show in place of a response: pictures that none explains.
UNUSUAL_KINDS: dict[int, tuple[UnusualKind, ...]] = {
    CurveSet.LINEAR: (UnusualKind.NEAR_LINEAR,),
    CurveSet.LOG: (UnusualKind.LOG_FOOTAGE,),
    CurveSet.UNEXPLAINED: tuple(
        kind for kind in UnusualKind if kind not in (UnusualKind.NEAR_LINEAR, UnusualKind.LOG_FOOTAGE)
    ),
}

#: The family of a set as the network states it: 0 of an ordinary response, else 1 + its position in `UNUSUAL`.
STATED_FAMILIES = {
    curve_set: UNUSUAL.index(Family(curve_set.name.lower())) + 1
    for curve_set in (CurveSet.LINEAR, CurveSet.LOG, CurveSet.UNEXPLAINED)
}


@dataclass(frozen=True)
class Shards:
    """Photographs as the training reads them."""

    statistics: Tensor  # float16 (P, 4, LENGTH): of the windows, in `UNIT`s
    weights: Tensor  # float32 (P, 11): EMoR weights of the responses
    curve_sets: Tensor  # int8 (P,): `CurveSet` of the response

    @property
    def families(self) -> Tensor:
        """The families as the network states them, int64 (P,): see `STATED_FAMILIES`."""
        families = torch.zeros(len(self.curve_sets), dtype=torch.int64)
        for curve_set, family in STATED_FAMILIES.items():
            families[self.curve_sets == curve_set] = family
        return families

    def only(self, chosen: Tensor) -> Shards:
        """Return the photographs where `chosen`, bool (P,), is true."""
        return Shards(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def batch(self, rows: Tensor) -> tuple[Tensor, Tensor]:
        """Return statistics, float32 (B, 4, LENGTH), and EMoR weights (B, 11) of photographs."""
        return self.statistics[rows].float() * UNIT, self.weights[rows]


@cache
def photograph_source(data: Path, split: str) -> PhotographSource:
    """Return the source of a split's photographs; the exposure always comes from the training scenes."""
    dorf = read_dorf(data)
    is_held_out = np.isin(np.arange(len(dorf)), SPLITS["held_out_curves"])
    bases = tuple(read_base_curves(data / BASE_CURVES_FILE).values())
    in_camera = CurveSource(dorf, bases, camera_fraction=1).draw
    sets: dict[CurveSet, DrawResponse] = {
        CurveSet.DORF: CurveSource(dorf[~is_held_out], (), camera_fraction=0).draw,
        CurveSet.HELD_OUT: CurveSource(dorf[is_held_out], (), camera_fraction=0).draw,
        CurveSet.IN_CAMERA: in_camera,
        CurveSet.EDITED: lambda rng: edited(in_camera(rng)[None], rng)[0],
        **dict.fromkeys((CurveSet.LINEAR, CurveSet.LOG, CurveSet.UNEXPLAINED), in_camera),
    }
    held_out = float(is_held_out.mean())
    fractions = {CurveSet.DORF: OF_DORF * (1 - held_out), CurveSet.HELD_OUT: OF_DORF * held_out, **FRACTIONS}
    luminance = reference_luminance(read_scenes(data / "linear", "train"))
    scenes = read_scenes(data / "linear", split)
    return PhotographSource(scenes, tuple(sets.values()), tuple(fractions.values()), luminance, unusual=UNUSUAL_KINDS)


def make_shard(data: Path, out: Path, split: str, number: int) -> Path:
    """Write the shard `number` of a split and return its path; its photographs depend on these two only."""
    path = shard_path(out, split, number)
    # The length of the split's name (train 5, validation 10) separates the splits' seeds; kept for shards that exist.
    source, rng = photograph_source(data, split), np.random.default_rng([number, len(split)])
    rows: list[np.ndarray] = []
    weights: list[np.ndarray] = []
    sets: list[int] = []
    while len(rows) < SHARD:
        for photo in source.draw(rng)[: SHARD - len(rows)]:
            windows = photo.windows / np.float32(255)
            rows.append((np.stack([window_statistics(w) for w in windows]) / UNIT).astype(np.float16))
            weights.append(EmorBasis.load().project(photo.curve).astype(np.float32))
            sets.append(photo.curve_set)
    with atomic_write(path) as temporary:
        np.savez(temporary, statistics=np.stack(rows), weights=np.stack(weights), curve_sets=np.array(sets, np.int8))
    return path


def shard_path(folder: Path, split: str, number: int) -> Path:
    """Return the path of a shard file."""
    return folder / f"{split}_{number:04d}.npz"


def shard_files(folder: Path, split: str) -> list[Path]:
    """Return the shard files of a split, sorted; FileNotFoundError if there are none."""
    files = sorted(folder.glob(f"{split}_*.npz"))
    if not files:
        raise FileNotFoundError(f"{folder}: no shards of the split {split}; make them with training.network.shards")
    return files


def read_shards(folder: Path, split: str) -> Shards:
    """Return all photographs of a split that are there; FileNotFoundError if there are none."""
    shards = [np.load(path) for path in shard_files(folder, split)]
    return Shards(*(_joined(shards, field.name) for field in fields(Shards)))


def _joined(shards: Sequence[Mapping[str, np.ndarray]], name: str) -> Tensor:
    """Return an array of all shards, (P, ...), filled one by one: to concatenate them takes twice the memory."""
    first, count = shards[0][name], sum(len(shard["weights"]) for shard in shards)
    joined, end = torch.empty((count, *first.shape[1:]), dtype=torch.from_numpy(first).dtype), 0
    for shard in shards:
        part = torch.from_numpy(shard[name])
        joined[end : end + len(part)] = part
        end += len(part)
    return joined


def main() -> None:
    """Make the shards that are not there yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves and linear")
    parser.add_argument("--out", type=Path, required=True, help="folder of the shards")
    parser.add_argument("--split", default="train", choices=["train", "validation"])
    parser.add_argument("--photographs", type=int, default=50_000)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    shards = range(math.ceil(options.photographs / SHARD))
    numbers = [n for n in shards if not shard_path(options.out, options.split, n).exists()]
    if numbers:
        record_making(options.out, options.split, training_digest(options.data))
    with ProcessPoolExecutor(options.workers) as pool:
        jobs = [pool.submit(make_shard, options.data, options.out, options.split, n) for n in numbers]
        for job in tqdm(jobs, unit="shard"):
            job.result()


if __name__ == "__main__":
    main()
