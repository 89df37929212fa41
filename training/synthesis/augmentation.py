"""Augmentation: other light, colors and compositions for the linear windows of the few scenes that there are."""

import numpy as np
from scipy.ndimage import gaussian_filter

from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array
from training.data.scenes import LUMINANCE
from training.synthesis.picture import box_blurred, resized

#: Fractions of photographs: without color, under an illumination gradient, and with a power law on the irradiance.
GRAY, GRADIENT, POWER = 0.25, 0.3, 0.3

#: Range of the standard deviation of the logarithm of the luminance up to which texture is taken out.
TEXTURE = (0.05, 0.7)


def recolor(light: Float32Array, rng: np.random.Generator, *, cast: float = 0.4) -> Float32Array:
    """Return windows (N, S, S, 3) rotated and mirrored alike, under another illuminant and with other primaries.

    A fraction `GRAY` of them loses all color instead. The illuminant's gains on the channels have a standard deviation
    of `cast` stops.
    """
    turned = np.rot90(light, int(rng.integers(4)), axes=(1, 2))
    turned = turned[:, :, ::-1] if rng.random() < 0.5 else turned
    if rng.random() < GRAY:
        return np.repeat((turned @ LUMINANCE)[..., None], 3, axis=-1)
    matrix = np.eye(3) + rng.uniform(0, 0.15, (3, 3))
    matrix = matrix / matrix.sum(axis=1, keepdims=True) * np.exp2(rng.normal(0, cast, 3))[:, None]
    return turned @ matrix.T.astype(np.float32)


def relight(light: Float32Array, rng: np.random.Generator, *, contrasted: float, contrast: float) -> Float32Array:
    """Return windows (N, S, S, 3), float32, some under a smooth illumination gradient, some with other contrast.

    A power law changes how light mixes at edges, which the network measures, so it stays near 1. Contrast at large
    scale leaves edges as they are: a fraction `contrasted` has a factor on it, whose mean logarithm is `contrast`.
    """
    if rng.random() < GRADIENT:
        light = light * illumination_gradient(len(light), rng, side=light.shape[1])
    if rng.random() < contrasted:
        light = light * contrast_gain(light, rng, mean=contrast)
    if rng.random() < POWER:
        light = np.maximum(light, 0) ** np.float32(np.exp(rng.normal(0, 0.12)))
    return np.ascontiguousarray(light, dtype=np.float32)


def illumination_gradient(count: int, rng: np.random.Generator, *, side: int) -> Float32Array:
    """Return smooth gains around 1, shape (count, side, side, 1): one wave across each window, of up to 2 stops."""
    position = np.linspace(0, 1, side, dtype=np.float32)
    angle, phase = rng.uniform(0, 2 * np.pi, (2, count, 1, 1)).astype(np.float32)
    across = np.cos(angle) * position[:, None] + np.sin(angle) * position[None, :]  # (count, side, side)
    height, frequency = rng.uniform((0.2, 1), (2, 5), (count, 2)).astype(np.float32).T[:, :, None, None]
    return np.exp2(height * np.sin(frequency * across + phase))[..., None]


def contrast_gain(light: Float32Array, rng: np.random.Generator, *, mean: float) -> Float32Array:
    """Return smooth gains, shape (N, S, S, 1), that raise or lower the large-scale contrast of windows."""
    log_luminance = np.log(np.maximum(light[:, ::4, ::4] @ LUMINANCE, 1e-6))  # (N, C, C)
    radius = rng.uniform(2, 10) * light.shape[1] / WINDOW_SIZE
    coarse = gaussian_filter(log_luminance, (0, radius, radius))
    smooth = resized(coarse - coarse.mean(), light.shape[1])
    return np.exp(np.float32(np.exp(rng.normal(mean, 0.35)) - 1) * smooth)[..., None]


def defocused(light: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return windows (N, S, S, 3) with parts out of focus, as photographs have them; panoramas are sharp everywhere."""
    size = 2 * int(rng.integers(1, 6) * light.shape[1] / WINDOW_SIZE) + 1
    soft = np.stack([box_blurred(box_blurred(light[..., channel], size), size) for channel in range(3)], axis=-1)
    stops = np.log2(illumination_gradient(len(light), rng, side=light.shape[1]))
    share = np.clip(0.5 + 4 * stops + np.float32(rng.uniform(-1, 1)), 0, 1)
    return light + share * (soft - light)


def untextured(light: Float32Array, rng: np.random.Generator, *, reach: tuple[float, float]) -> Float32Array:
    """Return windows (N, S, S, 3) with weaker texture, as of walls and skies, and the same edges.

    A gain takes out the variation of the log luminance where its standard deviation in a neighborhood is below a random
    one (the local filter of Lee, 1980). `reach` is the neighborhood's, in 227ths of the side.
    """
    size = 2 * int(rng.uniform(*reach) * light.shape[1] / WINDOW_SIZE) + 1
    variance = np.float32(np.exp(rng.uniform(*np.log(TEXTURE))) ** 2)
    logarithm = np.log(np.maximum(light @ LUMINANCE, 1e-6))  # (N, S, S)
    mean = box_blurred(logarithm, size)
    local = np.maximum(box_blurred(logarithm**2, size) - mean**2, 0)
    gain = np.exp(variance / (variance + local) * (mean - logarithm))
    return light * gain[..., None]


def composited(light: Float32Array, other: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return windows (N, S, S, 3) of which one side of a straight border shows `other` at another exposure.

    A sample on the border mixes the light of both sides, as in a photograph.
    """
    exposure = np.float32(np.exp2(rng.normal(0, 1.2)))
    side = light.shape[1]
    position = np.arange(side, dtype=np.float32) - side / 2
    angle = rng.uniform(0, 2 * np.pi, (len(light), 1, 1))
    distance = rng.uniform(-60, 60, (len(light), 1, 1)) * side / WINDOW_SIZE
    beyond = np.cos(angle) * position[:, None] + np.sin(angle) * position[None, :] - distance
    coverage = np.clip(beyond + 0.5, 0, 1)[..., None].astype(np.float32)
    return light * (1 - coverage) + other * exposure * coverage
