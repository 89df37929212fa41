"""Scene-linear photographs to train and measure on, split by scene."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from crfnet_core.errors import CRFNetError

#: Every scene keeps its split for ever: the seed of the shuffle that made it.
SPLIT_SEED = 2017

#: Scenes held out for figures, and scenes held out to choose and to calibrate.
TEST_SCENES, VALIDATION_SCENES = 20, 12

#: How the source of a scene begins in manifest.csv that `training.data.import_scenes` added.
IMPORTED = "brought:"

#: Luminance weights of linear Rec. 709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)


@dataclass(frozen=True)
class Scene:
    """A linear photograph, scaled so that the geometric mean of its luminance is 1."""

    name: str
    pixels: np.ndarray
    is_panorama: bool

    @classmethod
    def scaled(cls, name: str, pixels: np.ndarray, is_panorama: bool) -> Scene:
        """Return the scene of linear pixels of any scale."""
        luminance = pixels @ LUMINANCE
        return cls(name, pixels / np.exp(np.log(luminance[luminance > 0]).mean()), is_panorama)


def split_scenes(folder: Path, *, with_imported: bool = True) -> dict[str, list[tuple[str, bool]]]:
    """Return split name -> (file, is panorama) of every scene in the folder's manifest.csv.

    A quarter of the perspective photographs is tested, none validates; the rest of each split are panoramas. What
    `training.data.import_scenes` added only trains, so that bringing scenes moves none of the others; without `brought` it is not
    listed.
    """
    with (folder / "manifest.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    own = [row.get("source", "").startswith(IMPORTED) for row in rows]
    listed = [(row["file"], row["kind"] == "panorama band") for row in rows]
    scenes = sorted(scene for scene, is_own in zip(listed, own, strict=True) if not is_own)
    more = sorted(scene for scene, is_own in zip(listed, own, strict=True) if is_own and with_imported)
    rng = np.random.default_rng(SPLIT_SEED)
    panoramas = [scenes[i] for i in rng.permutation(len(scenes)) if scenes[i][1]]
    photographs = [scene for scene in scenes if not scene[1]]
    photographs = [photographs[i] for i in rng.permutation(len(photographs))]
    held_out = len(photographs) // 4
    tested, validated = TEST_SCENES - held_out, VALIDATION_SCENES
    return {
        "test": photographs[:held_out] + panoramas[:tested],
        "validation": panoramas[tested : tested + validated],
        "train": photographs[held_out:] + panoramas[tested + validated :] + more,
    }


def read_scenes(folder: Path, split: str) -> list[Scene]:
    """Return the scenes of a split, from the EXR files of `folder`.

    Raises
    ------
    CRFNetError
        If the split has none.
    """
    scenes = split_scenes(folder)[split]
    if not scenes:
        raise CRFNetError(f"{folder}: too few scenes, none is left for the split {split}; add to the published ones")
    return [read_scene(folder / name, is_panorama) for name, is_panorama in scenes]


def read_scene(path: Path, is_panorama: bool) -> Scene:
    """Return one scene; negative values, which no sensor records, become 0."""
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)[:, :, :3]
    pixels = np.clip(np.nan_to_num(pixels), 0, 65000).astype(np.float32)
    return Scene.scaled(path.stem, pixels, is_panorama)


def area_averaged(samples: np.ndarray, scale: int) -> np.ndarray:
    """Return the means of scale x scale samples, float32 (H // scale, W // scale, 3); an incomplete rest is dropped."""
    height, width = (side // scale for side in samples.shape[:2])
    whole = samples[: height * scale, : width * scale]
    return whole.reshape(height, scale, width, scale, 3).mean(axis=(1, 3), dtype=np.float32)


def dithered(pixels: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return pixels spread over one step of the shared-exponent files that the panoramas were kept in.

    RGBE has an 8-bit mantissa in the brightest channel; undithered, its steps would leave gaps in the histogram that
    give the response away.
    """
    step = np.exp2(np.floor(np.log2(pixels.max(axis=-1, keepdims=True) + 1e-12)) - 7)
    noise = rng.random(pixels.shape, dtype=np.float32) - np.float32(0.5)
    return np.maximum(pixels + noise * step, 0)
