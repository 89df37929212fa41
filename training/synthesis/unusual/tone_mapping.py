"""Tone-mapped pictures of high-dynamic-range light, with local and global operators."""

import numpy as np
from scipy.ndimage import uniform_filter

from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array
from training.data.scenes import LUMINANCE
from training.synthesis.camera import apply_response
from training.synthesis.unusual.encodings import SRGB

DARKEST = np.float32(1e-4)  # least luminance that a tone-mapping operator separates from black
GLOBAL_STOPS = (1.5, 6.0)  # stops that a global operator exposes above the light whose white is 1

#: Percentile of the luminance that an operator takes for the brightest light: single lamps and the sun lie above it.
BRIGHTEST = 99.8

#: Side of the guided filter's box, in samples of a window; the factor on the contrast of the base layer, and on that of
#: the details; the power on the ratios of color. Phones do so too, but far less.
BOX, COMPRESSION, DETAIL, COLOR_POWER = (11, 61), (0.15, 0.45), (1.2, 2.5), (1.0, 1.7)


def local_tone_mapping(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return pictures of a local operator: contrast of the base layer compressed, details kept or raised.

    After Durand and Dorsey, "Fast Bilateral Filtering for the Display of High-Dynamic-Range Images" (2002), with the
    guided filter of He, Sun and Tang (2013) in the place of the bilateral one. Color ratios are raised to a power.
    """
    luminance = np.maximum(irradiance @ LUMINANCE, DARKEST)
    stops = np.log2(luminance)
    scale = min(irradiance.shape[1:3]) / WINDOW_SIZE
    base = guided_base(stops, max(3, int(rng.integers(*BOX) * scale)), float(np.exp(rng.uniform(*np.log((0.05, 2))))))
    mapped = rng.uniform(*COMPRESSION) * base + rng.uniform(*DETAIL) * (stops - base)
    mapped = np.exp2(mapped - np.float32(np.percentile(mapped, rng.uniform(98, 99.9))))
    return _recolored(irradiance, luminance, mapped, rng.uniform(*COLOR_POWER))


def guided_base(stops: Float32Array, box: int, variance: float) -> Float32Array:
    """Return the base layer of pictures (N, H, W): smooth, but with the edges whose variance exceeds `variance`."""
    size = (0, box, box)
    mean = uniform_filter(stops, size)
    local = np.maximum(uniform_filter(stops * stops, size) - mean * mean, 0)
    slope = local / (local + np.float32(variance))
    return uniform_filter(slope, size) * stops + uniform_filter(mean - slope * mean, size)


def global_tone_mapping(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return pictures of a global operator on the luminance of light exposed for the shadows.

    One half is Reinhard et al., "Photographic Tone Reproduction for Digital Images" (2002), Eq. 4; the other Drago et
    al., "Adaptive Logarithmic Mapping For Displaying High Contrast Scenes" (2003), Eq. 4.
    """
    exposed = irradiance * np.float32(np.exp2(rng.uniform(*GLOBAL_STOPS)))
    luminance = np.maximum(exposed @ LUMINANCE, DARKEST)
    white = max(float(np.percentile(luminance, BRIGHTEST)), 1.0)
    mapped = reinhard(luminance, white) if rng.random() < 0.5 else drago(luminance, white, rng.uniform(0.65, 0.9))
    return _recolored(exposed, luminance, mapped, rng.uniform(0.6, 1.2))


def reinhard(luminance: Float32Array, white: float) -> Float32Array:
    """Return L (1 + L / white^2) / (1 + L): 1 where the luminance is `white`."""
    return (luminance * (1 + luminance / white**2) / (1 + luminance)).astype(np.float32)


def drago(luminance: Float32Array, white: float, bias: float) -> Float32Array:
    """Return the adaptive logarithm of luminance: 1 where it is `white`."""
    base = 2 + 8 * (luminance / np.float32(white)) ** np.float32(np.log(bias) / np.log(0.5))
    return (np.log1p(luminance) / np.log(base) / np.log10(white + 1)).astype(np.float32)


def _recolored(light: Float32Array, luminance: Float32Array, mapped: Float32Array, power: float) -> Float32Array:
    """Return the sRGB encoding of mapped luminance in the light's colors, their ratios raised to a power."""
    ratios = (np.maximum(light, 0) / luminance[..., None]) ** np.float32(power)
    return apply_response((ratios * mapped[..., None]).astype(np.float32, copy=False), SRGB)
