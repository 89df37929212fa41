"""Scene light for tests of footage: surfaces, shadows and highlights with soft edges, and log footage of it."""

import numpy as np

from crfnet_core.photograph.recognition import LOG_CURVES
from crfnet_core.response.transfer_functions import srgb_encode
from tests.helpers.images import write_image


def scene_light(*, seed=0, size=480):
    """Return the reflectance of a scene, float64 (size, size, 3): coloured patches over ten stops, about 0.18."""
    rng = np.random.default_rng(seed)
    light = np.full((size, size, 3), 0.18)
    for _ in range(250):
        (x, y), (width, height) = rng.integers(0, size, 2), rng.integers(10, size // 5, 2)
        color = np.exp(0.25 * rng.standard_normal(3))
        light[y : y + height, x : x + width] = 0.12 * 2 ** rng.normal(0, 1.9) * color
    return blurred(light)


def blurred(light):
    """Return light with soft edges, as a lens gives them."""
    for axis in (0, 1):
        light = (np.roll(light, 1, axis) + 2 * light + np.roll(light, -1, axis)) / 4
    return light


def quantized(brightness, bits=8):
    """Return brightness in [0, 1], rounded to codes."""
    largest = 2**bits - 1
    return (np.rint(np.clip(brightness, 0, 1) * largest) / largest).astype(np.float32)


def log_picture(name):
    """Return log footage of the scene in a published curve, with some noise of the sensor."""
    light = np.minimum(scene_light(), 0.18 * 2**4.8)
    noise = np.random.default_rng(0).standard_normal(light.shape) * np.sqrt(2e-5 * light + 9e-8)
    return quantized(LOG_CURVES[name](light + 0.002 + noise))


def write_picture(path, pixels, **attributes):
    """Write pixels in [0, 1] as 8-bit codes, and return the path."""
    return write_image(path, np.rint(pixels * 255).astype(np.uint8), **attributes)


def ordinary_picture(*, seed=0):
    """Return the scene as a display-referred picture, black at 0 and clipped at white."""
    return quantized(srgb_encode(np.clip(scene_light(seed=seed) * 2.5 - 0.03, 0, 1)))


def limited_range_picture():
    """Return the codes of an ordinary picture, black at 16 and white at 235 as in video, uint8 (480, 480, 3)."""
    return np.rint(16 + 219 * ordinary_picture().astype(np.float64)).astype(np.uint8)
