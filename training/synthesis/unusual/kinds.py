"""The kinds of pictures that an estimate must refuse, and how each is made of linear light."""

from collections.abc import Callable
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from crfnet_core.photograph.photo import Photo
from crfnet_core.response.curve import UNIFORM
from crfnet_core.types import Float32Array, Uint8Array
from training.data.scenes import Scene, table_rows
from training.synthesis.camera import Capture, sensed, sensor_light, simulate_capture
from training.synthesis.unusual.encodings import limited_range, log_footage, messenger, near_linear
from training.synthesis.unusual.film_scan import film_scan
from training.synthesis.unusual.filters import artistic_filter, false_color, palette, solarized
from training.synthesis.unusual.graphics import line_art, screenshot
from training.synthesis.unusual.tone_mapping import global_tone_mapping, local_tone_mapping
from training.synthesis.unusual.view_transforms import agx, filmic

#: Irradiance, float32 (N, H, W, 3), to encoded pictures, float32 (N, H, W, 3) in [0, 1].
Rendering = Callable[[Float32Array, np.random.Generator], Float32Array]

#: Percentile of the brightest channel that `random_exposure` puts at irradiance 1.
SATURATED = (85, 99.5)


class UnusualKind(StrEnum):
    """Kinds of pictures that no family of camera responses explains, by the name in a report."""

    LOG_FOOTAGE = "log footage"
    NEAR_LINEAR = "near-linear data"
    LIMITED_RANGE = "limited range"
    LOCAL_TONE_MAPPING = "HDR, local tone mapping"
    GLOBAL_TONE_MAPPING = "HDR, global tone mapping"
    SCREENSHOT = "screenshot"
    FILMIC = "rendering, Filmic"
    AGX = "rendering, AgX"
    FILM_SCAN = "film scan"
    MESSENGER = "messenger"
    ARTISTIC_FILTER = "artistic filter"
    SOLARIZED = "solarized or inverted"
    PALETTE = "palette"
    LINE_ART = "line art"
    FALSE_COLOR = "false color"


RENDERINGS: dict[UnusualKind, Rendering] = {
    UnusualKind.LOG_FOOTAGE: log_footage,
    UnusualKind.NEAR_LINEAR: near_linear,
    UnusualKind.LIMITED_RANGE: limited_range,
    UnusualKind.LOCAL_TONE_MAPPING: local_tone_mapping,
    UnusualKind.GLOBAL_TONE_MAPPING: global_tone_mapping,
    UnusualKind.SCREENSHOT: screenshot,
    UnusualKind.FILMIC: filmic,
    UnusualKind.AGX: agx,
    UnusualKind.FILM_SCAN: film_scan,
    UnusualKind.MESSENGER: messenger,
    UnusualKind.ARTISTIC_FILTER: artistic_filter,
    UnusualKind.SOLARIZED: solarized,
    UnusualKind.PALETTE: palette,
    UnusualKind.LINE_ART: line_art,
    UnusualKind.FALSE_COLOR: false_color,
}

#: The table beside this module; it also gives the reason why an estimate of the response of a kind must not be trusted.
_ROWS = table_rows(Path(__file__).with_name("kinds.csv"))

#: The kinds with a sensor's blur and noise before the rendering, and sharpening and grain after it; and the kinds of
#: which a share is compressed as JPEG of random quality at the end.
RECORDED = {row["kind"] for row in _ROWS if row["is_recorded"] == "yes"}
COMPRESSED = {row["kind"] for row in _ROWS if row["is_compressed"] == "yes"}


def unusual_windows(kind: UnusualKind, light: Float32Array, exposure: float, rng: np.random.Generator) -> Uint8Array:
    """Return windows of one picture of a kind, 8 bits, uint8 (N, 227, 227, 3), from windows of linear light.

    The settings of the kind are drawn once for all windows, which may have another size. `exposure` is the irradiance
    per unit of light; irradiance 1 is white, and some kinds hold brighter light.
    """
    capture, irradiance = Capture.draw(rng), light * np.float32(exposure)
    if kind in RECORDED:
        irradiance = np.maximum(sensed(irradiance, capture, rng), 0)
    else:
        capture = replace(capture, sharpening=0.0, grain=0.0)
    if kind not in COMPRESSED:
        capture = Capture()
    after = replace(capture, shot_noise=0.0, read_noise=0.0, blur=0.0)
    return simulate_capture(RENDERINGS[kind](irradiance, rng), UNIFORM, after, rng)


def unusual_photo(kind: UnusualKind, scene: Scene, rng: np.random.Generator) -> Photo:
    """Return a whole frame of a kind at a `random_exposure`, as the estimator reads it from a file."""
    light = sensor_light(scene, rng)
    codes = unusual_windows(kind, light[None], random_exposure(light, rng), rng)[0]
    return Photo.from_array(codes, color_order="RGB", name=f"{kind}, {scene.name}")


def random_exposure(
    light: Float32Array, rng: np.random.Generator, percentiles: tuple[float, float] = SATURATED
) -> float:
    """Return an exposure that puts a random percentile of the brightest channel of linear light at irradiance 1."""
    return 1 / max(float(np.percentile(light[..., ::4, ::4, :].max(axis=-1), rng.uniform(*percentiles))), 1e-6)
