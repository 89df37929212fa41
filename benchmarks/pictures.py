"""The pictures that are measured on: the bundled photograph, made large, small, and many."""

from __future__ import annotations

import os
from collections.abc import Callable
from multiprocessing import Process
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

PLATE = Path(__file__).parents[1] / "tests" / "data" / "plate.jpg"


def make_photograph(path: Path, width: int = 6000, height: int = 4000, *, seed: int = 0) -> None:
    """Write the bundled photograph, mirrored and tiled to a size, with noise of its own everywhere."""
    pixels = np.asarray(oiio.ImageBuf(str(PLATE)).get_pixels(oiio.UINT8))
    pair = np.concatenate([pixels, pixels[:, ::-1]], axis=1)
    tile = np.concatenate([pair, pair[::-1]], axis=0)
    rows, columns = -(-height // tile.shape[0]), -(-width // tile.shape[1])
    large = np.tile(tile, (rows, columns, 1))[:height, :width]
    noise = np.random.default_rng(seed).normal(0, 1.5, large.shape)
    codes = np.clip(np.rint(large + noise), 0, 255).astype(np.uint8)
    spec = oiio.ImageSpec(width, height, 3, oiio.UINT8)
    spec["Compression"] = "jpeg:92"
    image = oiio.ImageBuf(spec)
    image.set_pixels(image.roi, codes)
    image.write(str(path))


def make_frames(pattern: Path, count: int) -> None:
    """Write a sequence of 4K frames, plate.1.jpg and so on for `plate.%d.jpg`: links to one file."""
    first = Path(str(pattern) % 1)
    make_photograph(first, 3840, 2160)
    for number in range(2, count + 1):
        os.link(first, str(pattern) % number)


def make_small_photographs(folder: Path, count: int) -> None:
    """Write photographs of 640 x 480 pixels, each with noise of its own."""
    for number in range(count):
        make_photograph(folder / f"photo{number:05}.jpg", 640, 480, seed=number)


def made(make: Callable[..., None], path: Path, *arguments: object) -> Path:
    """Make pictures in a process of their own, since a process has at least the peak memory of what started it."""
    making = Process(target=make, args=(path, *arguments))
    making.start()
    making.join()
    return path
