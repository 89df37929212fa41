"""Training photographs: windows of a scene as random cameras would have recorded them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, zoom

from crfnet_core.windows import WINDOW_SIZE, filled_bins, filled_codes
from training.data.curves import CurveSource
from training.data.scenes import LUMINANCE, Scene, dithered
from training.synthesis.camera import Capture, automatic_exposure, photographed
from training.synthesis.resampling import View

#: Windows of a training photograph, and the candidates that they are the best-covering of.
WINDOWS, CANDIDATES = 4, 8

#: Code values that the best window of a training photograph fills at least, of 256.
LEAST_FILLED = 120

#: Scenes are dealt into so many folds; a photograph shows scenes of one fold only, so that what a network that was
#: trained without a fold says of its photographs is what it would say of new scenes.
FOLDS = 3

#: Shares of photographs: half of the windows show another scene; windows are views at any angle and scale; windows are
#: pieced together of two scenes; large-scale contrast is changed; nothing but the response lies between light and file.
TWO_SCENES, VIEWS, PIECED, CONTRAST, CLEAN = 0.25, 0.35, 0.15, 0.2, 0.15


@dataclass(frozen=True)
class Photograph:
    """Windows, uint8 (4, 227, 227, 3), of one photograph, the response (1024,), its set, and the scenes' fold."""

    windows: np.ndarray
    curve: np.ndarray
    curve_set: int
    fold: int


@dataclass(frozen=True)
class PhotographSource:
    """Draws training photographs.

    Parameters
    ----------
    scenes : list of Scene
        Of one split.
    curve_sets : tuple of CurveSource
        Responses, in sets of which some may be left out of a training.
    shares : tuple of float
        Share of each set; their sum is 1.
    luminance : ndarray, shape (N,)
        See `training.synthesis.camera.automatic_exposure`.
    cameras : int
        Cameras that see the same windows of a scene.
    """

    scenes: list[Scene]
    curve_sets: tuple[CurveSource, ...]
    shares: tuple[float, ...]
    luminance: np.ndarray
    cameras: int = 3

    def draw(self, rng: np.random.Generator) -> list[Photograph]:
        """Return up to `cameras` photographs of the same windows."""
        fold = int(rng.integers(min(FOLDS, len(self.scenes))))
        light = relit(augmented(self._windows(self.scenes[fold::FOLDS], rng), rng), rng)
        drawn = (self._photograph(light, fold, rng) for _ in range(self.cameras))
        return [photo for photo in drawn if max(map(filled_codes, photo.windows)) >= LEAST_FILLED]

    def draw_curve(self, rng: np.random.Generator) -> tuple[np.ndarray, int]:
        """Return a response, shape (1024,), and the number of its set."""
        chosen = int(rng.choice(len(self.shares), p=self.shares))
        return self.curve_sets[chosen].draw(rng), chosen

    def _windows(self, scenes: list[Scene], rng: np.random.Generator) -> np.ndarray:
        """Return linear windows (4, 227, 227, 3) of one or two of the scenes."""
        first, second = (scenes[i] for i in rng.integers(len(scenes), size=2))
        if rng.random() > TWO_SCENES:
            light = _scene_windows(first, WINDOWS, rng)
        else:
            light = np.concatenate([_scene_windows(scene, WINDOWS // 2, rng) for scene in (first, second)])
        if rng.random() < PIECED:
            light = pieced(light, _scene_windows(scenes[rng.integers(len(scenes))], WINDOWS, rng), rng)
        return light

    def _photograph(self, light: np.ndarray, fold: int, rng: np.random.Generator) -> Photograph:
        """Return the windows as a random camera records them."""
        curve, chosen = self.draw_curve(rng)
        capture = Capture() if rng.random() < CLEAN else Capture.draw(rng)
        exposure = np.float32(self._exposure(light, curve, rng))
        return Photograph(photographed(light * exposure, curve, capture, rng), curve, chosen, fold)

    def _exposure(self, light: np.ndarray, curve: np.ndarray, rng: np.random.Generator) -> float:
        """Return the exposure: around s_crf, or one that puts a high percentile of the windows at saturation."""
        if rng.random() < 0.6:
            return automatic_exposure(curve, self.luminance) * rng.uniform(0.5, 1.6)
        return 1 / max(float(np.percentile(light[:, ::4, ::4].max(axis=-1), rng.uniform(80, 99.9))), 1e-6)


def augmented(light: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return windows turned, with another illuminant and other primaries, sometimes without colour."""
    turned = np.rot90(light, rng.integers(4), axes=(1, 2))
    turned = turned[:, :, ::-1] if rng.random() < 0.5 else turned
    if rng.random() < 0.08:
        return np.repeat((turned @ LUMINANCE)[..., None], 3, axis=-1)
    matrix = np.eye(3) + rng.uniform(0, 0.15, (3, 3))
    matrix = matrix / matrix.sum(axis=1, keepdims=True) * np.exp2(rng.normal(0, 0.4, 3))[:, None]
    return turned @ matrix.T.astype(np.float32)


def relit(light: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return windows, sometimes under smoothly uneven light, sometimes with more or less contrast.

    Scenes are few: another distribution of light makes other photographs of them. A power of all irradiance bends the
    edges a little, so it stays mild; contrast at a large scale leaves the edges alone, and may change a lot.
    """
    if rng.random() < 0.3:
        light = light * _uneven(len(light), rng)
    if rng.random() < CONTRAST:
        light = light * _large_scale(light, rng)
    if rng.random() < 0.3:
        light = np.maximum(light, 0) ** np.float32(np.exp(rng.normal(0, 0.12)))
    return np.ascontiguousarray(light, dtype=np.float32)


def _uneven(count: int, rng: np.random.Generator) -> np.ndarray:
    """Return smooth factors around 1, shape (count, 227, 227, 1): one wave across each window, of up to two stops."""
    place = np.linspace(0, 1, WINDOW_SIZE, dtype=np.float32)
    turn, start = rng.uniform(0, 2 * np.pi, (2, count, 1, 1))
    across = np.cos(turn) * place[:, None] + np.sin(turn) * place[None, :]
    stops = rng.uniform(0.2, 2, (count, 1, 1)) * np.sin(rng.uniform(1, 5, (count, 1, 1)) * across + start)
    return np.exp2(stops)[..., None].astype(np.float32)


def pieced(light: np.ndarray, other: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return windows (4, 227, 227, 3) of which a piece shows other windows, more or less exposed.

    The border is a straight line, along which a sample mixes the light of both, as in a photograph.
    """
    exposure = np.float32(np.exp2(rng.normal(0, 1.2)))
    place = np.arange(WINDOW_SIZE, dtype=np.float32) - WINDOW_SIZE / 2
    turn, distance = rng.uniform(0, 2 * np.pi, (WINDOWS, 1, 1)), rng.uniform(-60, 60, (WINDOWS, 1, 1))
    beyond = np.cos(turn) * place[:, None] + np.sin(turn) * place[None, :] - distance
    share = np.clip(beyond + 0.5, 0, 1)[..., None].astype(np.float32)
    return light * (1 - share) + other * exposure * share


def _large_scale(light: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return smooth factors, shape (4, 227, 227, 1), that spread or squeeze the light's large-scale contrast."""
    fine = np.log(np.maximum(light[:, ::4, ::4] @ LUMINANCE, 1e-6))
    coarse = gaussian_filter(fine, (0, *np.full(2, rng.uniform(2, 10))))
    smooth = zoom(coarse - coarse.mean(), (1, *np.full(2, WINDOW_SIZE / coarse.shape[1])), order=1)
    return np.exp((np.exp(rng.normal(0, 0.35)) - 1) * smooth)[..., None].astype(np.float32)


def _scene_windows(scene: Scene, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return the `count` linear windows of a scene with most different brightnesses, of twice as many candidates."""
    candidates = count * CANDIDATES // WINDOWS
    if rng.random() < VIEWS:
        views = [View.draw(scene, rng) for _ in range(candidates)]
        chosen = [views[i].window() for i in _best_covering([view.glance() for view in views], count)]
    else:
        crops = [_crop(scene, rng) for _ in range(candidates)]
        chosen = [crops[i] for i in _best_covering([crop[::4, ::4] for crop in crops], count)]
    light = np.stack(chosen)
    return dithered(light, rng) if scene.is_panorama else light


def _crop(scene: Scene, rng: np.random.Generator) -> np.ndarray:
    """Return a window of the scene, point-sampled at any step that fits."""
    height, width = scene.pixels.shape[:2]
    step = int(rng.integers(1, min(height, width) // WINDOW_SIZE + 1))
    extent = (WINDOW_SIZE - 1) * step + 1
    y, x = rng.integers(height - extent + 1), rng.integers(width - extent + 1)
    return scene.pixels[y : y + extent : step, x : x + extent : step]


def _best_covering(glances: list[np.ndarray], count: int) -> np.ndarray:
    """Return the places of the `count` sparse windows that fill most of 256 codes at an ordinary exposure."""
    coverage = [filled_bins(np.clip(light * np.float32(0.2), 0, 1) ** np.float32(0.45)) for light in glances]
    return np.argsort(coverage)[::-1][:count]
