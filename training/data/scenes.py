"""Scene-linear photographs to train and measure on, and the tables that come with the data."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.types import Float32Array

#: The first and the last row of a panorama that are used, as fractions of its height: near its poles it is stretched.
BAND = (0.1, 0.9)

#: Weights of R, G and B in the luminance of linear Rec.709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722], dtype=np.float32)


@dataclass(frozen=True)
class Scene:
    """A linear photograph."""

    name: str  # the name of its file, without suffix
    #: Shape (H, W, 3): linear light, Rec.709 primaries, scaled so that the geometric mean of the luminance is 1.
    pixels: Float32Array
    is_panorama: bool  # whether it is a band of an equirectangular panorama

    @classmethod
    def scaled(cls, name: str, pixels: Float32Array, is_panorama: bool) -> Self:
        """Return the scene of linear pixels (H, W, 3) of any scale."""
        luminance = pixels @ LUMINANCE
        return cls(name, pixels / np.exp(np.log(luminance[luminance > 0]).mean()), is_panorama)


def table_rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table that comes with the data."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def table_text(columns: Sequence[str], rows: Iterable[Mapping[str, str]]) -> str:
    """Return the CSV text of rows, the first line of which names the columns."""
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def read_scene(path: Path, is_panorama: bool) -> Scene:
    """Return one scene; negative values become 0, because no sensor records them."""
    samples = np.asarray(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))[:, :, :3]
    pixels = np.clip(np.nan_to_num(samples), 0, 65000).astype(np.float32)
    return Scene.scaled(path.stem, pixels, is_panorama)


def area_averaged(samples: NDArray[Any], scale: int) -> Float32Array:
    """Return the means of scale x scale samples, float32 (H // scale, W // scale, 3), without an incomplete rest."""
    height, width = (side // scale for side in samples.shape[:2])
    whole = samples[: height * scale, : width * scale]
    return whole.reshape(height, scale, width, scale, 3).mean(axis=(1, 3), dtype=np.float32)


def dithered(pixels: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return pixels (..., 3) with uniform noise of one step of RGBE, the format that the panoramas were stored in.

    RGBE has an 8-bit mantissa in the brightest channel. Without dither its steps would leave gaps in the histogram of a
    photograph, and the gaps would give the response away.
    """
    step = np.exp2(np.floor(np.log2(pixels.max(axis=-1, keepdims=True) + 1e-12)) - 7)
    noise = rng.random(pixels.shape, dtype=np.float32) - np.float32(0.5)
    return np.maximum(pixels + noise * step, 0)
