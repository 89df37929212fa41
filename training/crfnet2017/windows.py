"""Draw the paper's windows from packed scenes: ``python -m training.crfnet2017.windows --data DIR --out DIR`` packs.

A photograph is a scene, one of the 201 responses, all equally likely, and an exposure of s_crf times 0.6, 0.8, 1, 1.2
or 1.4. Its windows are those that hold at least 220 of the 256 codes over all channels (CRF-net paper, Sec. 3.2, 3.3).
The host only cuts out float16 irradiance; `render_windows` applies the response and rounds to 8 bits on the device that
trains.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import IterableDataset, get_worker_info

from crfnet_core.statistics.windows import FULL_COVERAGE, WINDOW_SIZE, filled_codes
from training.crfnet2017.pack import ScenePack, write_pack
from training.data.manifest import training_digest
from training.provenance import record_making
from training.synthesis.camera import EXPOSURE_FACTORS, apply_response

#: How many float16 values are finite and not negative.
FLOAT16_CODES = 31744

#: Photographs tried for one response, and positions tried in one photograph, before the next is tried.
PHOTOGRAPHS_TRIED, POSITIONS_TRIED = 20, 12

#: Step between the samples of a window that are looked at first: where these fill enough bins, the window does.
SPARSE_STEP = 3


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

    def pin_memory(self) -> LinearWindows:
        """Return the batch in page-locked memory, which `torch.utils.data.DataLoader` asks for."""
        return LinearWindows(self.irradiance.pin_memory(), self.classes.pin_memory(), self.exposures.pin_memory())


def draw_windows(pack: ScenePack, count: int, rng: np.random.Generator, *, per_photograph: int = 1) -> LinearWindows:
    """Return `count` windows that meet the paper's rule; responses are equally likely, half of the windows mirrored.

    `pack`: scenes and responses. `count`: windows of the batch. `rng`: draws responses, scenes, exposures, positions
    and mirroring. `per_photograph`: windows of one photograph at most; the paper takes 10. With one, a batch holds more
    photographs.
    """
    windows: list[np.ndarray] = []
    classes: list[int] = []
    exposures: list[float] = []
    while len(windows) < count:
        curve = int(rng.integers(len(pack.curves)))
        chosen, exposure = _photograph_windows(pack, curve, min(per_photograph, count - len(windows)), rng)
        windows += chosen
        classes += [curve] * len(chosen)
        exposures += [exposure] * len(chosen)
    irradiance = torch.from_numpy(np.stack(windows))
    return LinearWindows(irradiance, torch.tensor(classes), torch.tensor(exposures, dtype=torch.float32))


class WindowStream(IterableDataset[LinearWindows]):
    """Batches of training windows, one for each step; a step has the same windows whenever the run was interrupted.

    The workers of a `DataLoader` take the steps in turn, so their number changes nothing.

    steps: the steps to draw windows for, from the first that is not done
    seed, rank: the windows depend on these two and on the step; processes that train together have different ranks
    per_photograph: as in `draw_windows`
    """

    def __init__(
        self, pack: ScenePack, *, batch: int, steps: range, seed: int, rank: int = 0, per_photograph: int = 1
    ) -> None:
        super().__init__()
        self.pack, self.batch, self.steps = pack, batch, steps
        self.seed, self.rank, self.per_photograph = seed, rank, per_photograph

    def __iter__(self) -> Iterator[LinearWindows]:
        worker = get_worker_info()
        steps = self.steps if worker is None else self.steps[worker.id :: worker.num_workers]
        for step in steps:
            rng = np.random.default_rng([self.seed, self.rank, step])
            yield draw_windows(self.pack, self.batch, rng, per_photograph=self.per_photograph)


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


def _photograph_windows(
    pack: ScenePack, curve: int, count: int, rng: np.random.Generator
) -> tuple[list[np.ndarray], float]:
    """Return 1 to `count` windows of the first photograph tried that has any, and its exposure; else none."""
    exposure = 0.0
    for _ in range(PHOTOGRAPHS_TRIED):
        scene = pack.scenes[rng.integers(len(pack.scenes))]
        exposure = float(pack.exposures[curve] * rng.choice(EXPOSURE_FACTORS))
        codes = code_table(pack.curves[curve], exposure)
        chosen: list[np.ndarray] = []
        for _ in range(POSITIONS_TRIED):
            y, x = (int(rng.integers(side - WINDOW_SIZE + 1)) for side in scene.shape[:2])
            window = scene[y : y + WINDOW_SIZE, x : x + WINDOW_SIZE]
            if _covers_range(window, codes):
                chosen.append(np.ascontiguousarray(window[:, ::-1] if rng.random() < 0.5 else window))
            if len(chosen) == count:
                break
        if chosen:
            return chosen, exposure
    return [], exposure


def _covers_range(window: np.ndarray, codes: np.ndarray) -> bool:
    """Return whether the window fills `FULL_COVERAGE` bins."""
    bits = window.view(np.uint16)
    sparse = bits[::SPARSE_STEP, ::SPARSE_STEP]
    return filled_codes(codes[sparse]) >= FULL_COVERAGE or filled_codes(codes[bits]) >= FULL_COVERAGE


def main() -> None:
    """Pack the splits asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf and linear")
    parser.add_argument("--out", type=Path, required=True, help="folder of the pack")
    parser.add_argument("--split", choices=["train", "validation"], help="by default both")
    options = parser.parse_args()
    digest = training_digest(options.data)
    for split in [options.split] if options.split else ["train", "validation"]:
        print(f"wrote {write_pack(options.data, options.out, split)}")
        record_making(options.out, split, digest)


if __name__ == "__main__":
    main()
