"""Measure how well footage is recognized: ``python -m training.evaluation.recognition --data DATA [PART ...]``.

log       log footage made of the validation scenes with every published curve; stretched, the same with its legal
          range stretched
real      real photographs, none of which is log footage or limited range
limited   the real photographs stored in limited range, as they are and as JPEG
"""

from __future__ import annotations

import argparse
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition import LOG_CURVES, Kind, Levels, LogCurve, is_limited_range, light_error
from crfnet_core.posterior import Verdict
from crfnet_core.types import Float32Array, Uint8Array
from training.data.real.photographs import real_photographs
from training.data.scenes import Scene, read_scenes
from training.evaluation.real import read_real_photo
from training.synthesis.unusual.encodings import saturated

#: Log footage: stops of the scene's geometric mean above middle gray, stops of the sensor's clipping above it, the
#: remaining part of color in wide primaries, the flare of the lens in reflectance, shot and read noise.
EXPOSURE, CLIPPING, SATURATION, FLARE = (-1.2, 1.0), (5.0, 6.7), (0.6, 0.95), (0.0, 0.004)
SHOT_NOISE, READ_NOISE = 2e-5, 3e-4

#: Columns that are cut from a panorama, the windows of each photograph, and the quality of JPEG.
COLUMNS, WINDOWS, QUALITY = 600, 6, 88


def log_picture(scene: Scene, curve: LogCurve, *, is_stretched: bool, rng: np.random.Generator) -> Float32Array:
    """Return log footage of a scene in 8 bits, float32 (H, W, 3): exposed, desaturated, noisy, clipped, encoded."""
    start = int(rng.integers(0, max(1, scene.pixels.shape[1] - COLUMNS)))
    light = scene.pixels[:, start : start + COLUMNS] if scene.is_panorama else scene.pixels
    reflectance = 0.18 * light * np.float32(np.exp2(rng.uniform(*EXPOSURE)))
    reflectance = saturated(reflectance, rng.uniform(*SATURATION)) + np.float32(rng.uniform(*FLARE))
    reflectance = np.minimum(reflectance, 0.18 * np.exp2(rng.uniform(*CLIPPING)))
    deviation = np.sqrt(np.maximum(reflectance, 0) * SHOT_NOISE + READ_NOISE**2)
    codes = curve(reflectance + deviation * rng.standard_normal(reflectance.shape))
    codes = (codes * 1023 - 64) / 876 if is_stretched else codes
    return (np.rint(np.clip(codes, 0, 1) * 255) / 255).astype(np.float32)


def print_log_footage(data: Path, network: ResponseNetwork, *, is_stretched: bool) -> None:
    """Print how much log footage is recognized, and how it is named."""
    rng, curves = np.random.default_rng(15), LOG_CURVES
    pictures, refused, places, errors = 0, 0, list[int](), list[tuple[float, float, float]]()
    for scene in read_scenes(data / "linear", "validation"):
        for name in curves:
            pixels = log_picture(scene, curves[name], is_stretched=is_stretched, rng=rng)
            estimate = _estimate(Photo(pixels, 8, False, Path(name)), network)
            pictures, refused = pictures + 1, refused + (estimate.verdict is Verdict.DO_NOT_TRUST)
            if (recognition := estimate.recognition) is not None and recognition.kind is Kind.LOG_FOOTAGE:
                named = list(recognition.curves)
                places.append(named.index(name) if name in named else len(named))
                off = [light_error(curves[each], curves[name], Levels.from_pixels(pixels)) for each in named]
                safest = int(np.argmin(recognition.errors))
                errors.append((off[0], off[safest], recognition.errors[safest]))
    likeliest, safest_errors, expected = np.array(errors).T
    print(f"log footage, {'legal range stretched' if is_stretched else 'as stored'}: {pictures} pictures")
    print(f"  not to be trusted {refused}, recognized {len(places)}")
    print(f"  of these named right {places.count(0)}, among the four named {sum(place < 4 for place in places)}")
    for title, values in (("the curve named first", likeliest), ("the safest", safest_errors)):
        print(f"  error of {title}, in stops: median {np.median(values):.2f}, 90 % {np.percentile(values, 90):.2f}")
    print(f"  mean of the safest {safest_errors.mean():.2f}, expected {expected.mean():.2f}")


def print_real(data: Path, network: ResponseNetwork) -> None:
    """Print which real photographs are taken for footage, by their pixels alone."""
    estimates = {name: _estimate(photo, network) for name, photo in _real(data)}
    for name, estimate in estimates.items():
        if estimate.recognition:
            print(f"  {name}: {estimate.recognition.kind}")
    distrusted = sum(estimate.verdict is Verdict.DO_NOT_TRUST for estimate in estimates.values())
    print(f"real photographs: {len(estimates)}, not to be trusted {distrusted}")


def print_limited(data: Path) -> None:
    """Print how many real photographs are recognized once they are stored in limited range."""
    codes = [np.rint(16 + 219 * photo.pixels).astype(np.uint8) for _, photo in _real(data)]
    stored, compressed = (sum(_is_limited(each) for each in part) for part in (codes, map(_compressed, codes)))
    print(f"limited range: {len(codes)} photographs, recognized {stored}, as JPEG of quality {QUALITY} {compressed}")


def _compressed(codes: Uint8Array) -> Uint8Array:
    """Return codes after JPEG."""
    buffer = io.BytesIO()
    Image.fromarray(codes).save(buffer, "JPEG", quality=QUALITY)
    return np.asarray(Image.open(buffer))


def _is_limited(codes: Uint8Array) -> bool:
    """Return whether codes are recognized as limited range."""
    return is_limited_range(Levels.from_pixels(np.divide(codes, np.float32(255), dtype=np.float32)))


def _real(data: Path) -> Iterator[tuple[str, Photo]]:
    """Yield the name of each real photograph, and the photograph."""
    for photographs in real_photographs(data).values():
        for photograph in photographs:
            yield photograph.name, read_real_photo(photograph)


def _estimate(photo: Photo, network: ResponseNetwork) -> ResponseEstimate:
    """Return the estimate of a photograph by its pixels alone."""
    return estimate_response(photo, network=network, options=AnalysisOptions(use_metadata=False, windows=WINDOWS))


def main() -> None:
    """Print the figures of the chosen parts."""
    network = ResponseNetwork.load()
    parser = argparse.ArgumentParser(prog="python -m training.evaluation.recognition", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="the data folder")
    parser.add_argument("parts", nargs="*", metavar="log|stretched|real|limited", help="all by default")
    options = parser.parse_args()
    parts = {
        "log": lambda: print_log_footage(options.data, network, is_stretched=False),
        "stretched": lambda: print_log_footage(options.data, network, is_stretched=True),
        "real": lambda: print_real(options.data, network),
        "limited": lambda: print_limited(options.data),
    }
    for name in options.parts or parts:
        parts[name]()


if __name__ == "__main__":
    main()
