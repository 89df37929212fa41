"""A pack: linear scenes, memory-mapped, with the responses to photograph them by and their exposures.

A pack holds shards of float16 samples (NPY, at most 60 MiB each) and an index for each split. Beside them are the 201
responses of DoRF, each with its s_crf, the exposure of `training.synthesis.camera.automatic_exposure`. As in the paper
(Sec. 3.3), s_crf belongs to the response and not to the photograph, and it is the same for every split.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from crfnet_core.files import atomic_write, atomic_write_text
from training.data.curves import DORF_FILE, read_dorf
from training.data.scenes import Scene, area_averaged, dithered, read_scenes
from training.synthesis.camera import automatic_exposure, reference_luminance

#: Most samples of a shard: 60 MiB of float16.
SHARD_SAMPLES = 30 * 2**20

#: Scenes are averaged by a whole factor that leaves the shorter side at least this many samples.
SHORTER_SIDE = 395

#: The largest finite float16.
FLOAT16_MAX = 65504.0


@dataclass(frozen=True)
class ScenePack:
    """The linear scenes of one split, and the responses.

    scenes, float16 (H, W, 3): irradiance, each scene scaled to a geometric mean luminance of 1; memory-mapped
    curves, float32 (201, 1024): responses at uniform irradiances
    exposures, float32 (201,): s_crf of each response
    """

    scenes: tuple[np.ndarray, ...]
    curves: np.ndarray
    exposures: np.ndarray


def area_scaled(pixels: np.ndarray) -> np.ndarray:
    """Return linear pixels (H, W, 3), averaged so that the shorter side keeps at least `SHORTER_SIDE` samples."""
    factor = max(1, min(pixels.shape[:2]) // SHORTER_SIDE)
    return area_averaged(pixels, factor)


def packed_scene(scene: Scene, number: int) -> np.ndarray:
    """Return a scene as float16 (H, W, 3); a panorama is dithered first, with a seed of its number."""
    pixels = dithered(scene.pixels, np.random.default_rng([2017, number])) if scene.is_panorama else scene.pixels
    return np.minimum(area_scaled(pixels), FLOAT16_MAX).astype(np.float16)


def write_pack(data: Path, out: Path, split: str) -> Path:
    """Write the shards of a split and the responses with their s_crf; return the path of the split's index."""
    scenes = read_scenes(data / "linear", split)
    training = scenes if split == "train" else read_scenes(data / "linear", "train")
    luminance = reference_luminance(training)
    curves = read_dorf(data / DORF_FILE)
    exposures = [automatic_exposure(curve, luminance) for curve in tqdm(curves, desc="s_crf", disable=None)]
    out.mkdir(parents=True, exist_ok=True)
    with atomic_write(out / "curves.npz", overwrite=True) as temporary:
        np.savez(temporary, curves=curves.astype(np.float32), exposures=np.array(exposures, dtype=np.float32))
    return write_scenes([(scene.name, packed_scene(scene, n)) for n, scene in enumerate(scenes)], out, split)


def write_scenes(scenes: list[tuple[str, np.ndarray]], out: Path, split: str) -> Path:
    """Write named float16 scenes as shards with an index, and return the path of the index."""
    index: list[dict[str, Any]] = []
    shard: list[np.ndarray] = []
    used = number = 0
    for name, pixels in scenes:
        if used + pixels.size > SHARD_SAMPLES and shard:
            _write_shard(out, split, number, shard)
            shard, used, number = [], 0, number + 1
        index.append({"name": name, "shard": number, "start": used, "shape": list(pixels.shape)})
        shard.append(pixels.ravel())
        used += pixels.size
    _write_shard(out, split, number, shard)
    path = out / f"{split}.json"
    atomic_write_text(path, json.dumps(index, indent=1) + "\n", overwrite=True)
    return path


def read_pack(folder: Path, split: str) -> ScenePack:
    """Return a split of a pack, its scenes memory-mapped.

    Raise FileNotFoundError if the folder holds no such split.
    """
    if not (folder / f"{split}.json").exists():
        raise FileNotFoundError(f"{folder}: no pack of the split {split}; run python -m training.crfnet2017.windows")
    index = json.loads((folder / f"{split}.json").read_text())
    shards = [np.load(_shard(folder, split, n), mmap_mode="r") for n in range(index[-1]["shard"] + 1)]
    scenes = []
    for entry in index:
        start, shape = entry["start"], tuple(entry["shape"])
        scenes.append(shards[entry["shard"]][start : start + int(np.prod(shape))].reshape(shape))
    with np.load(folder / "curves.npz") as arrays:
        return ScenePack(tuple(scenes), arrays["curves"], arrays["exposures"])


def pack_files(folder: Path) -> list[Path]:
    """Return the files that a training reads of a pack: shards, indices, and the responses."""
    splits = [folder / f"{split}.json" for split in ("train", "validation")]
    return sorted([*folder.glob("*.npy"), *splits, folder / "curves.npz"])


def _shard(folder: Path, split: str, number: int) -> Path:
    """Return the path of a shard."""
    return folder / f"{split}_{number:03d}.npy"


def _write_shard(folder: Path, split: str, number: int, parts: list[np.ndarray]) -> None:
    """Write one shard."""
    with atomic_write(_shard(folder, split, number), overwrite=True) as temporary:
        np.save(temporary, np.concatenate(parts))
