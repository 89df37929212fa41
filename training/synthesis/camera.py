"""The simulated camera: photographs that a camera with a known response would have taken of scene-linear light.

From the scene to the file: `sensor_light` (white balance, defocus, resolution), exposure, noise of the sensor, the
response, sharpening and grain, 8-bit rounding, JPEG (`simulate_capture`). `render_photo` returns the result as the
estimator reads it.
"""

import io
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d

from crfnet_core.photograph.photo import Photo
from crfnet_core.types import Float32Array, Float64Array, IndexArray, Uint8Array
from training.data.scenes import LUMINANCE, Scene, dithered

#: Mean brightness that the automatic exposure aims at.
TARGET_BRIGHTNESS = 0.45

#: Factors on the automatic exposure of a test photograph (CRF-net paper, Table 2).
EXPOSURE_FACTORS = (0.6, 0.8, 1.0, 1.2, 1.4)


@dataclass(frozen=True)
class Capture:
    """The steps from exposed light to the file, apart from the response; zeros and None leave a step out."""

    #: Variance of the noise at irradiance 1, where the sensor clips; it is proportional to the irradiance.
    shot_noise: float = 0.0
    read_noise: float = 0.0  # standard deviation of the noise that does not depend on the irradiance
    blur: float = 0.0  # standard deviation, in samples, of the Gaussian that blurs the irradiance
    sharpening: float = 0.0  # weight of the unsharp mask that is added to the brightness
    grain: float = 0.0  # standard deviation of the Gaussian noise that is added to the brightness, in [0, 1]
    jpeg_quality: int | None = None
    subsampled: bool = True  # whether JPEG keeps the chroma at half resolution (4:2:0) rather than at full (4:4:4)

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Self:
        """Return the capture of a random camera; most have some noise and compress."""
        return cls(
            shot_noise=10 ** rng.uniform(-5, -3) if rng.random() < 0.7 else 0.0,
            read_noise=10 ** rng.uniform(-4, -2.3) if rng.random() < 0.7 else 0.0,
            blur=0.4 * 10 ** rng.uniform(0, 1) if rng.random() < 0.3 else 0.0,
            sharpening=rng.uniform(0.1, 0.8) if rng.random() < 0.3 else 0.0,
            grain=rng.uniform(0.3, 2) / 255 if rng.random() < 0.3 else 0.0,
            jpeg_quality=int(rng.integers(45, 99)) if rng.random() < 0.75 else None,
            subsampled=bool(rng.random() < 0.65),
        )


def automatic_exposure(curve: Float64Array, luminance: Float32Array) -> float:
    """Return s_crf: the exposure at which scenes of this luminance have the mean brightness `TARGET_BRIGHTNESS`.

    `luminance`, (N,), holds samples of the training scenes, each scene scaled to a geometric mean of 1. It is the same
    for every photograph, so s_crf belongs to the response, (1024,), and not to the photograph.
    """
    low, high = -12.0, 6.0
    for _ in range(24):
        middle = (low + high) / 2
        is_bright = apply_response(luminance * np.float32(2**middle), curve).mean() > TARGET_BRIGHTNESS
        low, high = (low, middle) if is_bright else (middle, high)
    return float(2**low)


def reference_luminance(scenes: list[Scene]) -> Float32Array:
    """Return the luminance of 64 evenly spread samples of every scene, for `automatic_exposure`."""
    luminances = [(scene.pixels.reshape(-1, 3) @ LUMINANCE) for scene in scenes]
    return np.concatenate([luminance[:: max(1, len(luminance) // 64)][:64] for luminance in luminances])


def sensor_light(
    scene: Scene,
    rng: np.random.Generator,
    *,
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0),
    is_gray: bool = False,
    blur: float = 0.0,
) -> Float32Array:
    """Return the linear light that reaches the sensor, before exposure, float32 (H, W, 3).

    A panorama is dithered first. `gains` is the white balance (see `balanced_gains`). If `is_gray`, all channels hold
    the luminance. `blur` is the variance of a Gaussian, in squared pixels of the scene.
    """
    light = dithered(scene.pixels, rng) if scene.is_panorama else scene.pixels
    light = light * balanced_gains(gains)
    if is_gray:
        light = np.repeat((light @ LUMINANCE)[:, :, None], 3, axis=2)
    if blur:
        light = blurred(light, float(np.sqrt(blur)))
    return light


def render_photo(
    light: Float32Array,
    curve: Float64Array,
    exposure: float,
    rng: np.random.Generator,
    *,
    name: str,
    capture: Capture | None = None,
) -> Photo:
    """Return the photograph of the light of `sensor_light`, as the estimator reads it from a file.

    `curve`, (1024,), is the response, and `exposure` the irradiance per unit of light; irradiance above 1 clips. By
    default only the response and 8-bit rounding follow.
    """
    codes = simulate_capture(light * np.float32(exposure), curve, capture or Capture(), rng)
    return Photo.from_array(codes, color_order="RGB", name=name)


def simulate_capture(
    irradiance: Float32Array, curve: Float64Array, capture: Capture, rng: np.random.Generator
) -> Uint8Array:
    """Return the 8-bit photographs, uint8 (..., H, W, 3), of exposed irradiance (..., H, W, 3)."""
    brightness = apply_response(sensed(irradiance, capture, rng), curve)
    if capture.sharpening:
        brightness = brightness + capture.sharpening * (brightness - blurred(brightness, 0.8))
    if capture.grain:
        brightness = brightness + capture.grain * rng.standard_normal(brightness.shape, dtype=np.float32)
    codes = np.rint(np.clip(brightness, 0, 1) * 255).astype(np.uint8)
    if capture.jpeg_quality is None:
        return codes
    return jpeg_compressed(codes, quality=capture.jpeg_quality, subsampling=2 if capture.subsampled else 0)


def sensed(irradiance: Float32Array, capture: Capture, rng: np.random.Generator) -> Float32Array:
    """Return irradiance with a capture's blur and the noise of its sensor, not clipped."""
    light = blurred(irradiance, capture.blur) if capture.blur else irradiance
    if capture.shot_noise or capture.read_noise:
        deviation = np.sqrt(capture.shot_noise * light + capture.read_noise**2)
        light = light + deviation * rng.standard_normal(light.shape, dtype=np.float32)
    return light


def apply_response(irradiance: Float32Array, curve: Float64Array) -> Float32Array:
    """Return the brightness f(E) of irradiance clipped to [0, 1], float32, linear between the curve's samples."""
    table = curve.astype(np.float32)
    position = np.clip(irradiance, 0, 1) * np.float32(len(table) - 1)
    below = np.minimum(position.astype(np.int32), len(table) - 2)
    return table[below] + (position - below) * (table[below + 1] - table[below])


def jpeg_compressed(codes: Uint8Array, **options: Any) -> Uint8Array:
    """Return photographs, uint8 (..., H, W, 3), after JPEG compression with Pillow's options."""
    if codes.ndim > 3:
        return np.stack([jpeg_compressed(photograph, **options) for photograph in codes])
    file = io.BytesIO()
    Image.fromarray(codes).save(file, "JPEG", **options)
    return np.asarray(Image.open(file))


def blurred(pixels: Float32Array, sigma: float) -> Float32Array:
    """Return pixels, shape (..., H, W, 3), under a Gaussian of `sigma` pixels."""
    return gaussian_filter1d(gaussian_filter1d(pixels, sigma, axis=-3, truncate=3), sigma, axis=-2, truncate=3)


def balanced_gains(gains: tuple[float, float, float]) -> Float32Array:
    """Return gains on red, green and blue, float32 (3,), scaled so that a neutral keeps its luminance."""
    wanted = np.asarray(gains, dtype=np.float32)
    return wanted / (wanted @ LUMINANCE)


def enlarged(light: Float32Array, times: int) -> Float32Array:
    """Return linear light enlarged by cubic interpolation, float32 (times H, times W, 3), nowhere negative."""
    size = (light.shape[1] * times, light.shape[0] * times)
    channels = [Image.fromarray(light[:, :, k]).resize(size, Image.Resampling.BICUBIC) for k in range(3)]
    return np.maximum(np.stack([np.asarray(channel) for channel in channels], axis=2), 0)


def code_counts(photo: Photo) -> IndexArray:
    """Return how often each of the 256 codes of an 8-bit photograph occurs over all channels, shape (256,)."""
    return np.bincount(np.rint(photo.pixels * 255).astype(np.uint8).ravel(), minlength=256)
