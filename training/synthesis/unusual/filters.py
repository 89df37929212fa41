"""Pictures of a camera changed beyond recognition: artistic filters, solarization, palettes, false color."""

import numpy as np
from PIL import Image
from scipy.interpolate import PchipInterpolator

from crfnet_core.response.curve import UNIFORM
from crfnet_core.types import Float32Array, Float64Array
from training.data.scenes import LUMINANCE
from training.synthesis.camera import apply_response, blurred
from training.synthesis.unusual.encodings import camera_rendering, codes_of, saturated

NODES = np.array([0, 0.25, 0.5, 0.75, 1])  # brightness at which the nodes of a filter's curves lie
PALETTE_SIZE = (32, 128)  # colors of a palette, from a small GIF to a larger one

#: Nodes of false-color palettes, evenly spaced from cold to hot: red, green and blue.
FALSE_COLORS = {
    "iron": ((0, 0, 0), (0.2, 0, 0.5), (0.6, 0, 0.6), (0.9, 0.3, 0.1), (1, 0.75, 0), (1, 1, 0.9)),
    "rainbow": ((0, 0, 0.5), (0, 0.3, 1), (0, 1, 0.8), (0.5, 1, 0), (1, 0.8, 0), (0.8, 0, 0)),
    "violet to yellow": ((0.27, 0, 0.33), (0.25, 0.27, 0.53), (0.13, 0.56, 0.55), (0.45, 0.8, 0.3), (0.99, 0.9, 0.15)),
    "hot": ((0, 0, 0), (0.7, 0, 0), (1, 0.5, 0), (1, 1, 0.2), (1, 1, 1)),
    "cold to hot": ((0.2, 0.3, 0.75), (0.6, 0.75, 1), (0.87, 0.87, 0.87), (0.96, 0.6, 0.48), (0.7, 0, 0.15)),
}


def artistic_filter(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return a camera's pictures under a strong filter: faded, split-toned or cross-processed, a curve per channel."""
    pictures = saturated(camera_rendering(irradiance, rng), rng.uniform(0.3, 1.4))
    curves = (faded, split_toned, cross_processed)[rng.integers(3)](rng)
    return np.stack([apply_response(pictures[..., k], curves[k]) for k in range(3)], axis=-1)


def faded(rng: np.random.Generator) -> Float64Array:
    """Return curves, shape (3, 1024), with a lifted black, a lowered white and little contrast."""
    black, white = rng.uniform(0.1, 0.3), rng.uniform(0.8, 0.97)
    nodes = black + (white - black) * NODES + rng.normal(0, 0.02, (3, 5))
    return _curves(nodes)


def split_toned(rng: np.random.Generator) -> Float64Array:
    """Return curves, shape (3, 1024), that tint shadows with one color and highlights with another."""
    tint, other = rng.uniform(-0.16, 0.16, (2, 3))
    return _curves(
        NODES + tint[:, None] * (1 - NODES) ** 2 * 4 * (NODES + 0.15) + other[:, None] * 4 * NODES**2 * (1 - NODES)
    )


def cross_processed(rng: np.random.Generator) -> Float64Array:
    """Return curves, shape (3, 1024): steep in red and green, flat in blue, as slide film in a wrong bath."""
    bent = np.sin(2 * np.pi * NODES) * rng.uniform(0.06, 0.14, (3, 1))
    nodes = NODES - bent * np.array([[1], [0.8], [-1]])
    nodes[2] = rng.uniform(0.05, 0.2) + nodes[2] * rng.uniform(0.6, 0.8)
    return _curves(nodes[rng.permutation(3)] if rng.random() < 0.25 else nodes)


def _curves(nodes: Float64Array) -> Float64Array:
    """Return monotone curves, shape (3, 1024), through nodes (3, 5), which are put into order and into [0, 1]."""
    ordered = np.clip(np.maximum.accumulate(nodes, axis=1), 0, 1)
    return np.stack([PchipInterpolator(NODES, row)(UNIFORM) for row in ordered])


def solarized(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return a camera's pictures inverted, or solarized: brightness above a threshold falls again."""
    pictures = camera_rendering(irradiance, rng)
    if rng.random() < 0.4:
        return 1 - pictures
    threshold = np.float32(rng.uniform(0.35, 0.7))
    falling = (1 - pictures) / (1 - threshold)
    return np.where(pictures < threshold, pictures / threshold, falling).astype(np.float32)


def palette(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return a camera's pictures in the few colors of one palette, as a GIF stores them, dithered or not."""
    codes = codes_of(camera_rendering(irradiance, rng))
    image = Image.fromarray(codes.reshape(-1, *codes.shape[2:]))  # below one another: they share the palette
    method = Image.Quantize.FASTOCTREE if rng.random() < 0.5 else Image.Quantize.MEDIANCUT
    small = image.resize((image.width // 4, image.height // 4), Image.Resampling.NEAREST)
    chosen = small.quantize(int(rng.integers(*PALETTE_SIZE, endpoint=True)), method=method)
    dither = Image.Dither.FLOYDSTEINBERG if rng.random() < 0.7 else Image.Dither.NONE
    reduced = np.asarray(image.quantize(palette=chosen, dither=dither).convert("RGB"))
    return np.divide(reduced.reshape(codes.shape), np.float32(255), dtype=np.float32)


def false_color(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return the luminance in false colors, on a linear or logarithmic scale, as thermal cameras and plots show it."""
    luminance = np.maximum(irradiance @ LUMINANCE, np.float32(1e-4))
    scale = np.log(luminance) if rng.random() < 0.6 else luminance
    if rng.random() < 0.5:
        scale = blurred(scale[..., None], rng.uniform(0.7, 2.5))[..., 0]
    low, high = np.percentile(scale[:, ::2, ::2], [rng.uniform(0, 5), rng.uniform(95, 100)])
    colors = np.array(FALSE_COLORS[sorted(FALSE_COLORS)[rng.integers(len(FALSE_COLORS))]])
    position = (scale - np.float32(low)) / np.float32(max(high - low, 1e-6))
    nodes = np.linspace(0, 1, len(colors))
    tables = (np.interp(UNIFORM, nodes, colors[:, k]) for k in range(3))
    return np.stack([apply_response(position, table) for table in tables], axis=-1)
