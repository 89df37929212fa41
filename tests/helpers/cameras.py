"""Cameras with known responses, and photographs with EXIF."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core import ResponseCurve
from crfnet_core.library import Camera, CameraSettings
from tests.helpers.images import read_image, write_image


def camera(name: str, gamma: float = 2.2, *, stops: float = 0.1, **settings: Any) -> Camera:
    """Return a camera whose response is a power law, measured on six exposures."""
    return Camera(name, ResponseCurve.gamma(gamma), 0.05, stops, "6 exposures", CameraSettings(**settings))


def photograph(plate: Path, path: Path, *, seed: int = 0, **header: Any) -> Path:
    """Write the bundled photograph with its tiles in another order, so that it shows another scene, and return it."""
    pixels = read_image(plate)
    if seed:
        halves = [np.array_split(row, 3, axis=1) for row in np.array_split(pixels, 2, axis=0)]
        order = np.random.default_rng(seed).permutation(6)
        tiles = [halves[n // 3][n % 3] for n in range(6)]
        height, width = min(tile.shape[0] for tile in tiles), min(tile.shape[1] for tile in tiles)
        cut = [tiles[n][:height, :width] for n in order]
        pixels = np.concatenate([np.concatenate(cut[:3], axis=1), np.concatenate(cut[3:], axis=1)], axis=0)
    return write_image(path, pixels, **({"Make": "SONY", "Model": "ILCE-7M3"} | header))
