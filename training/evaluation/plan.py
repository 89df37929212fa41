"""The simulated photographs: scene, response, exposure and condition of each, balanced and seeded."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from crfnet_core.errors import CRFNetError
from training.synthesis.camera import EXPOSURE_FACTORS, Capture

#: Photographs of P3, each under every condition.
STRESS_PHOTOGRAPHS = 200

#: Gains on red, green and blue in linear light of a camera whose white balance is off by about a stop and a half
#: between red and blue; `training.synthesis.camera` scales them so that a neutral keeps its luminance.
COOL, WARM = (0.6, 1.0, 1.7), (1.7, 1.0, 0.6)


@dataclass(frozen=True)
class Condition:
    """A condition under which a photograph is taken.

    name: the name in the report
    factor: factor on the exposure s_crf
    upsampling: how many times the linear scene is enlarged, by cubic interpolation
    is_gray: whether all channels hold the luminance of the scene
    noise: variance, in squared 8-bit codes, of the Gaussian noise between response and quantization. The CRF-net
        paper's Table 3 gives no unit; this is our reading of it.
    blur: variance, in squared pixels, of the Gaussian that blurs the linear scene
    gains: factors on red, green and blue of the linear scene
    jpeg_quality: quality of a JPEG with subsampled chroma
    """

    name: str
    factor: float = 1.0
    upsampling: int = 1
    is_gray: bool = False
    noise: float = 0.0
    blur: float = 0.0
    gains: tuple[float, float, float] = (1.0, 1.0, 1.0)
    jpeg_quality: int | None = None

    @property
    def light(self) -> Condition:
        """The part of the condition that comes before exposure: photographs that share it share the light."""
        return replace(self, name="", factor=1.0, noise=0.0, jpeg_quality=None)

    @property
    def capture(self) -> Capture:
        """The part of the condition that comes after exposure."""
        return Capture(grain=math.sqrt(self.noise) / 255, jpeg_quality=self.jpeg_quality)


@dataclass(frozen=True)
class Query:
    """The options of an estimate; None leaves the product's default.

    name: the name in the report; empty for the plain query
    windows: windows of each photograph
    coverage: how many of the 256 code values a window should hold; 0 takes random windows
    pooled: photographs, each of another scene, that are estimated together
    averaged: "kept" or "all": take the mean of these windows' weights instead of the product's own answer
    """

    name: str = ""
    windows: int | None = None
    coverage: int | None = None
    pooled: int = 1
    averaged: str | None = None

    @property
    def question(self) -> Query:
        """The part of the query that the product answers: queries that share it share the answer."""
        return replace(self, name="", averaged=None)


PLAIN = Query()
CLEAN = Condition("clean")

CONDITIONS = (
    CLEAN,
    *(Condition(f"exposure {factor:g}", factor=factor) for factor in EXPOSURE_FACTORS if factor != 1),
    *(Condition(f"resolution {times}x", upsampling=times) for times in (2, 4)),
    Condition("grayscale", is_gray=True),
    *(Condition(f"noise variance {variance:g}", noise=variance) for variance in (0.5, 1, 2, 4)),
    *(Condition(f"blur variance {variance:g}", blur=variance) for variance in (1, 2, 4, 8)),
    Condition("cool white balance", gains=COOL),
    Condition("warm white balance", gains=WARM),
    *(Condition(f"JPEG quality {quality}", jpeg_quality=quality) for quality in (95, 85, 75, 50)),
)

QUERIES = (
    Query("random windows", coverage=0),
    *(Query(f"{count} window{'s' * (count > 1)}", windows=count) for count in (1, 2, 5, 10, 20)),
    Query("windows averaged, outliers removed", averaged="kept"),
    Query("windows averaged, none removed", averaged="all"),
    *(Query(f"{count} photographs pooled", pooled=count) for count in (2, 4, 8, 16)),
)


@dataclass(frozen=True)
class TestPhotograph:
    """One simulated photograph and one query about it: the numbers of scene and response, condition and query."""

    __test__ = False  # no test class of pytest

    scene: int
    curve: int
    condition: Condition
    query: Query = PLAIN

    @property
    def label(self) -> str:
        """Scene, response, exposure factor, and the query or condition: the key under which its figures are kept."""
        special = self.query.name or self.condition.name
        return f"scene {self.scene}, curve {self.curve}, exposure {self.condition.factor:g}, {special}"


def balanced(scenes: Sequence[int], curves: Sequence[int], *, count: int, seed: int) -> list[tuple[int, int, float]]:
    """Return `count` triples (scene, response, exposure factor), at most one for each scene and response.

    Both are shuffled and then taken in turn, shifted where the turns would repeat. So every scene and every response
    occurs equally often in any beginning of the list, give or take one, and so does every exposure.

    Raise CRFNetError if `count` is below 1.
    """
    if count < 1:
        raise CRFNetError(f"the number of photographs must be 1 or more, found {count}")
    rng = np.random.default_rng(seed)
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


def clean_photographs(scenes: Sequence[int], curves: Sequence[int], *, count: int, seed: int) -> list[TestPhotograph]:
    """Return the photographs of P0 and P2: clean, each at one of five exposures, through the product as it is."""
    cells = balanced(scenes, curves, count=count, seed=seed)
    return [TestPhotograph(scene, curve, Condition("clean", factor=factor)) for scene, curve, factor in cells]


def stress_photographs(
    scenes: Sequence[int],
    curves: Sequence[int],
    *,
    count: int,
    seed: int,
    conditions: Sequence[Condition] = CONDITIONS,
    queries: Sequence[Query] = QUERIES,
) -> list[TestPhotograph]:
    """Return the photographs of P3: `count` of them under every condition, and the clean ones under every query.

    A query that pools more photographs than there are scenes is left out.
    """
    cells = [(scene, curve) for scene, curve, _ in balanced(scenes, curves, count=count, seed=seed)]
    possible = [query for query in queries if query.pooled <= len(scenes)]
    stressed = [TestPhotograph(scene, curve, condition) for condition in conditions for scene, curve in cells]
    queried = [TestPhotograph(scene, curve, CLEAN, query) for query in possible for scene, curve in cells]
    return stressed + queried
