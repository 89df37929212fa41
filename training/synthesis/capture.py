"""Photographs that a camera with a known response would have taken, as the product gets them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from crfnet_core.photo import Photo
from training.data.scenes import LUMINANCE, Scene, dithered
from training.evaluation.plan import Condition
from training.synthesis.camera import Capture, blurred, photographed

#: Rows that are exposed at a time, so that the largest photographs fit into memory several times.
ROWS_AT_A_TIME = 512


def synthetic_photo(
    scene: Scene, curve: np.ndarray, exposure: float, rng: np.random.Generator, capture: Capture | None = None
) -> Photo:
    """Return the photograph of a whole scene; without `capture`, only 8-bit quantisation comes after the response.

    Parameters
    ----------
    scene : Scene
        The light.
    curve : ndarray, shape (1024,)
        The response of the camera.
    exposure : float
        Irradiance per unit of the scene's light; 1 clips.
    rng : Generator
        Of dither and noise.
    capture : Capture, optional
        What else happens between the light and the file.
    """
    pixels = dithered(scene.pixels, rng) if scene.is_panorama else scene.pixels
    codes = photographed(pixels * np.float32(exposure), curve, capture or Capture(), rng)
    return _photo(codes, scene.name)


def light_under(condition: Condition, scene: Scene, rng: np.random.Generator) -> np.ndarray:
    """Return the linear light, float32 (H, W, 3), that reaches the sensor under a condition, before exposure."""
    light = dithered(scene.pixels, rng) if scene.is_panorama else scene.pixels
    light = light * balanced_gains(condition.gains)
    if condition.is_gray:
        light = np.repeat((light @ LUMINANCE)[:, :, None], 3, axis=2)
    if condition.blur:
        light = blurred(light, float(np.sqrt(condition.blur)))
    return enlarged(light, condition.upsampling)


def balanced_gains(gains: tuple[float, float, float]) -> np.ndarray:
    """Return gains on red, green and blue, float32 (3,), scaled so that a neutral keeps its luminance."""
    wanted = np.asarray(gains, dtype=np.float32)
    return wanted / (wanted @ LUMINANCE)


def enlarged(light: np.ndarray, times: int) -> np.ndarray:
    """Return linear light enlarged by cubic interpolation, float32 (times H, times W, 3), nowhere negative."""
    if times == 1:
        return light
    size = (light.shape[1] * times, light.shape[0] * times)
    channels = [Image.fromarray(light[:, :, k]).resize(size, Image.Resampling.BICUBIC) for k in range(3)]
    return np.maximum(np.stack([np.asarray(channel) for channel in channels], axis=2), 0)


def taken(
    light: np.ndarray, curve: np.ndarray, exposure: float, condition: Condition, name: str, rng: np.random.Generator
) -> Photo:
    """Return the photograph of the light that `light_under` gave for the same condition.

    Parameters
    ----------
    light : ndarray, float32, shape (H, W, 3)
        Not changed.
    curve : ndarray, shape (1024,)
        The response of the camera.
    exposure : float
        s_crf; the condition's factor comes on top.
    condition : Condition
        For exposure, noise and compression.
    name : str
        Of the photograph.
    rng : Generator
        Of the noise.
    """
    grain, scale = float(np.sqrt(condition.noise)) / 255, np.float32(exposure * condition.factor)
    capture = Capture(grain=grain, jpeg_quality=condition.jpeg_quality)
    rows = len(light) if condition.jpeg_quality else ROWS_AT_A_TIME
    pieces = [photographed(light[y : y + rows] * scale, curve, capture, rng) for y in range(0, len(light), rows)]
    return _photo(np.concatenate(pieces), name, is_gray=condition.is_gray and not condition.noise)


def code_counts(photo: Photo) -> np.ndarray:
    """Return how often each of the 256 code values occurs over all channels, int (256,)."""
    return np.bincount(np.rint(photo.pixels * 255).astype(np.uint8).ravel(), minlength=256)


def _photo(codes: np.ndarray, name: str, *, is_gray: bool = False) -> Photo:
    """Return an 8-bit photograph."""
    return Photo(pixels=codes / np.float32(255), bit_depth=8, is_gray=is_gray, path=Path(name))
