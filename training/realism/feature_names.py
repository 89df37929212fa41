"""What each of the network's features is of, so that those that separate photographs can be named."""

from __future__ import annotations

import math

from crfnet_core.statistics import COUNTS_OF, SHAPES
from crfnet_core.statistics.channel_equations import EQUATION_LEVELS, EQUATION_STRIDES
from crfnet_core.statistics.edges import GRID
from crfnet_core.statistics.gradients import LEVELS, STRIDES
from training.network.features import SMOOTHNESS

#: What is counted of the neighbours of the samples at a level.
NEIGHBORS = ("log mean |d|", "mean log |d|", "equal", "signed")

#: Parts of the range of levels, of thirds.
THIRDS = ("dark", "middle", "bright")


def feature_names() -> list[str]:
    """Return the names of all features, in the order of `training.realism.samples.ALL`; those of a group share one."""
    third = [THIRDS[3 * level // LEVELS] for level in range(LEVELS)]
    channel = [f"histogram, {part}" for part in third]
    for stride in STRIDES:
        for what in NEIGHBORS:
            channel += [f"neighbours at {stride}: {what}, {part}" for part in third]
    edges = [f"edges at {stride}: {what}" for stride in STRIDES for what in ("number", "ratio") for _ in range(GRID**2)]
    parts = [f"curvature, smoothness {weight:g}" for weight in SMOOTHNESS] + ["evidence"]
    equations = [
        f"equations at {stride}: {part}"
        for stride in EQUATION_STRIDES
        for part in parts
        for _ in range(EQUATION_LEVELS)
    ]
    candidates = []
    for pair in COUNTS_OF.items():
        for name in pair:
            candidates += [name] * math.prod(SHAPES[name])
    return channel * 3 + edges + equations + candidates
