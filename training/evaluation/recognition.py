"""How well footage is recognized: ``python -m training.evaluation.recognition --data DATA [PART ...]``.

log       log footage made of the validation scenes with every published curve: how much is recognized, refused, and
          named right; and stretched, the same with its legal range stretched
real      real photographs: how many are taken for log footage or limited range, which none is
limited   the real photographs stored in limited range, as they are and as JPEG: how much is recognized
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
from crfnet_core.photograph.recognition import Kind, Levels, LogCurve, is_limited_range, light_error, log_curves
from crfnet_core.posterior import Verdict
from crfnet_core.types import Float32Array, Uint8Array
from training.data.real.photographs import real_photographs
from training.data.scenes import Scene, read_scenes
from training.evaluation.measure.real import read_real_photo
from training.synthesis.unusual.encodings import saturated

#: Log footage: stops of the scene's geometric mean beside middle gray, stops of the sensor's clipping above it, the
#: part of colour that is left in wide primaries, the flare of the lens in reflectance, shot and read noise.
EXPOSURE, CLIPPING, SATURATION, FLARE = (-1.2, 1.0), (5.0, 6.7), (0.6, 0.95), (0.0, 0.004)
SHOT_NOISE, READ_NOISE = 2e-5, 3e-4

#: Columns that are cut from a panorama, and the windows of each photograph.
COLUMNS, WINDOWS = 600, 6

#: Quality of JPEG.
QUALITY = 88


def log_picture(scene: Scene, curve: LogCurve, *, is_stretched: bool, rng: np.random.Generator) -> Float32Array:
    """Return log footage of a scene in 8 bits, float32 (H, W, 3): exposed, desaturated, noisy, clipped, encoded."""
    left = int(rng.integers(0, max(1, scene.pixels.shape[1] - COLUMNS)))
    light = scene.pixels[:, left : left + COLUMNS] if scene.is_panorama else scene.pixels
    reflectance = 0.18 * light * np.float32(np.exp2(rng.uniform(*EXPOSURE)))
    reflectance = saturated(reflectance, rng.uniform(*SATURATION)) + np.float32(rng.uniform(*FLARE))
    reflectance = np.minimum(reflectance, 0.18 * np.exp2(rng.uniform(*CLIPPING)))
    deviation = np.sqrt(np.maximum(reflectance, 0) * SHOT_NOISE + READ_NOISE**2)
    codes = curve(reflectance + deviation * rng.standard_normal(reflectance.shape))
    codes = (codes * 1023 - 64) / 876 if is_stretched else codes
    return (np.rint(np.clip(codes, 0, 1) * 255) / 255).astype(np.float32)


def limited(pixels: Float32Array) -> Uint8Array:
    """Return 8-bit codes of limited range, uint8, of a picture in [0, 1]."""
    return np.rint(16 + 219 * pixels).astype(np.uint8)


def compressed(codes: Uint8Array) -> Uint8Array:
    """Return codes after JPEG."""
    buffer = io.BytesIO()
    Image.fromarray(codes).save(buffer, "JPEG", quality=QUALITY)
    return np.asarray(Image.open(buffer))


def print_log_footage(data: Path, network: ResponseNetwork, *, is_stretched: bool) -> None:
    """Print how much log footage is recognized, and how it is named."""
    rng, curves = np.random.default_rng(15), log_curves()
    found, named, among = 0, 0, 0
    first, safest, expected = list[float](), list[float](), list[float]()
    verdicts: list[Verdict] = []
    pictures = [(scene, name) for scene in read_scenes(data / "linear", "validation") for name in curves]
    for scene, name in pictures:
        pixels = log_picture(scene, curves[name], is_stretched=is_stretched, rng=rng)
        estimate = _estimate(Photo(pixels, 8, False, Path(name)), network)
        verdicts.append(estimate.verdict)
        recognition = estimate.recognition
        if recognition is not None and recognition.kind is Kind.LOG_FOOTAGE:
            found += 1
            named += recognition.curves[0] == name
            among += name in recognition.curves
            errors = [light_error(curves[each], curves[name], Levels.of(pixels)) for each in recognition.curves]
            least = int(np.argmin(recognition.errors))
            first.append(errors[0])
            safest.append(errors[least])
            expected.append(recognition.errors[least])
    print(f"log footage, {'legal range stretched' if is_stretched else 'as stored'}: {len(pictures)} pictures")
    print(f"  not to be trusted {verdicts.count(Verdict.DO_NOT_TRUST)}, recognized {found}")
    print(f"  of these named right {named}, among the four named {among}")
    print(f"  error of the curve named first, in stops: median {np.median(first):.2f}, 90 % {_ninety(first):.2f}")
    print(f"  of the safest: median {np.median(safest):.2f}, 90 % {_ninety(safest):.2f}, mean {np.mean(safest):.2f}")
    print(f"  expected of the safest, on average {np.mean(expected):.2f}")


def print_real(data: Path, network: ResponseNetwork) -> None:
    """Print which real photographs are taken for footage, by their pixels alone."""
    estimates = [(name, _estimate(photo, network)) for name, photo in _real(data)]
    print(f"real photographs: {len(estimates)}")
    for name, estimate in estimates:
        if estimate.recognition:
            print(f"  {name}: {estimate.recognition.kind}")
    distrusted = sum(estimate.verdict is Verdict.DO_NOT_TRUST for _, estimate in estimates)
    print(f"  recognized as anything {sum(bool(each.recognition) for _, each in estimates)}; distrusted {distrusted}")


def print_limited(data: Path) -> None:
    """Print how many real photographs are recognized once they are stored in limited range."""
    as_stored, as_jpeg, total = 0, 0, 0
    for _, photo in _real(data):
        codes = limited(photo.pixels)
        as_stored += is_limited_range(Levels.of(_brightness(codes)))
        as_jpeg += is_limited_range(Levels.of(_brightness(compressed(codes))))
        total += 1
    print(f"limited range: {total} photographs, recognized {as_stored}, as JPEG of quality {QUALITY} {as_jpeg}")


def _real(data: Path) -> Iterator[tuple[str, Photo]]:
    """Yield the name of each real photograph, and the photograph."""
    for photographs in real_photographs(data).values():
        for photograph in photographs:
            yield photograph.name, read_real_photo(photograph)


def _estimate(photo: Photo, network: ResponseNetwork) -> ResponseEstimate:
    """Return the estimate of a photograph by its pixels alone."""
    return estimate_response(photo, network=network, options=AnalysisOptions(use_metadata=False, windows=WINDOWS))


def _brightness(codes: Uint8Array) -> Float32Array:
    """Return codes as brightness in [0, 1]."""
    return np.divide(codes, np.float32(255), dtype=np.float32)


def _ninety(errors: list[float]) -> float:
    """Return the error that nine of ten do not exceed."""
    return float(np.percentile(errors, 90))


def main() -> None:
    """Print the figures of the parts that are asked for."""
    parser = argparse.ArgumentParser(prog="python -m training.evaluation.recognition", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="the data folder")
    parser.add_argument("parts", nargs="*", metavar="log|stretched|real|limited", help="what to measure (all)")
    arguments = parser.parse_args()
    parts, network = arguments.parts or ["log", "stretched", "real", "limited"], ResponseNetwork.load()
    if "log" in parts:
        print_log_footage(arguments.data, network, is_stretched=False)
    if "stretched" in parts:
        print_log_footage(arguments.data, network, is_stretched=True)
    if "real" in parts:
        print_real(arguments.data, network)
    if "limited" in parts:
        print_limited(arguments.data)


if __name__ == "__main__":
    main()
