"""Draw the paper's windows from packed scenes: ``python -m training.crfnet2017.windows --data DIR --out DIR`` packs.

A photograph is a scene, a curve drawn evenly from the 201, and an exposure of s_crf times 0.6, 0.8, 1, 1.2 or 1.4. Its
windows are those with at least 220 of the 256 code values over all channels (CRF-net paper, Sec. 3.2, 3.3). The host
only cuts float16 irradiance; `render_windows` does tone curve and 8-bit rounding on the device that trains.
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

from crfnet_core.windows import FULL_COVERAGE, WINDOW_SIZE, filled_codes
from training.crfnet2017.pack import ScenePack, write_pack
from training.synthesis.camera import EXPOSURE_FACTORS, apply_response

#: Finite float16 that are not negative.
FLOAT16_CODES = 31744

#: Photographs tried for one curve, and positions tried in one photograph, before another is taken.
PHOTOGRAPHS, POSITIONS = 20, 12

#: Every how many-th sample of a window is looked at first: where these fill enough bins, the window does.
SPARSE_STEP = 3


@dataclass(frozen=True)
class LinearWindows:
    """A batch before its tone curves.

    Parameters
    ----------
    irradiance : Tensor, float16, shape (N, 227, 227, 3)
        Linear samples.
    classes : Tensor, int64, shape (N,)
        Which of the 201 responses each window gets.
    exposures : Tensor, float32, shape (N,)
        What the irradiance is multiplied with.
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
        for some in zip(*(part.split(size) for part in parts), strict=True):
            yield LinearWindows(*some)

    def pin_memory(self) -> LinearWindows:
        """Return the batch in page-locked memory, which `torch.utils.data.DataLoader` asks for."""
        return LinearWindows(self.irradiance.pin_memory(), self.classes.pin_memory(), self.exposures.pin_memory())


def draw_windows(pack: ScenePack, count: int, rng: np.random.Generator, *, per_photograph: int = 1) -> LinearWindows:
    """Return `count` windows that meet the paper's rule, the curves drawn evenly, at random mirrored.

    Parameters
    ----------
    pack : ScenePack
        Scenes and responses.
    count : int
        Windows of the batch.
    rng : Generator
        Decides everything.
    per_photograph : int
        Windows taken of one photograph at most; the paper takes 10. One makes batches of more kinds.
    """
    windows: list[np.ndarray] = []
    classes: list[int] = []
    exposures: list[float] = []
    while len(windows) < count:
        curve = int(rng.integers(len(pack.curves)))
        found, exposure = _photograph_windows(pack, curve, min(per_photograph, count - len(windows)), rng)
        windows += found
        classes += [curve] * len(found)
        exposures += [exposure] * len(found)
    irradiance = torch.from_numpy(np.stack(windows))
    return LinearWindows(irradiance, torch.tensor(classes), torch.tensor(exposures, dtype=torch.float32))


class WindowStream(IterableDataset[LinearWindows]):
    """Batches of training windows, one a step; step n holds the same windows in every process and at every start.

    Workers of a `DataLoader` share the steps out in turn, so that their number changes nothing.

    Parameters
    ----------
    pack : ScenePack
        Scenes and responses.
    batch : int
        Windows of a step.
    steps : range
        The steps to draw: from the first that is not done yet.
    seed, rank : int
        With the step, all that the windows depend on; processes that train together have different ranks.
    per_photograph : int
        As in `draw_windows`.
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

    As `code_table`, for every window its own: float16 has fewer values than a window has samples, so each value goes
    through the curve once.
    """
    values = torch.from_numpy(_float16_values()).to(curves.device)
    last = curves.shape[1] - 1
    place = (values * windows.exposures[:, None]).clamp(0, 1) * last
    below = place.int().clamp(max=last - 1)
    index = below + (windows.classes * curves.shape[1]).int()[:, None]
    low, high = curves.flatten()[index], curves.flatten()[index + 1]
    tables = ((low + (place - below) * (high - low)) * 255).round() / 255
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
    """Return one to `count` good windows of the first photograph under the curve that has any, else none."""
    exposure = 0.0
    for _ in range(PHOTOGRAPHS):
        scene = pack.scenes[rng.integers(len(pack.scenes))]
        exposure = float(pack.exposures[curve] * rng.choice(EXPOSURE_FACTORS))
        codes = code_table(pack.curves[curve], exposure)
        found: list[np.ndarray] = []
        for _ in range(POSITIONS):
            y, x = (int(rng.integers(side - WINDOW_SIZE + 1)) for side in scene.shape[:2])
            window = scene[y : y + WINDOW_SIZE, x : x + WINDOW_SIZE]
            if _covers_range(window, codes):
                found.append(np.ascontiguousarray(window[:, ::-1] if rng.random() < 0.5 else window))
            if len(found) == count:
                break
        if found:
            return found, exposure
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
    for split in [options.split] if options.split else ["train", "validation"]:
        print(f"wrote {write_pack(options.data, options.out, split)}")


if __name__ == "__main__":
    main()
