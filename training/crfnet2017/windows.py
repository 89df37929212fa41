"""Draw the paper's windows: a scene, one of the 201 responses, an exposure and a place (CRF-net paper, Sec. 3.2, 3.3).

A window counts if it holds at least 220 of the 256 codes over all channels. The paper takes ten windows of each of five
exposures of each of its 595 photographs under each response, 5 979 750 in all; here every window has a photograph of
its own, of one of 94 scenes, and half of the windows are mirrored. The host only cuts out float16 irradiance;
`render_windows` applies the response and rounds to 8 bits on the device that trains.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import IterableDataset, get_worker_info

from crfnet_core.statistics.windows import FULL_COVERAGE, WINDOW_SIZE, filled_codes
from training.data.curves import DORF_FILE, read_dorf
from training.data.scenes import Scene, area_averaged, dithered, read_scenes
from training.synthesis.camera import apply_response, automatic_exposure, reference_luminance

#: How many float16 values are finite and not negative, and the largest.
FLOAT16_CODES, FLOAT16_MAX = 31744, 65504.0

#: Range of the exposure in training, uniform, in units of s_crf (Sec. 3.3: s_crf - 0.4 to s_crf + 0.4, with light
#: scaled so that s_crf is near 1). Table 2 tests five factors of this range.
EXPOSURES = (0.6, 1.4)

#: Photographs tried for one response, and positions tried in one photograph, before the next is tried.
PHOTOGRAPHS_TRIED, POSITIONS_TRIED = 20, 12

#: Step between the samples of a window that are looked at first: where these fill enough bins, the window does.
SPARSE_STEP = 3


@dataclass(frozen=True)
class TrainingScenes:
    """The linear scenes of one split, and the responses.

    pixels, each float16 (H, W, 3): irradiance, each scene scaled to a geometric mean luminance of 1
    curves, float32 (201, 1024): responses at uniform irradiances
    exposures, float32 (201,): s_crf, which belongs to the response and is the same for every photograph and split
    """

    pixels: tuple[np.ndarray, ...]
    curves: np.ndarray
    exposures: np.ndarray


@dataclass(frozen=True)
class LinearWindows:
    """A batch of windows before their responses.

    irradiance, float16 (N, 227, 227, 3): linear samples
    classes, int64 (N,): which of the 201 responses each window gets
    exposures, float32 (N,): factor on the irradiance of each window
    """

    irradiance: Tensor
    classes: Tensor
    exposures: Tensor

    def to(self, device: torch.device) -> LinearWindows:
        """Return the batch on a device."""
        parts = (self.irradiance, self.classes, self.exposures)
        return LinearWindows(*(part.to(device, non_blocking=True) for part in parts))

    def split(self, size: int) -> Iterator[LinearWindows]:
        """Yield the batch in parts of `size` windows or fewer."""
        parts = (self.irradiance, self.classes, self.exposures)
        for arrays in zip(*(part.split(size) for part in parts), strict=True):
            yield LinearWindows(*arrays)


class WindowStream(IterableDataset[LinearWindows]):
    """Batches of training windows, one for each of `steps`.

    A batch depends on the seed and the step only. The workers of a `DataLoader` take the steps in turn, so neither
    their number nor an interruption changes anything.
    """

    def __init__(self, scenes: TrainingScenes, *, batch: int, steps: range, seed: int) -> None:
        super().__init__()
        self.scenes, self.batch, self.steps, self.seed = scenes, batch, steps, seed

    def __iter__(self) -> Iterator[LinearWindows]:
        worker = get_worker_info()
        steps = self.steps if worker is None else self.steps[worker.id :: worker.num_workers]
        for step in steps:
            yield draw_windows(self.scenes, self.batch, np.random.default_rng([self.seed, step]))


def read_splits(data: Path) -> dict[str, TrainingScenes]:
    """Return the splits "train" and "validation" of the scenes in the folder `data`, with the responses of DoRF."""
    scenes = {split: read_scenes(data / "linear", split) for split in ("train", "validation")}
    curves, luminance = read_dorf(data / DORF_FILE), reference_luminance(scenes["train"])
    exposures = np.array([automatic_exposure(curve, luminance) for curve in curves], dtype=np.float32)
    curves = curves.astype(np.float32)
    return {
        split: TrainingScenes(tuple(map(scene_pixels, members, range(len(members)))), curves, exposures)
        for split, members in scenes.items()
    }


def scene_pixels(scene: Scene, number: int) -> np.ndarray:
    """Return a scene as float16 (H, W, 3), averaged by the whole factor that leaves its shorter side just above 227.

    A panorama is dithered first, with a seed of its number.
    """
    pixels = dithered(scene.pixels, np.random.default_rng([2017, number])) if scene.is_panorama else scene.pixels
    factor = max(1, min(pixels.shape[:2]) // WINDOW_SIZE)
    return np.minimum(area_averaged(pixels, factor), FLOAT16_MAX).astype(np.float16)


def draw_windows(scenes: TrainingScenes, count: int, rng: np.random.Generator) -> LinearWindows:
    """Return `count` windows that meet the paper's rule; the responses are equally likely."""
    windows: list[np.ndarray] = []
    classes: list[int] = []
    exposures: list[float] = []
    while len(windows) < count:
        curve = int(rng.integers(len(scenes.curves)))
        drawn = _window(scenes, curve, rng)
        if drawn is not None:
            windows.append(drawn[0])
            classes.append(curve)
            exposures.append(drawn[1])
    irradiance = torch.from_numpy(np.stack(windows))
    return LinearWindows(irradiance, torch.tensor(classes), torch.tensor(exposures, dtype=torch.float32))


def render_windows(windows: LinearWindows, curves: Tensor) -> Tensor:
    """Return 8-bit windows in [0, 1], float32 (N, 3, 227, 227), on the device of `windows` and `curves` (201, 1024).

    A table of codes for every window, as `code_table`: float16 has fewer values than a window has samples, so each
    value goes through the response once.
    """
    values = torch.from_numpy(_float16_values()).to(curves.device)
    last = curves.shape[1] - 1
    position = (values * windows.exposures[:, None]).clamp(0, 1) * last
    below = position.int().clamp(max=last - 1)
    index = below + (windows.classes * curves.shape[1]).int()[:, None]
    low, high = curves.flatten()[index], curves.flatten()[index + 1]
    tables = ((low + (position - below) * (high - low)) * 255).round() / 255
    offsets = torch.arange(len(tables), dtype=torch.int32, device=curves.device) * FLOAT16_CODES
    bits = windows.irradiance.view(torch.int16).int() + offsets[:, None, None, None]
    return tables.flatten()[bits].permute(0, 3, 1, 2)


def code_table(curve: np.ndarray, exposure: float) -> np.ndarray:
    """Return the 8-bit code, uint8 (31744,), of every float16 irradiance that is not negative, by its bits."""
    return np.rint(apply_response(_float16_values() * np.float32(exposure), curve) * 255).astype(np.uint8)


def _float16_values() -> np.ndarray:
    """Return all finite float16 that are not negative, in the order of their bits, as float32."""
    return np.arange(FLOAT16_CODES, dtype=np.uint16).view(np.float16).astype(np.float32)


def _window(scenes: TrainingScenes, curve: int, rng: np.random.Generator) -> tuple[np.ndarray, float] | None:
    """Return a window that covers the range under a response, and its exposure; None if too many tries fail."""
    for _ in range(PHOTOGRAPHS_TRIED):
        scene = scenes.pixels[rng.integers(len(scenes.pixels))]
        exposure = float(scenes.exposures[curve] * rng.uniform(*EXPOSURES))
        codes = code_table(scenes.curves[curve], exposure)
        for _ in range(POSITIONS_TRIED):
            y, x = (int(rng.integers(side - WINDOW_SIZE + 1)) for side in scene.shape[:2])
            window = scene[y : y + WINDOW_SIZE, x : x + WINDOW_SIZE]
            if _covers_range(window, codes):
                return np.ascontiguousarray(window[:, ::-1] if rng.random() < 0.5 else window), exposure
    return None


def _covers_range(window: np.ndarray, codes: np.ndarray) -> bool:
    """Return whether the window fills `FULL_COVERAGE` bins."""
    bits = window.view(np.uint16)
    sparse = bits[::SPARSE_STEP, ::SPARSE_STEP]
    return filled_codes(codes[sparse]) >= FULL_COVERAGE or filled_codes(codes[bits]) >= FULL_COVERAGE
