"""Draw the paper's windows on the device that trains: a scene, one of the 201 responses, an exposure and a place.

A window counts if it holds at least 220 of the 256 codes over all channels (CRF-net paper, Sec. 3.2, 3.3). The paper
takes ten windows of each of five exposures of each of its 595 photographs under each response, 5 979 750 in all; here
every window has a photograph of its own. `render` applies the response and rounds to 8 bits.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from crfnet_core.statistics.windows import FULL_COVERAGE, WINDOW_SIZE
from training.data.curves import read_dorf
from training.data.scenes import Scene, area_averaged, dithered
from training.data.splits import read_scenes
from training.synthesis.camera import automatic_exposure, reference_luminance

FLOAT16_MAX = 65504.0  # the largest float16
PART = 256  # windows that are rendered at a time: a batch of an accelerator
BLENDED = 0.25  # part of the windows that are a blend of two scenes

#: Range of the exposure in training, uniform, in units of s_crf (Sec. 3.3: s_crf - 0.4 to s_crf + 0.4, with light
#: scaled so that s_crf is near 1). Table 2 tests five factors of this range.
EXPOSURES = (0.6, 1.4)

#: Photographs tried for a window before its response is drawn anew: under some, hardly a window covers the range.
TRIED = 240

#: Standard deviations: of the gains of white balance and of the exponent of contrast, in stops; and of a color matrix.
GAINS, CONTRAST, MATRIX = 0.4, 0.3, 0.12


@dataclass(frozen=True)
class TrainingScenes:
    """The linear scenes of one split, and the responses, on one device.

    pixels, each float16 (3, H, W): irradiance, each scene scaled to a geometric mean luminance of 1
    curves, float32 (201, 1024): responses at uniform irradiances
    exposures, float32 (201,): s_crf, which belongs to the response and is the same for every photograph and split
    """

    pixels: tuple[Tensor, ...]
    curves: Tensor
    exposures: Tensor


@dataclass(frozen=True)
class Windows:
    """A batch of windows."""

    codes: Tensor  # uint8 (N, 3, 227, 227): 8-bit samples
    classes: Tensor  # int64 (N,): which of the 201 responses each window has
    exposures: Tensor  # float32 (N,): factor on the exposure s_crf

    def inputs(self, part: int = PART) -> Iterator[Tensor]:
        """Yield the network's input by parts: code values in [0, 1], float32 (N, 3, 227, 227)."""
        for codes in self.codes.split(part):
            yield (codes.float() / 255).contiguous(memory_format=torch.channels_last)


def read_splits(data: Path, device: str = "cpu") -> dict[str, TrainingScenes]:
    """Return the splits "train" and "validation" of the scenes in the folder `data`, with the responses of DoRF."""
    scenes = {split: read_scenes(data / "linear", split) for split in ("train", "validation")}
    curves, luminance = read_dorf(data), reference_luminance(scenes["train"])
    exposures = torch.tensor([automatic_exposure(curve, luminance) for curve in curves], dtype=torch.float32).to(device)
    responses = torch.from_numpy(curves).float().to(device)
    pixels = {
        split: tuple(scene_pixels(scene, number).to(device) for number, scene in enumerate(members))
        for split, members in scenes.items()
    }
    return {split: TrainingScenes(members, responses, exposures) for split, members in pixels.items()}


def scene_pixels(scene: Scene, number: int) -> Tensor:
    """Return a scene, float16 (3, H, W), averaged to a shorter side just above 227: a window sees nearly all of it."""
    pixels = dithered(scene.pixels, np.random.default_rng([2017, number])) if scene.is_panorama else scene.pixels
    factor = max(1, min(pixels.shape[:2]) // WINDOW_SIZE)
    half = np.minimum(area_averaged(pixels, factor), FLOAT16_MAX).astype(np.float16)
    return torch.from_numpy(np.ascontiguousarray(half.transpose(2, 0, 1)))


def draw_windows(scenes: TrainingScenes, count: int, *, seed: int, augment: bool = False) -> Windows:
    """Return `count` windows that meet the paper's rule, on the device of the scenes; responses are equally likely."""
    device = scenes.curves.device
    generator = torch.Generator(device).manual_seed(seed)
    size = (count, 3, WINDOW_SIZE, WINDOW_SIZE)
    drawn = Windows(
        torch.zeros(size, dtype=torch.uint8, device=device),
        torch.zeros(count, dtype=torch.int64, device=device),
        torch.zeros(count, device=device),
    )
    pending, (low, high) = torch.arange(count, device=device), EXPOSURES
    for turn in range(TRIED * count):
        if turn % TRIED == 0:
            classes = torch.randint(len(scenes.curves), (len(pending),), device=device, generator=generator)
            drawn.classes[pending] = classes
        drawn.exposures[pending] = low + (high - low) * torch.rand(len(pending), device=device, generator=generator)
        places = _places(scenes, len(pending), generator)
        parts = zip(pending.split(PART), places.split(PART), strict=True)
        covers = [_fill(drawn, scenes, *part, generator if augment else None) for part in parts]
        pending = pending[~torch.cat(covers)]
        if len(pending) == 0:
            return drawn
    raise ValueError("hardly a window of these scenes covers the range of brightness; give other scenes")


def _fill(
    drawn: Windows, scenes: TrainingScenes, index: Tensor, places: Tensor, generator: torch.Generator | None
) -> Tensor:
    """Render the windows of a batch at `index`, in place, and return which of them cover the range."""
    light = _crops(scenes, places)
    if generator is not None:
        light = augmented(light, _crops(scenes, _places(scenes, len(index), generator)), generator)
    drawn.codes[index] = render(light, scenes, drawn.classes[index], drawn.exposures[index])
    return filled(drawn.codes[index]) >= FULL_COVERAGE


def augmented(light: Tensor, other: Tensor, generator: torch.Generator) -> Tensor:
    """Return light (N, 3, 227, 227), blended with `other` in some windows and changed as a whole, float32.

    The paper has no augmentation, but 595 scenes. Mirroring, transposition, permuted channels, white balance, color
    matrices and contrast, before the response, do not change what the response does; the strengths are ours.
    """
    count, device = len(light), light.device

    def normal(*shape: int) -> Tensor:
        return torch.randn(count, *shape, device=device, generator=generator)

    def uniform() -> Tensor:
        return torch.rand(count, 1, 1, 1, device=device, generator=generator)

    part = torch.where(uniform() < BLENDED, uniform(), 0)
    light = (1 - part) * light.float() + part * other.float()
    light = torch.where(uniform() < 0.5, light.flip(3), light)
    light = torch.where(uniform() < 0.5, light.transpose(2, 3), light)
    order = torch.rand(count, 3, device=device, generator=generator).argsort(dim=1)
    light = light.gather(1, order[:, :, None, None].expand_as(light))
    matrix = torch.eye(3, device=device) + MATRIX * normal(3, 3)
    matrix = matrix / matrix.sum(dim=2, keepdim=True)  # neutrals stay
    light = torch.einsum("nij,njhw->nihw", torch.exp2(GAINS * normal(3, 1)) * matrix, light).clamp(min=0)
    return light ** torch.exp2(CONTRAST * normal(1, 1, 1))


def render(light: Tensor, scenes: TrainingScenes, classes: Tensor, exposures: Tensor) -> Tensor:
    """Return the 8-bit codes of light (N, 3, H, W) under responses, at `exposures` times their s_crf."""
    last = scenes.curves.shape[1] - 1
    factors = exposures * scenes.exposures[classes] * last
    position = (light.float() * factors[:, None, None, None]).clamp(0, last)
    below = position.int().clamp(max=last - 1)
    index = below + (classes * (last + 1)).int()[:, None, None, None]
    low, high = scenes.curves.flatten()[index], scenes.curves.flatten()[index + 1]
    return ((low + (position - below) * (high - low)) * 255).round().byte()


def filled(codes: Tensor) -> Tensor:
    """Return how many of the 256 codes occur in each window, int64 (N,), of codes (N, ...)."""
    seen = torch.zeros(len(codes), 256, dtype=torch.uint8, device=codes.device)
    return seen.scatter_(1, codes.flatten(1).long(), 1).sum(dim=1)


def _places(scenes: TrainingScenes, count: int, generator: torch.Generator) -> Tensor:
    """Return random scenes and places in them: number, and fractions of height and width, float32 (count, 3)."""
    numbers = torch.randint(len(scenes.pixels), (count,), device=generator.device, generator=generator)
    fractions = torch.rand(count, 2, device=generator.device, generator=generator)
    return torch.cat([numbers[:, None], fractions], dim=1)


def _crops(scenes: TrainingScenes, places: Tensor) -> Tensor:
    """Return the squares of irradiance at `places`, float16 (N, 3, 227, 227)."""
    crops = []
    for number, *place in places.tolist():
        scene = scenes.pixels[int(number)]
        y, x = (int(part * (side - WINDOW_SIZE + 1)) for part, side in zip(place, scene.shape[1:], strict=True))
        crops.append(scene[:, y : y + WINDOW_SIZE, x : x + WINDOW_SIZE])
    return torch.stack(crops)
