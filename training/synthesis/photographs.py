"""Training photographs: windows of a scene as random cameras would have recorded them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from crfnet_core.response.curve import UNIFORM
from crfnet_core.statistics.windows import WINDOW_SIZE, filled_bins, filled_codes
from crfnet_core.types import Float32Array, Float64Array, IndexArray, Uint8Array
from training.data.curves import DrawResponse
from training.data.scenes import Scene, dithered
from training.synthesis.augmentation import composited, defocused, recolor, relight, untextured
from training.synthesis.camera import Capture, automatic_exposure, simulate_capture
from training.synthesis.camera_draws import KIND_FRACTIONS, WINDOWS, FrameKind, Frames, draw_development
from training.synthesis.development import develop, is_gray
from training.synthesis.resampling import THUMBNAIL_STEP, AffineResampling
from training.synthesis.unusual import UnusualKind, random_exposure, unusual_windows

#: Cameras that take the same windows of a scene, and windows drawn for each that is taken, by the codes that they fill.
CAMERAS, TRIED = 3, 2

LEAST_FILLED = 120  # codes, of 256, that the best window of a training photograph fills at least
FOLDS = 3  # each photograph uses scenes of one of so many folds; training uses all of them
DEFOCUSED = 0.35  # fraction of the photographs of cameras that develop in which parts are out of focus

#: Fractions of photographs: half of the windows show another scene; windows are resampled at any angle and scale; two
#: scenes are composited in every window; only the response and 8-bit rounding lie between the light and the file.
TWO_SCENES, RESAMPLED, COMPOSITED, CLEAN = 0.25, 0.35, 0.15, 0.15

#: Fraction of the photographs in which texture is weaker, by kind, and how far it is looked for around a sample: in
#: frames as they are, and in those that are point-sampled, which show more of the scene.
UNTEXTURED = {FrameKind.PLAIN: 0.0, FrameKind.NATIVE: 0.0, FrameKind.SAMPLED: 0.4, FrameKind.SCALED: 0.3}
REACH = ((2, 8), (2, 12))

#: Fraction of the plain captures of a scene without color whose file has none either: its channels are equal, also
#: where noise would have made them differ. Cameras that develop always write such files.
ONE_CHANNEL = 0.7

#: Standard deviation, in stops, of the gains of the illuminant: of plain captures, and of cameras that balance white.
CASTS = (0.4, 0.12)

#: Fraction with another large-scale contrast, and the mean logarithm of the factor on it: of plain captures, and of
#: cameras that develop.
CONTRASTS = ((0.2, 0.0), (0.5, 0.25))

#: Fraction of photographs exposed by the automatic exposure; the others put a percentile of the windows at saturation.
AUTOMATIC = 0.6

#: Ranges of the factor on the automatic exposure, and of the percentile: of plain captures, then of cameras that
#: develop, which leave more light unclipped.
FACTORS = ((0.5, 1.6), (0.25, 1.2))
SATURATED = ((80, 99.9), (90, 99.95))


@dataclass(frozen=True)
class TrainingPhotograph:
    """Windows of one photograph and the truth about it."""

    windows: Uint8Array  # uint8 (4, 227, 227, 3): code values
    curve: Float64Array  # (1024,): the response, of this number in the source's `curve_sets`
    curve_set: int


@dataclass(frozen=True)
class PhotographSource:
    """Draws training photographs."""

    scenes: list[Scene]  # the scenes of one split
    curve_sets: tuple[DrawResponse, ...]  # responses, in sets of which a training run may leave some out
    fractions: tuple[float, ...]  # fraction of the photographs with each set; their sum is 1
    luminance: Float32Array  # (N,): see `training.synthesis.camera.automatic_exposure`
    #: Number of a set -> kinds of pictures that no response explains, in place of photographs with its responses.
    unusual: Mapping[int, tuple[UnusualKind, ...]] = field(default_factory=dict)

    def draw(self, rng: np.random.Generator) -> list[TrainingPhotograph]:
        """Return up to `CAMERAS` photographs of the same windows."""
        fold = int(rng.integers(min(FOLDS, len(self.scenes))))
        kind = list(KIND_FRACTIONS)[rng.choice(len(KIND_FRACTIONS), p=list(KIND_FRACTIONS.values()))]
        frames = Frames.draw(kind, rng)
        light = self._light(self.scenes[fold::FOLDS], frames, rng)
        develops = kind is not FrameKind.PLAIN
        if rng.random() < UNTEXTURED[kind]:
            light = untextured(light, rng, reach=REACH[kind is FrameKind.SAMPLED])
        if develops and rng.random() < DEFOCUSED:
            light = defocused(light, rng)
        contrasted, contrast = CONTRASTS[develops]
        light = recolor(light, rng, cast=CASTS[develops])
        light = relight(light, rng, contrasted=contrasted, contrast=contrast)
        drawn = (self._photograph(light, kind, rng) for _ in range(CAMERAS))
        return [
            photo
            for photo in drawn
            if photo.curve_set in self.unusual or max(map(filled_codes, photo.windows)) >= LEAST_FILLED
        ]

    def draw_curve(self, rng: np.random.Generator) -> tuple[Float64Array, int]:
        """Return a response, shape (1024,), and the number of its set."""
        chosen = int(rng.choice(len(self.fractions), p=self.fractions))
        return self.curve_sets[chosen](rng), chosen

    def _light(self, scenes: list[Scene], frames: Frames, rng: np.random.Generator) -> Float32Array:
        """Return the linear light of frames, (count, side, side, 3), of one, two or three of the scenes."""
        count, side = frames.count, frames.side
        first, second = (scenes[i] for i in rng.integers(len(scenes), size=2))
        if rng.random() > TWO_SCENES or count == 1:
            light = _scene_windows(first, count, side, rng)
        else:
            light = np.concatenate([_scene_windows(scene, count // 2, side, rng) for scene in (first, second)])
        if rng.random() < COMPOSITED:
            light = composited(light, _scene_windows(scenes[rng.integers(len(scenes))], count, side, rng), rng)
        return light

    def _photograph(self, light: Float32Array, kind: FrameKind, rng: np.random.Generator) -> TrainingPhotograph:
        """Return the windows as a random camera records them."""
        curve, chosen = self.draw_curve(rng)
        if chosen in self.unusual:
            return _unusual_photograph(light, self.unusual[chosen], chosen, rng)
        irradiance = light * np.float32(self._exposure(light, curve, kind, rng))
        if kind is FrameKind.PLAIN:
            capture = Capture() if rng.random() < CLEAN else Capture.draw(rng)
            windows = simulate_capture(irradiance, curve, capture, rng)
            if is_gray(light) and rng.random() < ONE_CHANNEL:
                windows = np.repeat(windows[..., 1:2], 3, axis=-1)
        else:
            windows = develop(irradiance, curve, draw_development(kind, rng), rng, windows=WINDOWS)
        return TrainingPhotograph(windows, curve, chosen)

    def _exposure(self, light: Float32Array, curve: Float64Array, kind: FrameKind, rng: np.random.Generator) -> float:
        """Return the exposure: a random factor times s_crf, or one that saturates a high percentile of the windows."""
        develops = kind is not FrameKind.PLAIN
        if rng.random() < AUTOMATIC:
            return automatic_exposure(curve, self.luminance) * rng.uniform(*FACTORS[develops])
        return random_exposure(light, rng, SATURATED[develops])


def _unusual_photograph(
    light: Float32Array, kinds: Sequence[UnusualKind], curve_set: int, rng: np.random.Generator
) -> TrainingPhotograph:
    """Return windows of a picture of one of the kinds; the response is a mere stand-in, the identity."""
    windows = _parts(light, rng)
    kind = kinds[int(rng.integers(len(kinds)))]
    codes = unusual_windows(kind, windows, random_exposure(windows, rng), rng)
    return TrainingPhotograph(codes, UNIFORM, curve_set)


def _parts(light: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return four windows, (4, 227, 227, 3), of frames (count, side, side, 3): cut out, or point-sampled."""
    count, side = light.shape[:2]
    step = int(rng.integers(1, side // WINDOW_SIZE + 1))
    room = side - (WINDOW_SIZE - 1) * step
    corners = rng.integers(room, size=(WINDOWS, 2))
    reach = (WINDOW_SIZE - 1) * step + 1
    parts = [light[n % count, y : y + reach : step, x : x + reach : step] for n, (y, x) in enumerate(corners)]
    return np.stack(parts)


def _scene_windows(scene: Scene, count: int, side: int, rng: np.random.Generator) -> Float32Array:
    """Return `count` linear windows of a scene: of twice as many that are drawn, those that fill most codes."""
    tried = count * TRIED
    if rng.random() < RESAMPLED or min(scene.pixels.shape[:2]) < side:
        drawn = [AffineResampling.draw(scene, rng, side=side) for _ in range(tried)]
        chosen = [drawn[i].window() for i in _best_covering([one.window(THUMBNAIL_STEP) for one in drawn], count)]
    else:
        crops = [_crop(scene, side, rng) for _ in range(tried)]
        thumbnails = [crop[::THUMBNAIL_STEP, ::THUMBNAIL_STEP] for crop in crops]
        chosen = [crops[i] for i in _best_covering(thumbnails, count)]
    light = np.stack(chosen)
    # Larger frames are interpolated, and the noise of their sensors dithers them.
    return dithered(light, rng) if scene.is_panorama and side == WINDOW_SIZE else light


def _crop(scene: Scene, side: int, rng: np.random.Generator) -> Float32Array:
    """Return a window of the scene, point-sampled at any step that fits."""
    height, width = scene.pixels.shape[:2]
    step = int(rng.integers(1, min(height, width) // side + 1))
    extent = (side - 1) * step + 1
    y, x = rng.integers(height - extent + 1), rng.integers(width - extent + 1)
    return scene.pixels[y : y + extent : step, x : x + extent : step]


def _best_covering(thumbnails: list[Float32Array], count: int) -> IndexArray:
    """Return the indices of the `count` thumbnails that fill most of 256 codes at an ordinary exposure and response."""
    coverage = [filled_bins(np.clip(light * np.float32(0.2), 0, 1) ** np.float32(0.45)) for light in thumbnails]
    return np.argsort(coverage)[::-1][:count]
