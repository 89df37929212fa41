"""Affine resampling: windows of a scene at any angle and scale, so that few scenes give many windows."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d

from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array, Float64Array, IndexArray
from training.data.scenes import Scene

#: Smallest and largest distance between samples, in pixels of the scene. Below 1 a window is as soft as a photograph
#: whose lens does not resolve its pixels.
SCALES = (0.55, 3.0)

STRETCH = 0.12  # standard deviation of the logarithm of the stretch along one axis
THUMBNAIL_STEP = 4  # step between the samples that a thumbnail keeps along both sides

#: Standard deviation of the Gaussian before sampling, in units of the distance between samples. It averages linear
#: light, as a sensor does.
PREFILTER = 0.45


@dataclass(frozen=True)
class AffineResampling:
    """A window of side x side samples at center + matrix @ (row, column), mirrored beyond the sides of the scene."""

    scene: Scene
    matrix: Float64Array  # (2, 2): from samples to pixels of the scene
    center: Float64Array  # (2,): row and column of the scene at the center of the window
    side: int = WINDOW_SIZE

    @classmethod
    def draw(cls, scene: Scene, rng: np.random.Generator, *, side: int = WINDOW_SIZE) -> Self:
        """Return a window at a random position, angle, scale and stretch; a larger one shows more, in finer samples."""
        largest = SCALES[1] * min(1.0, 1.6 * WINDOW_SIZE / side)
        smallest = min(SCALES[0] * np.sqrt(side / WINDOW_SIZE), largest / 2)
        scale, angle = float(np.exp(rng.uniform(*np.log((smallest, largest))))), rng.uniform(0, 2 * np.pi)
        stretch = np.exp(rng.normal(0, STRETCH))
        rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        matrix = scale * rotation @ np.diag([stretch, 1 / stretch])
        return cls(scene, matrix, rng.uniform(0, scene.pixels.shape[:2]), side)

    @property
    def scale(self) -> float:
        """The distance between samples, in pixels of the scene."""
        return float(np.sqrt(abs(np.linalg.det(self.matrix))))

    def window(self, step: int = 1) -> Float32Array:
        """Return every step-th sample, bilinear, float32 (C, C, 3); the whole window is prefiltered."""
        reach = np.abs(self.matrix) @ np.full(2, self.side / 2) + 3 * max(1.0, self.scale)
        first, last = np.floor(self.center - reach).astype(int), np.ceil(self.center + reach).astype(int)
        size = self.scene.pixels.shape[:2]
        rows, columns = (_mirrored(np.arange(first[k], last[k] + 1), size[k]) for k in (0, 1))
        light = self.scene.pixels.take(rows, axis=0).take(columns, axis=1)
        if step == 1 and self.scale > 1:
            for axis in (0, 1):
                light = gaussian_filter1d(light, PREFILTER * self.scale, axis=axis, truncate=2)
        start = self.center - first - self.matrix @ np.full(2, self.side / 2)
        side = (self.side - 1) // step + 1
        (a, b), (c, d) = (self.matrix * step)[::-1, ::-1]  # Pillow has columns before rows, and pixel centers at 0.5
        x, y = start[::-1] + 0.5 - (self.matrix * step)[::-1].sum(axis=1) / 2
        affine = (Image.Transform.AFFINE, (a, b, x, c, d, y), Image.Resampling.BILINEAR)
        channels = [Image.fromarray(light[:, :, k]).transform((side, side), *affine) for k in range(3)]
        return np.stack([np.asarray(channel) for channel in channels], axis=-1)


def _mirrored(index: IndexArray, size: int) -> IndexArray:
    """Return indices folded back into 0 .. size - 1 at both ends."""
    folded = index % (2 * size)
    return np.where(folded < size, folded, 2 * size - 1 - folded)
