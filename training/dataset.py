"""Make and read shards of window statistics: ``python -m training.dataset --data DIR --out DIR --windows N``."""

from __future__ import annotations

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from functools import cache
from pathlib import Path

import numpy as np
import torch
from tqdm import tqdm

from crfnet_core.files import written_whole
from training.curves import CurveSource, read_base_curves, read_dorf
from training.model import NetworkConfig, WindowStatistics
from training.scenes import read_scenes
from training.synthesis import WindowSource, reference_luminance

#: Windows of one shard file.
SHARD = 2000

#: Every how many-th sample of a response is kept as the target.
TARGET_STRIDE = 8


@cache
def window_source(data: Path, split: str) -> WindowSource:
    """Return the source of a split's windows; the exposure always comes from the training scenes."""
    curves = CurveSource(
        read_dorf(data / "dorf" / "201_CRF_data.mat"),
        tuple(read_base_curves(data / "camera_curves" / "base_curves.csv").values()),
    )
    luminance = reference_luminance(read_scenes(data / "linear", "train"))
    return WindowSource(read_scenes(data / "linear", split), curves, luminance)


def make_shard(data: Path, out: Path, split: str, number: int, config: NetworkConfig) -> Path:
    """Write the shard `number` of a split, unless it is there already, and return its path.

    Its windows depend only on the split and the number: a run can stop and go on, on any number of processes.
    """
    path = out / f"{split}_{number:04d}.npz"
    if path.exists():
        return path
    torch.set_num_threads(1)
    source, statistics = window_source(data, split), WindowStatistics(config)
    rng = np.random.default_rng([number, len(split)])
    rows: list[np.ndarray] = []
    curves: list[np.ndarray] = []
    while len(rows) < SHARD:
        for window, curve in source.draw(rng)[: SHARD - len(rows)]:
            with torch.inference_mode():
                batch = torch.from_numpy(window / np.float32(255)).permute(2, 0, 1)[None]
                rows.append(statistics(batch)[0].numpy().astype(np.float16))
            curves.append(curve[::TARGET_STRIDE].astype(np.float32))
    with written_whole(path) as temporary:
        np.savez(temporary, statistics=np.stack(rows), curves=np.stack(curves))
    return path


def read_shards(folder: Path, split: str) -> tuple[torch.Tensor, torch.Tensor]:
    """Return statistics, float16 (N, features), and responses, float32 (N, 128), of all shards of a split."""
    shards = [np.load(path) for path in sorted(folder.glob(f"{split}_*.npz"))]
    if not shards:
        raise FileNotFoundError(f"{folder}: no shards of the split {split}; run python -m training.dataset first")
    names = ("statistics", "curves")
    statistics, curves = (torch.from_numpy(np.concatenate([shard[name] for shard in shards])) for name in names)
    return statistics, curves


def main() -> None:
    """Make the shards that are not there yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves and linear")
    parser.add_argument("--out", type=Path, required=True, help="folder of the shards")
    parser.add_argument("--split", default="train", choices=["train", "validation"])
    parser.add_argument("--windows", type=int, default=72_000)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    config = NetworkConfig()
    (options.out / "statistics.json").write_text(json.dumps(asdict(config), indent=2) + "\n")
    numbers = range(-(-options.windows // SHARD))
    with ProcessPoolExecutor(options.workers) as pool:
        jobs = [pool.submit(make_shard, options.data, options.out, options.split, n, config) for n in numbers]
        for job in tqdm(jobs, unit="shard"):
            job.result()


if __name__ == "__main__":
    main()
