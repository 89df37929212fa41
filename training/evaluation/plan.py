"""The simulated photographs: scene, response, exposure and condition of each, balanced and seeded."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from crfnet_core.errors import CRFNetError
from training.synthesis.camera import EXPOSURE_FACTORS, Capture

#: Seed of everything random in an evaluation: the choice of photographs, dither, noise, pictures of P6 and bootstrap.
SEED = 2017

#: Factors on the exposure that no automatic exposure chooses (CRF-net paper, Fig. 7).
SEVERE_EXPOSURES = (0.15, 4)

#: Gains on red, green and blue in linear light of a camera whose white balance is off by about a stop and a half
#: between red and blue; `training.synthesis.camera` scales them so that a neutral keeps its luminance.
COOL, WARM = (0.6, 1.0, 1.7), (1.7, 1.0, 0.6)


@dataclass(frozen=True)
class Condition:
    """A condition under which a photograph is taken."""

    name: str  # the name in the report
    factor: float = 1.0  # factor on the exposure s_crf
    is_gray: bool = False  # whether all channels hold the luminance of the scene
    #: Variance of the Gaussian noise of the sensor, before the response, in squared 255ths of the irradiance at which
    #: it clips. The CRF-net paper (Sec. 5.4, Table 3) gives no unit; this is our reading of it.
    noise: float = 0.0
    blur: float = 0.0  # variance, in squared pixels, of the Gaussian that blurs the linear scene
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)  # factors on red, green and blue of the linear scene
    #: Samples along each side of a larger original whose mean is one pixel; 0 takes a scene of the test set.
    averaged: int = 0
    jpeg_quality: int | None = None  # quality of a JPEG with subsampled chroma

    @property
    def light(self) -> Self:
        """The part of the condition that comes before exposure: photographs that share it share the light."""
        return replace(self, name="", factor=1.0, noise=0.0, jpeg_quality=None)

    @property
    def capture(self) -> Capture:
        """The part of the condition that comes after exposure."""
        return Capture(read_noise=math.sqrt(self.noise) / 255, jpeg_quality=self.jpeg_quality)


CLEAN = Condition("clean")

#: The resolutions of Sec. 5.2 of the paper, the first of which is the usual one.
RESOLUTIONS = tuple(Condition(f"resolution {4 // averaged}x", averaged=averaged) for averaged in (4, 2, 1))

CONDITIONS = (
    CLEAN,
    *(Condition(f"exposure {factor:g}", factor) for factor in EXPOSURE_FACTORS + SEVERE_EXPOSURES if factor != 1),
    *RESOLUTIONS,
    Condition("grayscale", is_gray=True),
    *(Condition(f"noise variance {variance:g}", noise=variance) for variance in (0.5, 1, 2, 4)),
    *(Condition(f"blur variance {variance:g}", blur=variance) for variance in (1, 2, 4, 8)),
    Condition("cool white balance", gains=COOL),
    Condition("warm white balance", gains=WARM),
    *(Condition(f"JPEG quality {quality}", jpeg_quality=quality) for quality in (95, 85, 75, 50)),
)


@dataclass(frozen=True)
class TestPhotograph:
    """One simulated photograph: the numbers of scene and response, and the condition."""

    __test__ = False  # no test class of pytest

    scene: int
    curve: int
    condition: Condition

    @property
    def label(self) -> str:
        """Scene, response, exposure factor and condition: the key under which its figures are kept."""
        factor, name = self.condition.factor, self.condition.name
        return f"scene {self.scene}, curve {self.curve}, exposure {factor:g}, {name}"


def balanced(scenes: Sequence[int], curves: Sequence[int], *, count: int) -> list[tuple[int, int, float]]:
    """Return `count` triples (scene, response, exposure factor), at most one for each scene and response.

    Both are shuffled and then taken in turn, shifted where the turns would repeat. So every scene, response and
    exposure occurs equally often in any beginning of the list, give or take one. Raise CRFNetError for no photograph.
    """
    if count < 1:
        raise CRFNetError(f"the number of photographs must be 1 or more, found {count}")
    rng = np.random.default_rng(SEED)
    scenes, curves = (rng.permutation(np.asarray(part)).tolist() for part in (scenes, curves))
    period, factors = math.lcm(len(scenes), len(curves)), len(EXPOSURE_FACTORS)
    return [
        (
            scenes[turn % len(scenes)],
            curves[(turn + turn // period) % len(curves)],
            EXPOSURE_FACTORS[(turn + turn // len(scenes)) % factors],
        )
        for turn in range(min(count, len(scenes) * len(curves)))
    ]


def clean_photographs(scenes: Sequence[int], curves: Sequence[int], *, count: int) -> list[TestPhotograph]:
    """Return the photographs of P0 and P2: clean, each at one of five exposures, through the product as it is."""
    cells = balanced(scenes, curves, count=count)
    return [TestPhotograph(scene, curve, Condition("clean", factor=factor)) for scene, curve, factor in cells]


def stress_photographs(
    scenes: Sequence[int], originals: Sequence[int], curves: Sequence[int], *, count: int
) -> list[TestPhotograph]:
    """Return the photographs of the protocol "paper", `count` of each condition; `RESOLUTIONS` are of `originals`."""
    photographs = []
    for condition in CONDITIONS:
        sources = originals if condition.averaged else scenes
        if sources:
            cells = balanced(sources, curves, count=count)
            photographs += [TestPhotograph(scene, curve, condition) for scene, curve, _ in cells]
    return photographs
