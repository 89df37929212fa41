"""The sensor of a camera: noise, clipping of its channels, mosaic and demosaicing, and the color matrix.

Pictures are three planes, red, green and blue, each float32 (N, S, S), of N frames.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import cache

import numpy as np

from crfnet_core.types import Float32Array, Float64Array
from training.data.scenes import LUMINANCE

#: Planes of red, green and blue, each float32 (N, S, S).
Planes = list[Float32Array]

#: The sites of a mosaic: red, green in red's rows, green in blue's rows and blue; channel and place of each.
SITES = ((0, np.s_[:, ::2, ::2]), (1, np.s_[:, ::2, 1::2]), (1, np.s_[:, 1::2, ::2]), (2, np.s_[:, 1::2, 1::2]))

#: Samples of noise that are drawn once; a photograph takes a part of them, from a random one on. To draw them anew
#: would take longer than everything else that the sensor does.
NOISE_SAMPLES = 1 << 22


class Demosaicing(StrEnum):
    """How a color is found where the sensor did not measure it: from its neighbors, or with the other channels."""

    BILINEAR = "bilinear"
    GRADIENT_CORRECTED = "gradient-corrected"


@dataclass(frozen=True)
class Sensor:
    """A sensor and what is done to its values before the tone curve; the defaults leave every step out."""

    shot_noise: float = 0.0  # variance of the noise at irradiance 1 and gain 1; it is proportional to the irradiance
    read_noise: float = 0.0  # standard deviation of the noise that does not depend on the irradiance, at gain 1
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)  # white balance, which multiplies the noise, too
    white: float = np.inf  # irradiance at which a channel of gain 1 clips; the response ends at 1
    clips_apart: bool = False  # whether each channel clips at its gain times `white`, rather than all at `white`
    crosstalk: float = 0.0  # part of each channel, in [0, 1), that is the mean of all; the matrix takes it out again
    saturation: float = 1.0  # factor on the distance of a color from its luminance; above 1, saturated colors clip
    demosaicing: Demosaicing | None = None  # None for a sensor that measures all colors everywhere

    def record(self, irradiance: Planes, rng: np.random.Generator) -> Planes:
        """Return the irradiance that the tone curve gets, nowhere negative; the planes given are not changed."""
        mixing = (1 - self.crosstalk) * np.eye(3) + self.crosstalk / 3
        planes = mixed(irradiance, mixing)
        if self.demosaicing is None:
            planes = [self._read(plane, channel, rng) for channel, plane in enumerate(planes)]
        else:
            mosaic = np.empty_like(planes[0])
            for channel, site in SITES:
                mosaic[site] = self._read(planes[channel][site], channel, rng)
            planes = demosaiced(mosaic, self.demosaicing)
        luminance = np.broadcast_to(LUMINANCE.astype(np.float64), (3, 3))
        matrix = (self.saturation * np.eye(3) + (1 - self.saturation) * luminance) @ np.linalg.inv(mixing)
        return [np.maximum(plane, 0, out=plane) for plane in mixed(planes, matrix)]

    def _read(self, values: Float32Array, channel: int, rng: np.random.Generator) -> Float32Array:
        """Return one channel with noise, clipped."""
        gain = np.float32(self.gains[channel])
        if self.shot_noise or self.read_noise:
            variance = values * np.float32(self.shot_noise * gain) + (self.read_noise * gain) ** 2
            values = values + np.sqrt(variance, out=variance) * noise(values.shape, rng)
        return np.minimum(values, self.white * (gain if self.clips_apart else 1))


def mixed(planes: Planes, matrix: Float64Array) -> Planes:
    """Return planes with the colors matrix @ (red, green, blue); new ones."""
    rows = matrix.astype(np.float32)
    return [row[0] * planes[0] + row[1] * planes[1] + row[2] * planes[2] for row in rows]


def demosaiced(mosaic: Float32Array, method: Demosaicing) -> Planes:
    """Return the planes of a mosaic (N, S, S) of red at even rows and columns, blue at odd ones, green elsewhere."""
    padded = np.pad(mosaic, ((0, 0), (2, 2), (2, 2)), mode="reflect")  # keeps which rows and columns are even
    near = (padded[:, 1:-3, 2:-2] + padded[:, 3:-1, 2:-2] + padded[:, 2:-2, 1:-3] + padded[:, 2:-2, 3:-1]) / 4
    if method is Demosaicing.GRADIENT_CORRECTED:
        far = (padded[:, :-4, 2:-2] + padded[:, 4:, 2:-2] + padded[:, 2:-2, :-4] + padded[:, 2:-2, 4:]) / 4
        near += (mosaic - far) / 2
    green = mosaic.copy()
    for start in (0, 1):
        green[:, start::2, start::2] = near[:, start::2, start::2]
    if method is Demosaicing.BILINEAR:
        return [_filled(mosaic, 0), green, _filled(mosaic, 1)]
    difference = mosaic - green
    return [_filled(difference, 0) + green, green, _filled(difference, 1) + green]


def noise(shape: tuple[int, ...], rng: np.random.Generator) -> Float32Array:
    """Return normal deviates of variance 1, float32, not to be changed: a random part of those drawn once."""
    drawn, size = _normal_deviates(), int(np.prod(shape))
    start = int(rng.integers(len(drawn) - size + 1))
    return drawn[start : start + size].reshape(shape)


@cache
def _normal_deviates() -> Float32Array:
    """Return normal deviates, float32 (NOISE_SAMPLES,)."""
    return np.random.default_rng(0).standard_normal(NOISE_SAMPLES, dtype=np.float32)


def _filled(mosaic: Float32Array, first: int) -> Float32Array:
    """Return a plane from its samples at rows and columns `first`, `first` + 2, ...: means of the nearest ones."""
    height, width = mosaic.shape[1:]
    columns = _interleaved(mosaic[:, first::2, first::2], first, width)
    return _interleaved(columns.swapaxes(1, 2), first, height).swapaxes(1, 2)


def _interleaved(samples: Float32Array, first: int, size: int) -> Float32Array:
    """Return `size` columns: `samples` (N, H, W) at `first`, `first` + 2, ..., and the means of neighbors between."""
    padded = np.pad(samples, ((0, 0), (0, 0), (1, 1)), mode="edge")
    means = (padded[..., :-1] + padded[..., 1:]) / 2
    columns = np.empty((*samples.shape[:2], size), np.float32)
    columns[..., first::2] = samples
    other = columns[..., 1 - first :: 2]
    other[:] = means[..., 1 - first :][..., : other.shape[-1]]
    return columns
