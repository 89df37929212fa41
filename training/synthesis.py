"""Photographs that a camera with a known response would have taken of a linear scene."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d

from crfnet_core.windows import WINDOW_SIZE, filled_bins
from training.curves import CurveSource
from training.scenes import LUMINANCE, Scene, dithered

#: Mean brightness that automatic exposure aims at.
TARGET_BRIGHTNESS = 0.45

#: Factors on the automatic exposure of a test photograph (CRF-net paper, Sec. 3.3: s_crf +- 0.4).
EXPOSURE_FACTORS = (0.6, 0.8, 1.0, 1.2, 1.4)

#: Code values a training window holds at least, of 256: a little under the rule, as at run time.
LEAST_FILLED = 200


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
            blur=rng.uniform(0.4, 1.5) if rng.random() < 0.2 else 0.0,
            sharpening=rng.uniform(0.1, 0.8) if rng.random() < 0.3 else 0.0,
            grain=rng.uniform(0.3, 1.5) / 255 if rng.random() < 0.3 else 0.0,
            jpeg_quality=int(rng.integers(60, 99)) if rng.random() < 0.6 else None,
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
    """Return the 8-bit photograph, uint8 (H, W, 3), of exposed irradiance (H, W, 3), which is blurred already."""
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
    """Return the photograph after JPEG compression, uint8 (H, W, 3)."""
    file = io.BytesIO()
    Image.fromarray(codes).save(file, "JPEG", quality=quality, subsampling=2 if subsampled else 0)
    return np.asarray(Image.open(file).convert("RGB"))


def blurred(pixels: np.ndarray, sigma: float) -> np.ndarray:
    """Return (H, W, 3) pixels under a Gaussian of `sigma` pixels."""
    return gaussian_filter1d(gaussian_filter1d(pixels, sigma, axis=0, truncate=3), sigma, axis=1, truncate=3)


@dataclass(frozen=True)
class WindowSource:
    """Draws training windows: a piece of a scene, as seen by several random cameras."""

    scenes: list[Scene]
    curves: CurveSource
    luminance: np.ndarray
    cameras_per_piece: int = 4

    def draw(self, rng: np.random.Generator) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return up to `cameras_per_piece` windows, uint8 (227, 227, 3), with their responses (1024,)."""
        piece = augmented(self._piece(rng), rng)
        drawn = (self._photograph(piece, rng) for _ in range(self.cameras_per_piece))
        return [(window, curve) for window, curve in drawn if filled_bins(window / np.float32(255)) >= LEAST_FILLED]

    def _piece(self, rng: np.random.Generator) -> np.ndarray:
        """Return linear samples (227, 227, 3) from somewhere in a scene, point-sampled where it is large enough."""
        scene = self.scenes[rng.integers(len(self.scenes))]
        height, width = scene.pixels.shape[:2]
        step = int(rng.integers(1, min(height, width) // WINDOW_SIZE + 1))
        extent = (WINDOW_SIZE - 1) * step + 1
        y, x = rng.integers(height - extent + 1), rng.integers(width - extent + 1)
        piece = scene.pixels[y : y + extent : step, x : x + extent : step]
        return dithered(piece, rng) if scene.is_panorama else piece

    def _photograph(self, piece: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
        """Return the window that a random camera makes of the piece, and the camera's response."""
        curve, capture = self.curves.draw(rng), Capture.draw(rng)
        piece = blurred(piece, capture.blur) if capture.blur else piece
        return photographed(piece * np.float32(self._exposure(piece, curve, rng)), curve, capture, rng), curve

    def _exposure(self, piece: np.ndarray, curve: np.ndarray, rng: np.random.Generator) -> float:
        """Return the exposure: around s_crf, or one that puts a high percentile of the piece at saturation."""
        if rng.random() < 0.5:
            return automatic_exposure(curve, self.luminance) * rng.uniform(0.5, 1.6)
        return 1 / max(float(np.percentile(piece[::4, ::4].max(axis=-1), rng.uniform(80, 99.9))), 1e-6)


def augmented(piece: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the piece turned, with another illuminant and other primaries, sometimes without colour."""
    turned = np.rot90(piece, rng.integers(4))
    turned = turned[:, ::-1] if rng.random() < 0.5 else turned
    if rng.random() < 0.06:
        return np.repeat((turned @ LUMINANCE)[:, :, None], 3, axis=2)
    matrix = np.eye(3) + rng.uniform(0, 0.15, (3, 3))
    matrix = matrix / matrix.sum(axis=1, keepdims=True) * np.exp2(rng.normal(0, 0.3, 3))[:, None]
    return turned @ matrix.T.astype(np.float32)
