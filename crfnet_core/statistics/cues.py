"""The cues: all sums that are counted in a window, and their layout in one vector.

A new cue is a function of `Samples` and a row at the end of `CUES`; models that were trained before read the cues
before it. The network of `training` unpacks the vector with the same table, and docs/METHOD.md prints it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crfnet_core.statistics.channel_equations import EQUATIONS_SHAPE, channel_equations
from crfnet_core.statistics.edges import EDGES_SHAPE, edge_sums
from crfnet_core.statistics.gradients import GRADIENTS_SHAPE, HISTOGRAM_SHAPE, gradient_sums, level_histogram
from crfnet_core.statistics.mixing import (
    DISAGREEMENT_SHAPE,
    HALF_RESOLUTION_SHAPE,
    MIXING_SHAPE,
    disagreement,
    half_resolution_disagreement,
    mixing,
)
from crfnet_core.statistics.sampling import Samples
from crfnet_core.statistics.shading import SHADING_SHAPE, shading
from crfnet_core.types import Float32Array


@dataclass(frozen=True)
class Cue:
    """One kind of sums over the samples of a window."""

    name: str  # its name in the layout
    shape: tuple[int, ...]  # shape of the sums
    #: From the samples of a window to the sums; of a cue with `terms`, to the sums and their numbers of terms.
    count: Callable[[Samples], NDArray[Any] | tuple[NDArray[Any], NDArray[Any]]]
    meaning: str  # the sums in words
    #: Last axes of the sums that share a number of terms, by which the network divides; 0 if the sums include these.
    shared: int = 0

    @property
    def terms(self) -> tuple[int, ...] | None:
        """The shape of the numbers of terms; None if the sums include them."""
        return (*self.shape[: -self.shared], *[1] * self.shared) if self.shared else None


#: All cues in the order of the vector. Add new ones at the end.
CUES = (
    Cue("histogram", HISTOGRAM_SHAPE, level_histogram, "samples at each level of each channel"),
    Cue("gradients", GRADIENTS_SHAPE, gradient_sums, "differences of neighbors at each level"),
    Cue("edges", EDGES_SHAPE, edge_sums, "number of edges and their encoded ratios less a half"),
    Cue("channel_equations", EQUATIONS_SHAPE, channel_equations, "equations for the curvature of $g$"),
    Cue("mixing", MIXING_SHAPE, mixing, "mixing ratios under each candidate", 2),
    Cue("disagreement", DISAGREEMENT_SHAPE, disagreement, "disagreement of the channels on mixing ratios", 1),
    Cue("shading", SHADING_SHAPE, shading, "disagreement of the channels on shading", 1),
    Cue(
        "half_resolution_disagreement",
        HALF_RESOLUTION_SHAPE,
        half_resolution_disagreement,
        "disagreement on mixing ratios at half the resolution",
        1,
    ),
)

#: Cues with numbers of terms -> the part that holds these.
COUNTS_OF = {cue.name: f"{cue.name}_counts" for cue in CUES if cue.terms}

#: The shape of each part, in the order of the vector.
SHAPES: dict[str, tuple[int, ...]] = {
    name: shape
    for cue in CUES
    for name, shape in ((cue.name, cue.shape), (COUNTS_OF.get(cue.name), cue.terms))
    if name and shape
}

_ENDS = dict(zip(SHAPES, accumulate(map(math.prod, SHAPES.values())), strict=True))

LENGTH = sum(map(math.prod, SHAPES.values()))  # of the vector


def window_statistics(window: Float32Array) -> Float32Array:
    """Return the statistics of one window, float32 (LENGTH,), which add up over windows.

    The window holds code values in [0, 1], shape (227, 227, 3). `unpack` returns the parts by name.
    """
    samples = Samples.from_window(window)
    counted = [cue.count(samples) for cue in CUES]
    parts = [part for each in counted for part in (each if isinstance(each, tuple) else (each,))]
    return np.concatenate([part.ravel() for part in parts]).astype(np.float32)


def unpack(statistics: Any) -> dict[str, Any]:
    """Return the parts by name, each (..., *shape), of an array or a tensor of statistics (..., LENGTH)."""
    leading = tuple(statistics.shape[:-1])
    return {
        name: statistics[..., _ENDS[name] - math.prod(shape) : _ENDS[name]].reshape(leading + shape)
        for name, shape in SHAPES.items()
    }
