"""Exposure stacks of known responses, made of scene-linear light: noise, rounding, JPEG, labels that round."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from tests.helpers.images import read_image, write_image

#: Exposure times as cameras write them, a third of a stop apart, and the exact ones in stops.
LABELS = (
    *(1 / 1000, 1 / 800, 1 / 640, 1 / 500, 1 / 400, 1 / 320, 1 / 250, 1 / 200, 1 / 160, 1 / 125, 1 / 100, 1 / 80),
    *(1 / 60, 1 / 50, 1 / 40, 1 / 30, 1 / 25, 1 / 20, 1 / 15, 1 / 13, 1 / 10, 1 / 8, 1 / 6, 1 / 5, 1 / 4, 0.3, 0.4),
    *(0.5, 0.6, 0.8, 1, 1.3, 1.6, 2, 2.5, 3.2, 4, 5, 6, 8, 10, 13, 15),
)


@dataclass(frozen=True, kw_only=True)
class StackOptions:
    """How a stack is taken."""

    frames: int = 8
    step: int = 3  # thirds of a stop between two frames
    brightest: float = 30.0  # percentile of the light that the longest exposure brings to white
    ceiling: float = 0.0  # stops below white at which the brightest frame's light is cut off; 0 for none
    shot_noise: float = 5e-5  # variance at white
    read_noise: float = 1e-3  # standard deviation
    balance: float = 0.0  # standard deviation in stops of red's and blue's gain from frame to frame
    shifts: Sequence[tuple[int, int]] = ()  # rows and columns by which each frame is displaced
    mistimed: Sequence[float] = ()  # stops by which each frame is brighter than labelled
    quality: int = 92  # of the JPEG; 0 writes PNG
    white: float = 1.0  # part of the largest code at which the camera clips
    seed: int = 0


def light_of(path):
    """Return the light of a linear picture, float32 (H, W, 3), without the stretched poles of a panorama."""
    pixels = np.asarray(read_image(path), dtype=np.float32)[..., :3]
    rows = len(pixels)
    return np.maximum(pixels[round(0.1 * rows) : round(0.9 * rows)], 1e-6)


def emor_response(seed):
    """Return a response drawn from EMoR: the weights of two responses of the bank, mixed, and moved at random."""
    rng, bank, emor = np.random.default_rng(seed), ResponseBank.load(), EmorBasis.load()
    weights = bank.weights[bank.ordinary]
    first, second = weights[rng.integers(len(weights), size=2)]
    drawn = first + rng.uniform() * (second - first) + rng.normal(0, 0.05, weights.shape[1])
    return ResponseCurve.from_samples(emor.reconstruct(drawn))


def make_stack(folder, light, response, options, **header):
    """Write the frames of a stack with their EXIF, the darkest first, and return their paths."""
    rng = np.random.default_rng(options.seed)
    stops = np.arange(options.frames) * options.step / 3
    labels = label_seconds(options)
    level = np.percentile(light.max(axis=2), options.brightest)
    gain = np.log2(1 / level) - stops[-1] - options.ceiling
    light = np.minimum(light, level) if options.ceiling else light
    paths = []
    for index, (stop, label) in enumerate(zip(stops, labels, strict=True)):
        balance = np.r_[rng.normal(0, options.balance), 0, rng.normal(0, options.balance)]
        more = options.mistimed[index] if options.mistimed else 0.0
        shift = options.shifts[index] if options.shifts else (0, 0)
        moved = np.roll(light, shift, axis=(0, 1))
        codes = capture(moved * np.exp2(gain + stop + more + balance).astype(np.float32), response, options, rng)
        path = folder / f"stack_{index:02d}.{'jpg' if options.quality else 'png'}"
        quality = {"Compression": f"jpeg:{options.quality}"} if options.quality else {}
        write_image(path, codes, ExposureTime=label, FNumber=8.0, **quality, **header)
        paths.append(path)
    return paths


def label_seconds(options):
    """Return the exposure times that EXIF names."""
    first = max(0, (len(LABELS) - options.frames * options.step) // 2)
    return [float(LABELS[first + index * options.step]) for index in range(options.frames)]


def capture(irradiance, response, options, rng):
    """Return the 8-bit codes of one frame."""
    deviation = np.sqrt(options.shot_noise * irradiance + options.read_noise**2)
    noisy = irradiance + deviation * rng.standard_normal(irradiance.shape, dtype=np.float32)
    return np.rint(response.forward(np.clip(noisy, 0, 1)) * 255 * options.white).astype(np.uint8)


def opencv_response(method, paths, seconds, true):
    """Return the response that OpenCV measures on a stack, by "Debevec" or "Robertson": the mean over the channels.

    OpenCV gives the irradiance of each code in each channel, in no known scale, and its value for code 255 is far
    off. So the logarithms are averaged, and the scale is the one at which the codes 16 to 240 agree best with `true`.
    """
    import cv2

    frames = [np.ascontiguousarray(read_image(path, kind="uint8")[..., :3]) for path in paths]
    measured = getattr(cv2, f"createCalibrate{method}")().process(frames, np.asarray(seconds, dtype=np.float32))
    stops = np.log2(np.maximum(measured.reshape(256, 3), 1e-12)).mean(axis=1)
    is_known = np.isfinite(stops)  # Debevec's is NaN throughout for some stacks
    if not is_known.any():
        raise ValueError(f"OpenCV's {method} gives no numbers")
    stops = np.interp(np.arange(256), np.flatnonzero(is_known), stops[is_known])
    codes = np.arange(16, 241)
    stops += np.mean(np.log2(true.inverse(codes / 255)) - stops[codes])
    irradiance = np.maximum.accumulate(np.exp2(stops))
    irradiance[0] = 0
    samples = np.interp(np.linspace(0, 1, 1024), irradiance + 1e-9 * np.arange(256), np.arange(256) / 255)
    return ResponseCurve.from_samples(np.append(samples[:-1], 1.0))
