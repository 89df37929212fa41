"""Views of a scene at any angle and scale, so that few scenes give many windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import affine_transform, gaussian_filter1d

from crfnet_core.windows import WINDOW_SIZE
from training.data.scenes import Scene

#: Pixels of the scene per sample of the window, least and most: below 1 a window is as soft as a photograph whose
#: lens does not resolve its pixels.
SCALES = (0.55, 3.0)

#: Standard deviation of the logarithm of the stretch along one axis.
STRETCH = 0.12

#: Blur before sampling, in units of the distance between samples, which keeps mixtures of light linear.
PREFILTER = 0.45


@dataclass(frozen=True)
class View:
    """Samples at `matrix` @ (row, column) around `centre`, in pixels of the scene; beyond its sides it is mirrored."""

    scene: Scene
    matrix: np.ndarray
    centre: np.ndarray

    @classmethod
    def draw(cls, scene: Scene, rng: np.random.Generator) -> View:
        """Return a view at a random place, angle, scale and stretch."""
        scale, angle = float(np.exp(rng.uniform(*np.log(SCALES)))), rng.uniform(0, 2 * np.pi)
        stretch = np.exp(rng.normal(0, STRETCH))
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        matrix = scale * turn @ np.diag([stretch, 1 / stretch])
        return cls(scene, matrix, rng.uniform(0, scene.pixels.shape[:2]))

    @property
    def scale(self) -> float:
        """Pixels of the scene per sample."""
        return float(np.sqrt(abs(np.linalg.det(self.matrix))))

    def window(self) -> np.ndarray:
        """Return the linear window, float32 (227, 227, 3)."""
        return self._sampled(1)

    def glance(self) -> np.ndarray:
        """Return every fourth sample along both sides, not prefiltered, float32 (57, 57, 3)."""
        return self._sampled(4)

    def _sampled(self, step: int) -> np.ndarray:
        """Return every step-th sample."""
        reach = np.abs(self.matrix) @ np.full(2, WINDOW_SIZE / 2) + 3 * max(1.0, self.scale)
        first, last = np.floor(self.centre - reach).astype(int), np.ceil(self.centre + reach).astype(int)
        size = self.scene.pixels.shape[:2]
        rows, columns = (_mirrored(np.arange(first[k], last[k] + 1), size[k]) for k in (0, 1))
        light = self.scene.pixels[np.ix_(rows, columns)]
        if step == 1 and self.scale > 1:
            for axis in (0, 1):
                light = gaussian_filter1d(light, PREFILTER * self.scale, axis=axis, truncate=2)
        start = self.centre - first - self.matrix @ np.full(2, WINDOW_SIZE / 2)
        side = (WINDOW_SIZE - 1) // step + 1
        channels = [
            affine_transform(light[:, :, k], self.matrix * step, start, (side, side), order=1, mode="nearest")
            for k in range(3)
        ]
        return np.stack(channels, axis=-1)


def _mirrored(index: np.ndarray, size: int) -> np.ndarray:
    """Return indices folded back into 0 .. size - 1 at both ends."""
    folded = index % (2 * size)
    return np.where(folded < size, folded, 2 * size - 1 - folded)
