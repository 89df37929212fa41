"""Photographs that a camera with a known response would have taken of a linear scene."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d

from training.data.scenes import LUMINANCE, Scene

#: Mean brightness that automatic exposure aims at.
TARGET_BRIGHTNESS = 0.45

#: Factors on the automatic exposure of a test photograph (CRF-net paper, Sec. 3.3: s_crf +- 0.4).
EXPOSURE_FACTORS = (0.6, 0.8, 1.0, 1.2, 1.4)


@dataclass(frozen=True)
class Capture:
    """What happens between the scene's light and the file; zeros and None leave it out."""

    shot_noise: float = 0.0
    read_noise: float = 0.0
    blur: float = 0.0
    sharpening: float = 0.0
    grain: float = 0.0
    jpeg_quality: int | None = None
    subsampled: bool = True

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Capture:
        """Return the capture of a random camera: most leave some noise and compress."""
        return cls(
            shot_noise=10 ** rng.uniform(-5, -3) if rng.random() < 0.7 else 0.0,
            read_noise=10 ** rng.uniform(-4, -2.3) if rng.random() < 0.7 else 0.0,
            blur=0.4 * 10 ** rng.uniform(0, 1) if rng.random() < 0.3 else 0.0,
            sharpening=rng.uniform(0.1, 0.8) if rng.random() < 0.3 else 0.0,
            grain=rng.uniform(0.3, 2) / 255 if rng.random() < 0.3 else 0.0,
            jpeg_quality=int(rng.integers(45, 99)) if rng.random() < 0.6 else None,
            subsampled=bool(rng.random() < 0.5),
        )


def automatic_exposure(curve: np.ndarray, luminance: np.ndarray) -> float:
    """Return s_crf: the exposure at which scenes of this luminance have the mean brightness `TARGET_BRIGHTNESS`.

    Parameters
    ----------
    curve : ndarray, shape (1024,)
        The response.
    luminance : ndarray, shape (N,)
        Luminances of the training scenes, each scene scaled to a geometric mean of 1; found once, so that s_crf
        belongs to the curve and not to the photograph.
    """
    low, high = -12.0, 6.0
    for _ in range(24):
        middle = (low + high) / 2
        bright = responded(luminance * np.float32(2**middle), curve).mean() > TARGET_BRIGHTNESS
        low, high = (low, middle) if bright else (middle, high)
    return float(2**low)


def reference_luminance(scenes: list[Scene], *, each: int = 64) -> np.ndarray:
    """Return luminances of evenly spread samples of the scenes, for `automatic_exposure`."""
    picks = [(scene.pixels.reshape(-1, 3) @ LUMINANCE) for scene in scenes]
    return np.concatenate([pick[:: max(1, len(pick) // each)][:each] for pick in picks])


def responded(irradiance: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Return brightness of irradiance clipped to [0, 1], float32, linear between the curve's samples."""
    table = curve.astype(np.float32)
    place = np.clip(irradiance, 0, 1) * np.float32(len(table) - 1)
    below = np.minimum(place.astype(np.int32), len(table) - 2)
    return table[below] + (place - below) * (table[below + 1] - table[below])


def photographed(irradiance: np.ndarray, curve: np.ndarray, capture: Capture, rng: np.random.Generator) -> np.ndarray:
    """Return the 8-bit photographs, uint8 (..., H, W, 3), of exposed irradiance (..., H, W, 3)."""
    irradiance = blurred(irradiance, capture.blur) if capture.blur else irradiance
    if capture.shot_noise or capture.read_noise:
        spread = np.sqrt(capture.shot_noise * irradiance + capture.read_noise**2)
        irradiance = irradiance + spread * rng.standard_normal(irradiance.shape, dtype=np.float32)
    brightness = responded(irradiance, curve)
    if capture.sharpening:
        brightness = brightness + capture.sharpening * (brightness - blurred(brightness, 0.8))
    if capture.grain:
        brightness = brightness + capture.grain * rng.standard_normal(brightness.shape, dtype=np.float32)
    codes = np.rint(np.clip(brightness, 0, 1) * 255).astype(np.uint8)
    return codes if capture.jpeg_quality is None else compressed(codes, capture.jpeg_quality, capture.subsampled)


def compressed(codes: np.ndarray, quality: int, subsampled: bool) -> np.ndarray:
    """Return photographs after JPEG compression, uint8 (..., H, W, 3)."""
    if codes.ndim > 3:
        return np.stack([compressed(photograph, quality, subsampled) for photograph in codes])
    file = io.BytesIO()
    Image.fromarray(codes).save(file, "JPEG", quality=quality, subsampling=2 if subsampled else 0)
    return np.asarray(Image.open(file).convert("RGB"))


def blurred(pixels: np.ndarray, sigma: float) -> np.ndarray:
    """Return pixels, shape (..., H, W, 3), under a Gaussian of `sigma` pixels."""
    return gaussian_filter1d(gaussian_filter1d(pixels, sigma, axis=-3, truncate=3), sigma, axis=-2, truncate=3)
