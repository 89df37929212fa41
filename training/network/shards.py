"""Make and read shards of statistics: ``python -m training.network.shards --data DIR --out DIR --photographs N``."""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from tqdm import tqdm

from crfnet_core.files import atomic_write
from crfnet_core.statistics import window_statistics
from training.data.curves import CurveSource, read_base_curves, read_dorf
from training.data.scenes import read_scenes
from training.data.splits import held_out_curves
from training.synthesis.camera import reference_luminance
from training.synthesis.photographs import PhotographSource

#: Photographs of one shard file.
SHARD = 500

#: Every how many-th sample of a response is kept as the target.
TARGET_STRIDE = 8

#: Statistics are kept as float16 in units of this many samples.
UNIT = 256

#: Share of photographs whose response is of the in-camera family; the others are of DoRF.
CAMERA_SHARE = 0.45

#: The sets of responses: DoRF without and with the curves held out of P2, and in-camera curves.
KEPT, HELD_OUT, IN_CAMERA = 0, 1, 2


@cache
def photograph_source(data: Path, split: str) -> PhotographSource:
    """Return the source of a split's photographs; the exposure always comes from the training scenes."""
    dorf = read_dorf(data / "dorf" / "201_CRF_data.mat")
    held_out = np.isin(np.arange(len(dorf)), held_out_curves(dorf))
    bases = tuple(read_base_curves(data / "camera_curves" / "base_curves.csv").values())
    sets = (
        CurveSource(dorf[~held_out], (), camera_share=0),
        CurveSource(dorf[held_out], (), camera_share=0),
        CurveSource(dorf, bases, camera_share=1),
    )
    of_dorf = 1 - CAMERA_SHARE
    shares = (of_dorf * float((~held_out).mean()), of_dorf * float(held_out.mean()), CAMERA_SHARE)
    luminance = reference_luminance(read_scenes(data / "linear", "train"))
    return PhotographSource(read_scenes(data / "linear", split), sets, shares, luminance)


def make_shard(data: Path, out: Path, split: str, number: int) -> Path:
    """Write the shard `number` of a split, unless it is there already, and return its path.

    Its photographs depend only on the split and the number: a run can stop and go on, on any number of processes.
    """
    path = out / f"{split}_{number:04d}.npz"
    if path.exists():
        return path
    source, rng = photograph_source(data, split), np.random.default_rng([number, len(split)])
    rows: list[np.ndarray] = []
    curves: list[np.ndarray] = []
    sets: list[tuple[int, int]] = []
    while len(rows) < SHARD:
        for photo in source.draw(rng)[: SHARD - len(rows)]:
            windows = photo.windows / np.float32(255)
            rows.append((np.stack([window_statistics(w) for w in windows]) / UNIT).astype(np.float16))
            curves.append(photo.curve[::TARGET_STRIDE].astype(np.float32))
            sets.append((photo.curve_set, photo.fold))
    with atomic_write(path) as temporary:
        curve_sets, folds = np.array(sets, np.int8).T
        np.savez(temporary, statistics=np.stack(rows), curves=np.stack(curves), curve_sets=curve_sets, folds=folds)
    return path


@dataclass(frozen=True)
class Shards:
    """Photographs: statistics, float16 (P, 4, STATISTICS) in `UNIT`s, responses (P, 128), curve sets, folds (P,)."""

    statistics: Tensor
    curves: Tensor
    curve_sets: Tensor
    folds: Tensor

    def only(self, chosen: Tensor) -> Shards:
        """Return the photographs where `chosen`, bool (P,), is true."""
        return Shards(*(getattr(self, field.name)[chosen] for field in fields(self)))

    def batch(self, rows: Tensor) -> tuple[Tensor, Tensor]:
        """Return statistics, float32 (B, 4, STATISTICS), and responses (B, 128), of the photographs in `rows`."""
        return self.statistics[rows].float() * UNIT, self.curves[rows]


def read_shards(folder: Path, split: str) -> Shards:
    """Return all photographs of a split that are there."""
    shards = [np.load(path) for path in sorted(folder.glob(f"{split}_*.npz"))]
    if not shards:
        raise FileNotFoundError(
            f"{folder}: no shards of the split {split}; run python -m training.network.shards first"
        )
    parts = (np.concatenate([shard[field.name] for shard in shards]) for field in fields(Shards))
    return Shards(*map(torch.from_numpy, parts))


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
    numbers = range(-(-options.photographs // SHARD))
    with ProcessPoolExecutor(options.workers) as pool:
        jobs = [pool.submit(make_shard, options.data, options.out, options.split, n) for n in numbers]
        for job in tqdm(jobs, unit="shard"):
            job.result()


if __name__ == "__main__":
    main()
