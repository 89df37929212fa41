"""Encodings that are no response of a camera: log, near-linear and limited range, and what messengers send.

In this package a rendering takes irradiance, float32 (N, H, W, 3), 1 = white and not clipped, and returns the encoded
pictures, float32 (N, H, W, 3) in [0, 1]; it draws its settings once for all N.
"""

import numpy as np
from PIL import Image

from crfnet_core.photograph.recognition import LOG_CURVES
from crfnet_core.response.curve import UNIFORM
from crfnet_core.response.transfer_functions import srgb_encode
from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array, Float64Array, Uint8Array
from training.data.scenes import LUMINANCE
from training.synthesis.camera import apply_response, enlarged, jpeg_compressed
from training.synthesis.demo_plate import camera_response

SRGB = srgb_encode(UNIFORM)  # the sRGB encoding as a response, at 1024 irradiances
POWERS = (0.85, 1.15)  # powers on the irradiance of near-linear data
TABLE = 2**14  # entries of a table from irradiance to codes: sixteen for each sample of a response

#: Range of the roll-off of highlights (1 is none), and of the weight of the S-curve, in the rendering of a camera.
ROLL_OFF, CONTRAST = (1.0, 3.5), (0.4, 1.0)

#: The log curves that the packaged models have seen, sorted; more would change the pictures that a seed draws.
TRAINING_CURVES = (
    "ARRI LogC3",
    "Apple Log",
    "Canon Log 3",
    "DJI D-Log",
    "Fujifilm F-Log",
    "Fujifilm F-Log2",
    "Nikon N-Log",
    "Panasonic V-Log",
    "RED Log3G10",
    "Sony S-Log3",
)

#: Stops that log footage is exposed above light whose white is 1, and the part of its color that wide primaries
#: take away.
LOG_STOPS, WIDE_GAMUT = (-1.0, 2.5), (0.05, 0.3)

#: Fraction of log footage whose code values 64 to 940 of 1023 were stretched to the whole range when it was decoded.
STRETCHED = 0.3

#: How many times the light is enlarged for a messenger, how many pixels along each side it then averages to one, and
#: its JPEG qualities.
ENLARGED, SCALED_BY, MESSENGER_QUALITY = 2, (2, 3, 4), (60, 75)


def log_footage(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return log footage in a maker's curve and wide primaries, as stored or with its legal range stretched."""
    curve = LOG_CURVES[TRAINING_CURVES[rng.integers(len(TRAINING_CURVES))]]
    exposed = irradiance * np.float32(np.exp2(rng.uniform(*LOG_STOPS)))
    encoded = curve(saturated(exposed, 1 - rng.uniform(*WIDE_GAMUT)))
    if rng.random() < STRETCHED:
        encoded = (encoded * 1023 - 64) / 876
    return np.clip(encoded, 0, 1).astype(np.float32)


def near_linear(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return irradiance to a power near 1: data that nobody encoded."""
    return apply_response(irradiance, UNIFORM ** rng.uniform(*POWERS))


def limited_range(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return a camera's picture in the codes 16 to 235 of video, stored as if they were 0 to 255."""
    return (np.float32(16) + np.float32(219) * camera_rendering(irradiance, rng)) / np.float32(255)


def messenger(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return a camera's picture, averaged down after its encoding and twice compressed at a low quality.

    The light is enlarged first, so that its pixels are as soft as in a large photograph. A picture that gets
    smaller than a window is continued by its mirror image to the size of a window.
    """
    times, curve = int(rng.choice(SCALED_BY)), drawn_camera_curve(rng)
    pictures = (Image.fromarray(encoded_codes(enlarged(light, ENLARGED), curve)) for light in irradiance)
    sent = np.stack([np.asarray(picture.reduce(times)) for picture in pictures])
    lacking = [(0, max(0, WINDOW_SIZE - side)) for side in sent.shape[1:3]]
    sent = np.pad(sent, [(0, 0), *lacking, (0, 0)], mode="symmetric")
    for quality in rng.integers(*MESSENGER_QUALITY, size=2, endpoint=True):
        sent = jpeg_compressed(sent, quality=int(quality), subsampling=2)
    return np.divide(sent, np.float32(255), dtype=np.float32)


def encoded_codes(irradiance: Float32Array, curve: Float64Array) -> Uint8Array:
    """Return the 8-bit codes of irradiance under a response, by nearest entry: quicker than `apply_response`."""
    table = codes_of(np.interp(np.linspace(0, 1, TABLE), UNIFORM, curve).astype(np.float32))
    return table[(np.clip(irradiance, 0, 1) * np.float32(TABLE - 1) + np.float32(0.5)).astype(np.uint16)]


def camera_rendering(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return the ordinary picture of a camera, which other programs then change."""
    return apply_response(irradiance, drawn_camera_curve(rng))


def drawn_camera_curve(rng: np.random.Generator) -> Float64Array:
    """Return the response of a random ordinary camera, shape (1024,), by formula: it shows nothing of test cameras."""
    return camera_response(UNIFORM, rng.uniform(*ROLL_OFF), rng.uniform(*CONTRAST))


def saturated(pixels: Float32Array, factor: float) -> Float32Array:
    """Return pixels (..., 3) whose distance from their luminance is multiplied by a factor; it may leave [0, 1]."""
    luminance = (pixels @ LUMINANCE)[..., None]
    return (luminance + np.float32(factor) * (pixels - luminance)).astype(np.float32, copy=False)


def codes_of(encoded: Float32Array) -> Uint8Array:
    """Return the 8-bit codes of encoded pictures, of the same shape."""
    return np.rint(np.clip(encoded, 0, 1) * np.float32(255)).astype(np.uint8)
