"""Scans of negative film: density curves and a base tint for each channel, correlated grain, dust."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from PIL import Image, ImageDraw

from crfnet_core.response.curve import UNIFORM
from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array, Float64Array
from training.synthesis.camera import apply_response, blurred

#: Density of the base of red, green and blue (the orange mask), and by how much it varies.
BASE, BASE_DEVIATION = np.array([0.25, 0.55, 0.8]), 0.08

#: Range of density above the base, and the contrast of the middle in density per decade of light.
DENSITY_RANGE, CONTRAST = (1.4, 2.2), (0.5, 0.75)

MIDDLE = (-1.3, -0.6)  # decades between middle density and the light whose white is 1
LEFT_NEGATIVE = 0.2  # fraction of scans that are left negative

#: Standard deviation of the grain in density, and its size in samples.
GRAIN, GRAIN_SIZE = (0.004, 0.03), (0.4, 1.3)

#: Mean number of specks and of hairs on as many samples as a window has.
SPECKS, HAIRS = 2.5, 0.3


@dataclass(frozen=True)
class Negative:
    """A negative film: for red, green and blue the density of the base, the range above it, contrast and speed."""

    base: Float64Array
    density_range: Float64Array
    contrast: Float64Array
    middle: Float64Array

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Self:
        """Return a random film whose layers differ a little, in contrast and in speed."""
        return cls(
            base=BASE + rng.normal(0, BASE_DEVIATION, 3),
            density_range=rng.uniform(*DENSITY_RANGE) * np.exp(rng.normal(0, 0.06, 3)),
            contrast=rng.uniform(*CONTRAST) * np.exp(rng.normal(0, 0.1, 3)),
            middle=rng.uniform(*MIDDLE) + rng.normal(0, 0.1, 3),
        )

    def density(self, irradiance: Float32Array) -> Float32Array:
        """Return density above the base, float32 (..., 3): a logistic function of the logarithm of the light."""
        steepness = (4 * self.contrast / self.density_range).astype(np.float32)
        decades = np.log10(np.maximum(irradiance, np.float32(1e-5))) - self.middle.astype(np.float32)
        return self.density_range.astype(np.float32) / (1 + np.exp(-np.float32(np.log(10)) / 2 * steepness * decades))


def film_scan(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return scans of a negative, most of them inverted; the tint of the base is not removed exactly."""
    film = Negative.draw(rng)
    density = film.density(irradiance)
    density += rng.uniform(*GRAIN) * np.sqrt(np.maximum(density, 0) + np.float32(0.1)) * grain(density.shape, rng)
    dust = np.stack([dust_mask(picture.shape[:2], rng) for picture in density])[..., None]
    if rng.random() < LEFT_NEGATIVE:
        transmitted = 10 ** -(density + (film.base - film.base[0]).astype(np.float32))
        return np.clip(transmitted, 0, 1) ** np.float32(1 / rng.uniform(1.6, 2.4)) * (1 - dust)
    black = rng.normal(0.15, 0.04, 3).astype(np.float32)
    white = (film.density_range * rng.uniform(0.75, 1.0) * np.exp(rng.normal(0, 0.04, 3))).astype(np.float32)
    positive = apply_response((density - black) / (white - black), UNIFORM ** rng.uniform(0.9, 1.8))
    return positive + dust * (1 - positive)


def grain(shape: tuple[int, ...], rng: np.random.Generator) -> Float32Array:
    """Return correlated noise of variance 1, float32 (N, H, W, 3); it is partly common to the three channels."""
    noise = rng.standard_normal(shape, dtype=np.float32)
    common = np.float32(rng.uniform(0, 0.9))
    noise = np.sqrt(1 - common**2) * noise + common * noise[..., :1]
    noise = blurred(noise, rng.uniform(*GRAIN_SIZE))
    return noise / noise[:, ::3, ::3].std()


def dust_mask(size: tuple[int, int], rng: np.random.Generator) -> Float32Array:
    """Return how much dust covers each sample, float32 (H, W) in [0, 1]: specks and hairs."""
    height, width = size
    mask = Image.new("L", (width, height))
    draw = ImageDraw.Draw(mask)
    windows = height * width / WINDOW_SIZE**2
    for _ in range(rng.poisson(SPECKS * windows)):
        x, y, radius = rng.uniform(0, width), rng.uniform(0, height), rng.uniform(0.4, 2.2)
        draw.ellipse(
            (x - radius, y - radius, x + radius * rng.uniform(0.6, 1.5), y + radius), int(rng.integers(90, 256))
        )
    for _ in range(rng.poisson(HAIRS * windows)):
        steps = np.cumsum(rng.normal(0, 0.25, 12))
        path = rng.uniform(0, (width, height)) + np.cumsum(4 * np.stack([np.cos(steps), np.sin(steps)], axis=1), axis=0)
        draw.line([(x, y) for x, y in path.tolist()], int(rng.integers(60, 220)), 1)
    return blurred(np.asarray(mask, np.float32)[..., None] / np.float32(255), 0.6)[..., 0]
